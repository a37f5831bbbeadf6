"""The algorithm of Figure 5 of the paper: film and pack in turn, with under-relaxation (60), (61), (Q4)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.descent import PackDescent
from petalfoil.classic.film_march import FilmMarch
from petalfoil.classic.kernels import KernelBackend
from petalfoil.classic.method_options import ClassicOptions
from petalfoil.errors import ConvergenceError
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
HistoryRow = dict[str, float | int | str]

STEPS_BETWEEN_PULSES = 100_000
"""Limit of inner steps between two calls of `pulse`: a tenth of a second on coarse grids, some seconds on fine ones."""


@dataclass(frozen=True)
class ClassicState:
    """State of film and pack.

    Attributes
    ----------
    w : (n_wall,) array
        Deflections over the reference length [1].
    P : (n_film,) array
        Pressure unknowns [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    outer, film_steps, pack_steps : int
        Outer iterations, time steps of the film and gradient steps of the pack so far.
    """

    w: Array
    P: Array
    lam: Array
    outer: int
    film_steps: int
    pack_steps: int


@dataclass
class ClassicRun:
    """One run of the method: film, pack and history.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing at one speed and journal position.
    options : ClassicOptions
        Parameters of the method.
    engine : KernelBackend or None
        Inner loops; None takes the fastest installed.
    tell : callable or None
        Called with every new row of the history.
    pulse : callable or None
        Called from time to time, also within an outer iteration.
    """

    problem: CoupledProblem
    options: ClassicOptions = field(default_factory=ClassicOptions)
    engine: KernelBackend | None = None
    tell: Callable[[HistoryRow], None] | None = None
    pulse: Callable[[], None] | None = None
    rows: list[HistoryRow] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self.film = FilmMarch(self.problem, self.options, self.engine)
        self.pack = PackDescent(self.problem, self.options, self.engine)

    def note(self, outer: int, pressure: float, film: float, relaxation: float) -> None:
        """Add a row to the history."""
        row: HistoryRow = {
            "outer": outer,
            "film_steps": self.film.steps,
            "pack_steps": self.pack.steps,
            "pressure_change": pressure,
            "film_change": film,
            "deflection_relaxation": relaxation,
        }
        self.rows.append(row)
        if self.tell is not None:
            self.tell(row)

    def march_film(self, P: Array, H: Array, tolerance: float) -> None:
        """Advance the pressures `P` (strip, node, axial) at film thickness `H` to the steady state, in place."""
        while not self.film.advance(P, H, tolerance, self.allowed("film", self.film.steps)):
            if not np.all(np.isfinite(P)):
                raise self.failure("the film pressures of the classic method diverged")

    def descend_pack(self, w: Array, P: Array, tolerance: float) -> None:
        """Bring the deflections `w` (n_wall,) to equilibrium under the pressure unknowns `P`, in place."""
        load = self.pack.load(P)
        while len(w) and not self.pack.advance(w, load, tolerance, self.allowed("pack", self.pack.steps)):
            pass

    def allowed(self, what: str, taken: int) -> int:
        """Number of steps until the next pulse, at most those left of the limit. A run can be stopped at a pulse."""
        if self.pulse is not None:
            self.pulse()
        left = (self.options.max_film_steps if what == "film" else self.options.max_pack_steps) - taken
        if left <= 0:
            raise self.out_of(what)
        return min(left, STEPS_BETWEEN_PULSES)

    def state(self, w: Array, P: Array, outer: int) -> ClassicState:
        """The present state with its contact reactions."""
        lam = self.pack.reactions(w, self.pack.load(P)) if len(w) else np.zeros(len(self.problem.weight))
        return ClassicState(w, P, lam, outer, self.film.steps, self.pack.steps)

    def out_of(self, what: str) -> ConvergenceError:
        """The error of a run that reached a limit of steps."""
        return self.failure(f"the classic method used up its {what} steps")

    def failure(self, message: str) -> ConvergenceError:
        """A convergence error with the history so far."""
        return ConvergenceError(
            message,
            history=self.rows,
            advice="its film steps grow as the square of the cells per pitch, its pack steps as the fourth power: "
            'take a coarser grid, or method = "newton", which solves the same equations',
        )


def relax(run: ClassicRun, start: ClassicState | None = None) -> ClassicState:
    """Film and pack in turn until neither changes by more than `epsilon`, from `start` or the assembled pack.

    Raises
    ------
    ConvergenceError
        A limit of steps was reached. The history has a row for each outer iteration.
    """
    problem, options = run.problem, run.options
    begin = start or assembled(run, options.loosest_inner_tolerance)
    w_out, P = run.pack.projected(begin.w), begin.P.copy()  # input values of deflections and pressure
    w_in, steady = w_out.copy(), problem.layout.balance.nodal_pressure(P)
    relaxation, change = Relaxation(options.deflection_relaxation, options.patience), math.inf
    for outer in range(1, options.max_outer + 1):
        tolerance = options.inner(change)
        H = problem.film(np.concatenate([w_in, P]))
        run.march_film(steady, H, tolerance)  # p_k+1 of the clearance (51)-(59)
        P_new = problem.layout.balance.mesh.at_unknowns(steady)
        pressure_change = float(np.max(np.abs(P_new - P) / P_new))  # (60)
        P = options.pressure_relaxation * P_new + (1.0 - options.pressure_relaxation) * P
        run.descend_pack(w_out, P, tolerance)  # W_k+1 of the pressure (45)-(50)
        H_new = problem.film(np.concatenate([w_out, P]))
        # the change of the film at the unrelaxed deflections: (61) would hide it
        film_change = float(np.max(np.abs(H_new - H) / H_new))
        before, change = change, max(pressure_change, film_change)
        run.note(outer, pressure_change, film_change, relaxation.factor)
        if max(before, change) <= options.epsilon:  # the inner tolerance of this iteration followed a small change
            return run.state(w_out, P, outer)
        relaxation.update(change)
        w_in = (1.0 - relaxation.factor) * w_in + relaxation.factor * w_out  # (61)
    raise run.out_of("outer")


def assembled(run: ClassicRun, tolerance: float | None = None) -> ClassicState:
    """The assembled pack at ambient pressure, by descent from the free petals to a force imbalance of `tolerance`.

    Raises
    ------
    ConvergenceError
        The limit of pack steps was reached.
    """
    layout = run.problem.layout
    w, P = np.zeros(layout.n_wall), np.ones(layout.n - layout.n_wall)
    run.descend_pack(w, P, run.options.inner(0.0) if tolerance is None else tolerance)
    return run.state(w, P, 0)


@dataclass
class Relaxation:
    """The factor `alpha` of (61). It is halved when the outer change stops to fall: film and pack oscillate then."""

    factor: float
    patience: float
    smallest: float = math.inf
    waited: int = 0

    def update(self, change: float) -> None:
        """Adapt the factor to the latest outer change."""
        self.waited += 1
        if change < self.smallest:
            self.smallest, self.waited = change, 0
        elif self.waited * self.factor >= self.patience:
            self.factor, self.smallest, self.waited = 0.5 * self.factor, math.inf, 0
