"""A case at values of one of its parameters around its own, discretised: what derivatives by it are read from.

Shape, mesh and units of the unknowns all follow the parameter, so that a difference of these equations at a fixed state
is the derivative of the whole chain from the case to its residual.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.case.parameters import Parameter, with_values
from petalfoil.equilibrium.parameter_response import Equations, EquationValues
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem, on_the_same_wall
from petalfoil.system.loaded import load_of

Array = NDArray[np.float64]
Stencil: TypeAlias = tuple[tuple[int, float], ...]
"""Steps from the own value, and the weight that each has in the derivative times the step."""

CENTRAL: Stencil = ((-2, 1.0 / 12.0), (-1, -2.0 / 3.0), (1, 2.0 / 3.0), (2, -1.0 / 12.0))
ABOVE: Stencil = ((0, -25.0 / 12.0), (1, 4.0), (2, -3.0), (3, 4.0 / 3.0), (4, -1.0 / 4.0))
BELOW: Stencil = tuple((-steps, -weight) for steps, weight in ABOVE)
"""Difference quotients of fourth order: on both sides of a value, above it, below it."""

SIXTH_ORDER: Stencil = (
    *((-3, -1.0 / 60.0), (-2, 3.0 / 20.0), (-1, -3.0 / 4.0)),
    *((1, 3.0 / 4.0), (2, -3.0 / 20.0), (3, 1.0 / 60.0)),
)
"""The same of sixth order, on both sides."""

FILM_CHANGE = 1.5e-3
"""Change of a film in a step, over its thickness. Flows change with its cube: twice as much leaves errors of 4e-6 in
stiff packs, and these fall with its fourth power. Gaps are differences of radii and rounded with them, to 3e-9 of a
step of 1.5 nm where the film is 1 um thin."""

GAP_CHANGE = 1.0
"""Change of a gap in a step, over the film thickness, where the film itself is held. Gaps are differences of lengths
that are ten thousand times as long: in smaller steps, petals that deflect by millimetres are rounded to 1e-5 of the
bending stress."""

HELD_FILM_STEP = 1e-5
"""Largest such step over the value of the parameter."""

PRESSURE_CHANGE = 3e-2
"""Change of the logarithm of a contact pressure over asperities in a step: quotients of fourth order of an exponential
are then good to 3e-8, as good as gaps of 5 nm are with the rounding of radii."""

LARGEST_STEP = 1e-4
"""Largest step over the value of the parameter: for those that the gaps do not depend on."""

NO_WALL = (
    "gas.",
    "operation.speed",
    "operation.load",
    "operation.eccentricity",
    "surface.friction_coefficient",
    "shaft.",
    "bushing.",
    "heat.",
)
"""Parameters that no wall depends on: growth enters with the speed."""

PROBE = 1e-3
"""Part of the largest step over which the change of the gaps is measured first."""

SIZES = {"m": 1e-4, "rad": 0.1, "N": 1.0, "rad/s": 100.0, "kg": 1.0, "Pa": 1e5, "K": 300.0, "1": 0.1}
"""What a step is compared with where the value of the parameter is zero, by unit [SI]."""


class EquationFamily(ABC):
    """Equations at several values of something that varies.

    Attributes
    ----------
    fineness : float
        Steps over those that were chosen first [1].
    """

    fineness: float

    @property
    @abstractmethod
    def step(self) -> float:
        """Step of the difference quotients."""

    @property
    @abstractmethod
    def size(self) -> float:
        """What changes are compared with."""

    @property
    def most_fineness(self) -> float:
        """Fineness of the longest steps, for what does not depend on a film."""
        return self.fineness

    @property
    def at_held_film(self) -> Self:
        """The same in steps for equations whose film is held, see `GAP_CHANGE`."""
        return self

    @property
    @abstractmethod
    def stencil(self) -> Stencil:
        """The difference quotient."""

    @abstractmethod
    def at(self, steps: int) -> tuple[Case, Equations]:
        """Case and equations a number of steps away."""

    @abstractmethod
    def admits(self, points: Stencil) -> bool:
        """Whether there are values at all points of a difference quotient."""

    @abstractmethod
    def finer(self, fineness: float) -> Self:
        """The same with steps of another `fineness`."""

    def rates(self, solution: Solution) -> EquationValues:
        """Derivatives of the equations at the state of `solution`."""
        values = [self.at(steps)[1].at_state(solution) for steps, _ in self.stencil]
        return EquationValues.combined(values, [weight / self.step for _, weight in self.stencil])


@dataclass(frozen=True, eq=False)
class VariedCase(EquationFamily):
    """A case at several values of a parameter.

    Attributes
    ----------
    case : Case
        The bearing, with the load or the eccentricity that its equilibrium is asked for.
    parameter : Parameter
        What varies.
    own : Equations
        The equations at its own value.
    film : float
        A film thickness that steps are to be small beside [m].
    fineness : float
        Steps over those that the gaps of the free wall allow [1].
    """

    case: Case
    parameter: Parameter
    own: Equations
    film: float
    fineness: float = 1.0
    _built: dict[float, tuple[Case, Equations]] = field(default_factory=dict)

    @property
    def value(self) -> float:
        """Value of the parameter in the case."""
        return float(self.parameter.value or 0.0)

    @property
    def size(self) -> float:
        """What changes of the parameter are compared with: its magnitude, or a typical one where it is zero."""
        return abs(self.value) or SIZES.get(self.parameter.unit, 1.0)

    @cached_property
    def step(self) -> float:
        """Step of the difference quotients, in the unit of the parameter."""
        return self.fineness * self._first_step

    @cached_property
    def _first_step(self) -> float:
        """The step of fineness 1."""
        largest = LARGEST_STEP * self.size
        return min(largest, FILM_CHANGE * self.film / self.gap_rate) if self.gap_rate else largest

    @property
    def most_fineness(self) -> float:
        """That of `HELD_FILM_STEP`, or of the first step where that is longer."""
        return max(HELD_FILM_STEP * self.size / self._first_step, 1.0)

    @property
    def at_held_film(self) -> Self:
        """Steps that move gaps by the thickness of the film."""
        return self.finer(min(self.most_fineness, GAP_CHANGE / FILM_CHANGE))

    def finer(self, fineness: float) -> Self:
        """The same with steps of another `fineness`."""
        return replace(self, fineness=fineness)

    @cached_property
    def gap_rate(self) -> float:
        """Largest change of a gap of the free wall by the parameter [m over its unit]."""
        own, probe = free_gaps(self.own), PROBE * LARGEST_STEP * self.size
        for change in (probe, -probe):
            if self._allowed(change):
                moved = free_gaps(self.at_value(change)[1])
                if len(moved) == len(own):
                    return float(np.max(np.abs(moved - own), initial=0.0)) / probe
        return 0.0

    def at(self, steps: int) -> tuple[Case, Equations]:
        """Case and equations a number of steps away."""
        return self.at_value(steps * self.step)

    def at_value(self, change: float) -> tuple[Case, Equations]:
        """Case and equations with the parameter changed."""
        if change not in self._built:
            there = with_values(self.case, self.values_at(change))
            known = self.own if self.parameter.path.startswith(NO_WALL) and there.operation.moment is None else None
            equations = equations_of(there, under_load=self.own.load is not None, known=known)
            self._built[change] = (there, equations.at_temperatures(self.own.problem.temperatures))
        return self._built[change]

    def values_at(self, change: float) -> dict[str, float]:
        """Values of what varies by path, with the parameter changed."""
        return {self.parameter.path: self.value + change}

    @cached_property
    def stencil(self) -> Stencil:
        """The first difference quotient inside the range of the parameter and on the grid of its own value.

        Raises
        ------
        ConvergenceError
            The grid changes with the parameter on either side.
        """
        inside = [points for points in (CENTRAL, ABOVE, BELOW) if self.admits(points)]
        for points in inside:
            if all(self.at(steps)[1].problem.layout.n == self.own.problem.layout.n for steps, _ in points):
                return points
        raise ConvergenceError(
            f"no derivative by {self.parameter.path}: its value {self.value:g} {self.parameter.unit} is where the grid "
            "changes",
            advice=f"change {self.parameter.path} by a millionth",
        )

    def admits(self, points: Stencil) -> bool:
        """Whether the range of the parameter holds all points of a difference quotient."""
        return all(self._allowed(steps * self.step) for steps, _ in points)

    def _allowed(self, change: float) -> bool:
        return self.parameter.declared.holds(self.value + change)


def equations_of(case: Case, *, under_load: bool, known: Equations | None = None) -> Equations:
    """The equations of a case at its displacement, or under its load and moment; on the wall of `known` equations."""
    problem = build_problem(case) if known is None else on_the_same_wall(known.problem, case)
    if not under_load:
        return Equations(problem, None)
    if case.operation.load is None:
        raise ValueError("this case has no load")
    return Equations(problem, load_of(case, case.operation.load, problem.layout))


def free_gaps(equations: Equations) -> Array:
    """Gaps of the free wall, (m,) [m]."""
    problem = equations.problem
    free = problem.layout.ambient(np.zeros(problem.layout.n_wall))
    return problem.gaps(free) * problem.layout.scales.length


def quotient(points: Stencil, step: float, values: Sequence[float]) -> float:
    """The difference quotient of values at the points of a stencil."""
    return float(sum(weight * value for (_, weight), value in zip(points, values, strict=True)) / step)
