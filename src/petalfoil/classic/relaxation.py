"""The algorithm of the paper's Figure 5: film and package in turn, each from where it was, relaxed (60), (61), (Q4)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.descent import PackageDescent
from petalfoil.classic.film_march import FilmMarch
from petalfoil.classic.kernels import Engine
from petalfoil.classic.options import ClassicOptions
from petalfoil.errors import ConvergenceError
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
Row = dict[str, float | int | str]

STRETCH = 100_000
"""Most inner steps without looking up: a tenth of a second on coarse grids, some seconds on fine ones."""


@dataclass(frozen=True)
class ClassicState:
    """Where the method came to rest.

    Attributes
    ----------
    w : (n_wall,) array
        Deflections over the reference length [1].
    P : (n_film,) array
        Pressure unknowns [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    outer, film_steps, package_steps : int
        What it took.
    """

    w: Array
    P: Array
    lam: Array
    outer: int
    film_steps: int
    package_steps: int


@dataclass
class Run:
    """One run: its two halves, its history, whom it tells.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing at one speed and journal position.
    options : ClassicOptions
        Numbers of the method.
    engine : Engine or None
        Which inner loops run; the fastest that is installed if None.
    tell : callable or None
        Given every row of the history.
    pulse : callable or None
        Called now and then, also within an outer iteration.
    """

    problem: CoupledProblem
    options: ClassicOptions = field(default_factory=ClassicOptions)
    engine: Engine | None = None
    tell: Callable[[Row], None] | None = None
    pulse: Callable[[], None] | None = None
    rows: list[Row] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self.film = FilmMarch(self.problem, self.options, self.engine)
        self.package = PackageDescent(self.problem, self.options, self.engine)

    def note(self, outer: int, pressure: float, film: float, share: float) -> None:
        """Add a row to the history."""
        row: Row = {
            "outer": outer,
            "film_steps": self.film.steps,
            "package_steps": self.package.steps,
            "pressure_change": pressure,
            "film_change": film,
            "deflection_share": share,
        }
        self.rows.append(row)
        if self.tell is not None:
            self.tell(row)

    def settle_film(self, P: Array, H: Array, tolerance: float) -> None:
        """March the pressures `P` (strip, node, axial) to steadiness at film `H`, in place."""
        while not self.film.advance(P, H, tolerance, self.allowed("film", self.film.steps)):
            if not np.all(np.isfinite(P)):
                raise self.failure("the classic method's film blew up")

    def settle_package(self, w: Array, P: Array, tolerance: float) -> None:
        """Bring the deflections `w` (n_wall,) to equilibrium under the pressure unknowns `P`, in place."""
        load = self.package.load(P)
        while len(w) and not self.package.advance(w, load, tolerance, self.allowed("package", self.package.steps)):
            pass

    def allowed(self, what: str, taken: int) -> int:
        """Steps to take before looking up, of those that are left; a run can be watched and stopped in between."""
        if self.pulse is not None:
            self.pulse()
        left = (self.options.max_film_steps if what == "film" else self.options.max_package_steps) - taken
        if left <= 0:
            raise self.out_of(what)
        return min(left, STRETCH)

    def state(self, w: Array, P: Array, outer: int) -> ClassicState:
        """The state reached, with the reactions that its equations ask for."""
        lam = self.package.reactions(w, self.package.load(P)) if len(w) else np.zeros(len(self.problem.weight))
        return ClassicState(w, P, lam, outer, self.film.steps, self.package.steps)

    def out_of(self, what: str) -> ConvergenceError:
        """The error of a run that used up its steps."""
        return self.failure(f"the classic method used up its {what} steps")

    def failure(self, message: str) -> ConvergenceError:
        """An error with the history so far."""
        return ConvergenceError(
            message,
            history=self.rows,
            advice="its film steps grow as the square of the cells along a pitch, its package steps as the fourth "
            'power: take a coarser grid, or method = "newton", which solves the same equations',
        )


def relax(run: Run, start: ClassicState | None = None) -> ClassicState:
    """Film and package in turn until neither changes by more than `epsilon`, from `start` or the assembled package.

    Raises
    ------
    ConvergenceError
        A number of steps was used up; its history has a row for each outer iteration.
    """
    problem, numbers = run.problem, run.options
    begun = start or assembled(run, numbers.loosest)
    w_out, P = run.package.admitted(begun.w), begun.P.copy()  # input values of deflections and pressure
    w_in, settled = w_out.copy(), problem.layout.balance.nodal_pressure(P)
    damping, change = Damping(numbers.deflection_share, numbers.patience), math.inf
    for outer in range(1, numbers.max_outer + 1):
        tolerance = numbers.inner(change)
        H = problem.film(np.concatenate([w_in, P]))
        run.settle_film(settled, H, tolerance)  # p_k+1 of the clearance (51)-(59)
        P_new = pressure_unknowns(problem, settled)
        pressure_change = float(np.max(np.abs(P_new - P) / P_new))  # (60)
        P = numbers.pressure_share * P_new + (1.0 - numbers.pressure_share) * P
        run.settle_package(w_out, P, tolerance)  # W_k+1 of the pressure (45)-(50)
        H_new = problem.film(np.concatenate([w_out, P]))
        film_change = float(np.max(np.abs(H_new - H) / H_new))  # before relaxation, which would hide it
        before, change = change, max(pressure_change, film_change)
        run.note(outer, pressure_change, film_change, damping.share)
        if max(before, change) <= numbers.epsilon:  # this time film and package were settled to match
            return run.state(w_out, P, outer)
        damping.look(change)
        w_in = (1.0 - damping.share) * w_in + damping.share * w_out  # (61)
    raise run.out_of("outer")


def assembled(run: Run, tolerance: float | None = None) -> ClassicState:
    """The package alone at ambient pressure, from the free shape, settled to `tolerance` of it.

    Raises
    ------
    ConvergenceError
        The package's steps were used up.
    """
    layout = run.problem.layout
    w, P = np.zeros(layout.n_wall), np.ones(layout.n - layout.n_wall)
    run.settle_package(w, P, run.options.inner(0.0) if tolerance is None else tolerance)
    return run.state(w, P, 0)


def pressure_unknowns(problem: CoupledProblem, nodal: Array) -> Array:
    """The pressure unknowns of nodal pressures (strip, node, axial), (n_film,)."""
    unknown = problem.layout.balance.mesh.unknown
    P = np.empty(problem.layout.balance.mesh.n_unknown)
    P[unknown[unknown >= 0]] = nodal[unknown >= 0]
    return P


@dataclass
class Damping:
    """`alpha` of (61): halved where the change has not fallen for long, because film and package take turns."""

    share: float
    patience: float
    least: float = math.inf
    waited: int = 0

    def look(self, change: float) -> None:
        """Take note of an outer change."""
        self.waited += 1
        if change < self.least:
            self.least, self.waited = change, 0
        elif self.waited * self.share >= self.patience:
            self.share, self.least, self.waited = 0.5 * self.share, math.inf, 0
