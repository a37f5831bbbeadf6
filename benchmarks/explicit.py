"""A motion by explicit steps, with the loops of the paper's method: what a revolution of it costs.

petalfoil's classic method has no motion in time. This is the one that its parts give: each step marches the gas by one
explicit step as long as (59) allows, moves the rotor by its forces, and settles the package by the projected descent
from where it was. Its path is followed for a stretch, from a state of petalfoil's own orbit; only counts are taken from
there. Times are those of the bare loops, in runs of many steps: what film and columns ask for anew with each step (their
coefficients, in Python here) is not charged.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from measure import in_turn
from numpy.typing import NDArray

from petalfoil.classic.columns import columns
from petalfoil.classic.descent import PackageDescent
from petalfoil.classic.film_cells import film_cells
from petalfoil.classic.kernels import Descent, Engine, March, kernels
from petalfoil.classic.numpy_kernels import exponential_fit, inflow, largest_rate
from petalfoil.classic.options import ClassicOptions
from petalfoil.classic.relaxation import pressure_unknowns
from petalfoil.problem.moving import StepProblem
from petalfoil.transient.scheme import System
from petalfoil.transient.state import Instant

Array = NDArray[np.float64]

CHUNK = 2000
"""Descent steps between looks at the clock."""


@dataclass(frozen=True)
class Stretch:
    """What a stretch of the motion took.

    Attributes
    ----------
    film_steps, package_steps : int
        Explicit steps of the film; steps of the descent in all.
    tau : float
        How far it got [units of time].
    e, w : arrays
        Where journal and package are then [1].
    broke : str
        Why it ended before its time; empty if it did not.
    """

    film_steps: int
    package_steps: int
    tau: float
    e: Array
    w: Array
    broke: str = ""


@dataclass
class ExplicitMotion:
    """The motion from an instant on.

    Parameters
    ----------
    system : System
        Bearing and rotor.
    start : Instant
        A state of the motion.
    tolerance : float
        Force that may be left on a node of the package, over ambient pressure on it [1].
    every : int
        Film steps, the film's thickness frozen, between settlings of the package.
    """

    system: System
    start: Instant
    tolerance: float
    every: int = 1

    def __post_init__(self) -> None:
        start, rotor = self.start, self.system.rotor
        self.problem = self.system.problem.at(
            displacement=start.e, bearing_number=rotor.bearing_number(start.tau)
        )
        self.package = PackageDescent(self.problem, ClassicOptions())
        self.w = start.x[: self.problem.layout.n_wall].copy()
        self.e, self.v, self.tau = start.e.copy(), start.moving.v.copy(), start.tau
        self.P = self.problem.pressure(start.x).reshape(-1).copy()
        self.hold = self.cells().hold
        self.film_steps = self.package_steps = 0

    def follow(self, end: float, seconds: float) -> Stretch:
        """Steps until time `end` [units of time], for at most so many seconds of processor time."""
        begin, why = time.process_time(), ""
        while self.tau < end and not why and time.process_time() - begin < seconds:
            self.film_and_rotor()
            if not self.settled(begin + seconds):
                break
            why = self.broken()
        return Stretch(self.film_steps, self.package_steps, self.tau, self.e, self.w, why)

    def film_and_rotor(self) -> None:
        """Explicit steps of the gas in the cells, as long as (59) allows, then one of the rotor."""
        cells = self.cells()
        self.P *= np.where(cells.moves > 0.0, self.hold / cells.hold, 1.0)  # the gas stays, its room has changed
        self.hold = cells.hold
        share, fit = ClassicOptions().time_share, exponential_fit(self.P, cells)
        dt = share / largest_rate(self.P, cells)
        for _ in range(self.every):
            self.P += dt * inflow(self.P, cells, fit) / cells.hold
        step, rotor = self.every * 2.0 * self.problem.clock * dt, self.system.rotor
        self.tau += step
        force = self.system.film.at(self.unknowns()) + rotor.outside(self.tau)
        self.v = self.v + step * force / rotor.inertia
        self.e = self.e + step * self.v
        self.problem = self.problem.at(displacement=self.e)
        self.film_steps += self.every

    def settled(self, until: float) -> bool:
        """Bring the package to rest under the pressures; False if the time was up before."""
        load, shell, held = self.package.load(self.unknowns()), self.package.shell, columns(self.problem)
        drive = Descent(self.package.step, False, self.tolerance, CHUNK)
        while time.process_time() < until:
            steps, left = kernels().descend(self.w, load, shell, held, drive)
            self.package_steps += steps
            if left <= self.tolerance:
                return True
        return False

    def broken(self) -> str:
        """Why it cannot go on; empty if it can."""
        film = self.problem.film(np.concatenate([self.w, self.unknowns()]))
        if not (np.all(np.isfinite(self.P)) and np.all(np.isfinite(film))):
            return "not finite"
        return "a film without thickness" if film.min() <= 0.0 else "a vacuum" if self.P.min() <= 0.0 else ""

    def unknowns(self) -> Array:
        """Pressure unknowns."""
        return pressure_unknowns(self.problem, self.P.reshape(self.problem.layout.balance.mesh.shape))

    def cells(self):  # noqa: ANN201
        """Cells of the film as it is."""
        H = self.problem.film(np.concatenate([self.w, self.unknowns()]))
        return film_cells(self.problem.layout.balance, H, self.problem.bearing_number)
