"""A motion by explicit time steps with the loops of the paper's method, and the time of one revolution.

The classic method has no motion in time. This one consists of its parts: each step advances the gas by one explicit
step of the limit (59), then the rotor by its forces, and solves the pack by projected descent from its previous
deflections.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import numpy as np
from measure import in_turn
from numpy.typing import NDArray

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.classic.columns import columns
from petalfoil.classic.descent import PackDescent
from petalfoil.classic.film_cells import FilmCells, film_cells
from petalfoil.classic.kernels import DescentSettings, KernelBackend, MarchSettings, kernels
from petalfoil.classic.method_options import ClassicOptions
from petalfoil.classic.numpy_kernels import exponential_fit, inflow, largest_rate
from petalfoil.dynamics.time_state import Instant
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

NUMBERS = ClassicOptions()
ENDLESS = -1.0
"""A tolerance that is never met."""
CHUNK = 2000
"""Descent steps between checks of the time limit."""
LOST = 1.0
"""Limit of the motion of a petal within a step of petalfoil, in which it moves by a tenth [reference films]."""


def placed(orbit: Orbit, at: Instant, e: Array | None = None) -> CoupledProblem:
    """The bearing at the speed of a time state of `orbit`, at its position or at `e`."""
    speed = orbit.system.rotor.bearing_number(at.tau)
    return orbit.system.problem.at(displacement=at.e if e is None else e, bearing_number=speed)


def cells_at(problem: CoupledProblem, w: Array, P: Array) -> FilmCells:
    """Cells of the film at deflections `w` and pressure unknowns `P`."""
    return film_cells(problem.layout.balance, problem.film(np.concatenate([w, P])), problem.bearing_number)


def turn(orbit: Orbit) -> float:
    """Number of film steps per revolution, with the stable step (59) of the initial state of the orbit."""
    start = orbit.start
    problem = placed(orbit, start)
    cells = cells_at(problem, *np.split(start.x, [problem.layout.n_wall]))
    step = NUMBERS.time_step_fraction / largest_rate(problem.pressure(start.x).reshape(-1), cells)
    return 2.0 * math.pi / (2.0 * orbit.system.problem.time_number * step)


def costs(orbit: Orbit, engine: KernelBackend, steps: int) -> tuple[float, float]:
    """Time of a film step and of a descent step in calls of `steps` steps, after a first call [s]."""
    start, inner = orbit.start, kernels(engine)
    problem = placed(orbit, start)
    pack = PackDescent(problem, NUMBERS, engine)
    w, unknowns = np.split(start.x, [problem.layout.n_wall])
    P, cells, load = (
        problem.pressure(start.x).reshape(-1).copy(),
        cells_at(problem, w, unknowns),
        pack.load(unknowns),
    )
    shell, held, w = pack.shell, pack.columns, w.copy()
    march, descent = (
        MarchSettings(NUMBERS.time_step_fraction, 1.0, ENDLESS, 32),
        DescentSettings(pack.step, False, ENDLESS, 20),
    )
    inner.march(P, cells, march)  # compiles the loops
    inner.descend(w, load, shell, held, descent)
    steps = 160 * max(1, steps // 160)  # a multiple of the steps between checks of both loops
    best = in_turn(
        {
            "film": lambda: inner.march(P, cells, march._replace(max_steps=steps)),
            "pack": lambda: inner.descend(w, load, shell, held, descent._replace(max_steps=steps)),
        },
        3,
    )
    return best["film"] / steps, best["pack"] / steps


# ---------------------------------------------------------------------------------------------- counts on a given path


def settlings(orbit: Orbit, pair: tuple[Instant, Instant], tolerance: float, seconds: float) -> tuple[int, int]:
    """Film steps between two time states of a motion, and the descent steps for them, within a time limit.

    Pressure and journal position are interpolated linearly. The pack is solved for each, from its previous deflections.
    """
    begin, end = pair
    steps, until = math.ceil(turn(orbit) * (end.tau - begin.tau) / (2.0 * math.pi)), time.process_time() + seconds
    problem = placed(orbit, begin)
    pack, w, total = PackDescent(problem, NUMBERS), begin.x[: problem.layout.n_wall].copy(), 0
    settings = DescentSettings(pack.step, False, tolerance, CHUNK)
    for step in range(1, steps + 1):
        share = step / steps
        x, e = begin.x + share * (end.x - begin.x), begin.e + share * (end.e - begin.e)
        held, load, left = columns(placed(orbit, begin, e)), pack.load(x[problem.layout.n_wall :]), math.inf
        while not left <= tolerance:
            taken, left = kernels().descend(w, load, pack.shell, held, settings)
            total += taken
            if time.process_time() > until:
                return step, total
    return steps, total


# ---------------------------------------------------------------------------------------------- a march of its own


@dataclass
class ExplicitMotion:
    """The motion from a time state of an orbit by explicit steps.

    Parameters
    ----------
    orbit : Orbit
        Bearing and rotor.
    start : Instant
        Initial time state.
    tolerance : float
        Largest remaining nodal force of the pack over that of ambient pressure [1].
    """

    orbit: Orbit
    start: Instant
    tolerance: float

    def __post_init__(self) -> None:
        start = self.start
        self.problem = placed(self.orbit, start)
        self.pack = PackDescent(self.problem, NUMBERS)
        self.w = start.x[: self.problem.layout.n_wall].copy()
        self.e, self.v, self.tau = start.e.copy(), start.moving.v.copy(), start.tau
        self.P = self.problem.pressure(start.x).reshape(-1).copy()
        self.capacity = cells_at(self.problem, self.w, self.unknowns).capacity
        self.film_steps = self.pack_steps = 0

    @property
    def unknowns(self) -> Array:
        """Pressure unknowns."""
        mesh = self.problem.layout.balance.mesh
        return mesh.at_unknowns(self.P.reshape(mesh.shape))

    def follow(self, end: float, seconds: float) -> str:
        """Step until the time `end` or a limit of processor time [s]; returns a description of the end."""
        until = time.process_time() + seconds
        while self.tau < end and time.process_time() < until:
            with np.errstate(all="ignore"):  # a diverging film
                self.film_and_rotor()
                self.settle(until)
            if self.lost:
                return f"diverged after {self.film_steps} film steps"
        return f"{self.film_steps} film steps until {'the time limit' if self.tau < end else 'the end'}"

    def film_and_rotor(self) -> None:
        """One explicit step of the gas of the limit (59), then one of the rotor."""
        cells, rotor = cells_at(self.problem, self.w, self.unknowns), self.orbit.system.rotor
        # the mass of gas in a cell does not change while its volume does
        self.P *= np.where(cells.is_unknown > 0.0, self.capacity / cells.capacity, 1.0)
        self.capacity, fit = cells.capacity, exponential_fit(self.P, cells)
        dt = NUMBERS.time_step_fraction / largest_rate(self.P, cells)
        self.P += dt * inflow(self.P, cells, fit) / cells.capacity
        step = 2.0 * self.orbit.system.problem.time_number * dt
        self.tau += step
        by_film = self.problem.border.row_derivative @ (self.unknowns - 1.0)
        force = by_film + rotor.outside(self.tau)
        self.v = self.v + step * np.linalg.solve(rotor.inertia * np.eye(2), force)  # no gyroscopic forces: two axes
        self.e = self.e + step * self.v
        self.problem = self.problem.at(displacement=self.e)
        self.film_steps += 1

    def settle(self, until: float) -> None:
        """Solve the pack under the pressures, unless it diverges or the time limit is reached."""
        load, shell, held = self.pack.load(self.unknowns), self.pack.shell, columns(self.problem)
        settings, left = DescentSettings(self.pack.step, False, self.tolerance, CHUNK), math.inf
        while not left <= self.tolerance and not self.lost and time.process_time() < until:
            steps, left = kernels().descend(self.w, load, shell, held, settings)
            self.pack_steps += steps

    @property
    def lost(self) -> bool:
        """Whether film or pack have diverged."""
        return not (np.all(np.isfinite(self.P)) and self.moved < LOST)

    @property
    def moved(self) -> float:
        """Largest change of a deflection since the start [reference films]."""
        return float(np.max(np.abs(self.w - self.start.x[: len(self.w)]), initial=0.0))
