"""The load under which a result reaches its limit, as one more unknown beside contact points, film and position.

A load of size `W` in a fixed direction `d` is followed from a neighbour. With `q` the distance of the result from its
limit, and `J`, `F`, `F_e`, `R`, `R_e` those of (C10),

    J dX + F_e de = -F ,   R dX + R_e de + d dW = -(force + W d) ,   q_X dX + q_e de = -q               (C13)

One inverse of `J` serves all three. It serves on for as long as its steps halve the error, and contacts are looked at
whenever it is renewed: what has closed by more than the error gains a contact at once. A renewed inverse is the factor
at hand, that of another speed too, improved by GMRES with all contacts as its border (`solvers/near_factor.py`): other
contacts ask for no factorisation. Only where that factor is too far away, `J` is factorised.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.asperity_contacts import AsperityContacts, renewed
from petalfoil.equilibrium.asperity_contacts import admitted as asperities_admitted
from petalfoil.equilibrium.asperity_contacts import changed as asperities_changed
from petalfoil.equilibrium.contact_sets import revised
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError, scaled_force, unbalanced
from petalfoil.equilibrium.point_contacts import PointContacts, admitted, changed
from petalfoil.equilibrium.point_prospects import FARTHEST_STATE
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.solvers.near_factor import FactorAtHand, Inverse, NotNearError
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.asperity_equations import AsperityEquations
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations

Array = NDArray[np.float64]
StateChange: TypeAlias = tuple[Array, Array]
"""Change of the unknowns (n,) and of the journal's position (n_position,)."""
ElementEquations: TypeAlias = PointEquations | AsperityEquations

REACHED = 1e-6
"""Relative distance from a limit at which it counts as reached."""

TANGENTS = 16
"""Most tangents of one search: three or four between speeds 3 % apart, twelve where a petal comes to lie on another."""

LEAST_PART = 0.125
"""Least part of the way between two speeds that is taken at once: what is lost over an eighth of it jumps."""

STEPS = 60
"""Most steps of one search; those with a factor at hand cost a tenth of a factorisation."""

FARTHEST_MOVE = 4.0
"""Longest move of the journal in a step, in units of the reference film (40 um): with 10 the first step between speeds
a sixth apart leads astray."""

FARTHEST_TRAVEL = 3.0
"""Farthest that a contact point travels in a step, in elements: from speed to speed points travel by one or two."""

MOST_LOAD = 0.5
"""Largest relative change of the load in a step, but for small loads."""

CHORD = 0.5
"""Error after a step over that before it, up to which the factor at hand serves on: 0.2 took a quarter more of them."""

SETTLING = 1e-4
"""Error below which two steps together may take as long: its last digits fall unevenly."""

SETTLED = 1e-3
"""Residual below which all signs are looked at."""

CERTAIN = 0.3
"""Part of the residual that a gap below zero must exceed to gain a contact at once. With 0.1 and less contacts came and
went."""

PROBE = 1e-5
"""Part of a change by which the distance from the limit is differentiated along it."""


class LoadedState(Protocol):
    """A state under a load of some size, solved or not."""

    @property
    def equations(self) -> ElementEquations:
        """The equations at the state."""

    @property
    def size(self) -> float:
        """Size of the load."""

    @property
    def positioned(self) -> ElementEquilibrium:
        """The state as an equilibrium."""

    def moved(self, change: StateChange, more: float = 0.0, length: float = 1.0) -> Self:
        """After a part `length` of a change of unknowns and position, and of `more` load, relative to the present."""

    def admitted(self, change: StateChange) -> float:
        """The part of a change after which film and pressures are positive."""

    def revised(self, error: float = 0.0) -> Self | None:
        """With other contacts, where the signs ask for them by more than `error`; None where they are right."""


@dataclass(frozen=True)
class LoadedPoints:
    """Contact points under a load; members as of `LoadedState`."""

    equations: PointEquations
    size: float
    splitting: bool = True
    """Whether a point with gaps below zero beside it splits in two: not after points have met again. Then these gaps
    gain points of their own, as where a petal lies on another one so lightly that nothing holds the two apart."""

    @property
    def positioned(self) -> PointContacts:
        """The state as an equilibrium."""
        return PointContacts(self.equations, largest(self.equations))

    def moved(self, change: StateChange, more: float = 0.0, length: float = 1.0) -> LoadedPoints:
        """After a part of a change; points that meet are one."""
        equations, (dX, move) = self.equations, change
        problem = equations.problem.at(displacement=equations.problem.displacement + length * move)
        state = changed(equations, length * dX, FARTHEST_TRAVEL)
        size, splitting = self.size * (1.0 + length * more), self.splitting
        if len(state.points.curve) < len(equations.state.points.curve):
            splitting = False
        return LoadedPoints(replace(equations, problem=problem, state=state), size, splitting)

    def admitted(self, change: StateChange) -> float:
        """The part of a change that is taken."""
        return admitted(self.equations, change, FARTHEST_MOVE)

    def revised(self, error: float = 0.0) -> LoadedPoints | None:
        """With other contacts."""
        points = revised(self.equations, error, one_by_one=True, splitting=self.splitting)
        if points is None:
            return None
        equations = replace(self.equations, state=replace(self.equations.state, points=points))
        return replace(self, equations=equations)


@dataclass(frozen=True)
class LoadedAsperities:
    """Contact pressures over asperities under a load; members as of `LoadedState`."""

    equations: AsperityEquations
    size: float

    @property
    def positioned(self) -> AsperityContacts:
        """The state as an equilibrium."""
        return AsperityContacts(self.equations, largest(self.equations))

    def moved(self, change: StateChange, more: float = 0.0, length: float = 1.0) -> LoadedAsperities:
        """After a part of a change, open gaps with the pressure of their law."""
        equations = renewed(asperities_changed(self.equations, *change, length))
        return LoadedAsperities(equations, self.size * (1.0 + length * more))

    def admitted(self, change: StateChange) -> float:
        """The part of a change that is taken."""
        return asperities_admitted(self.equations, change, FARTHEST_MOVE)

    def revised(self, error: float = 0.0) -> None:
        """There are no contacts to choose."""


def loaded_state(found: ElementEquilibrium, problem: CoupledProblem, size: float) -> LoadedState:
    """The state of an equilibrium under the equations of `problem` and another load, unsolved."""
    here = problem.at(displacement=found.equations.problem.displacement)
    if isinstance(found, AsperityContacts):
        equations = found.equations
        return LoadedAsperities(replace(equations, smooth=replace(equations.smooth, problem=here)), size)
    if isinstance(found, PointContacts):
        return LoadedPoints(replace(found.equations, problem=here), size)
    raise TypeError(f"neither contact points nor asperities: {type(found)}")


def largest(equations: ElementEquations) -> float:
    """Largest scaled residual."""
    return float(np.max(np.abs(equations.scaled)))


@dataclass(frozen=True)
class LoadLimit:
    """A limit, and the direction of the load that shall reach it.

    Attributes
    ----------
    direction : (n_position,) array
        Load of size one over the unit of force [1].
    distance : callable
        Distance of a state from the limit, relative to it, negative beyond it; by contacts and size of the load.
    small : float
        A load that hardly moves the journal: so much is added to a load at once, however small that is.
    turns : bool
        Whether more load may lead away from the limit, as behind the largest load of a branch.
    """

    direction: Array
    distance: Callable[[ElementEquilibrium, float], float]
    small: float = 0.0
    turns: bool = False

    def of(self, at: LoadedState) -> float:
        """Distance of a state from the limit."""
        return self.distance(at.positioned, at.size)

    def residual(self, at: LoadedState) -> float:
        """Largest scaled residual of a state, the unbalanced force among them."""
        force = scaled_force(at.equations, at.size * self.direction)
        return max(largest(at.equations), float(np.max(np.abs(force))))

    def along(self, at: LoadedState, distance: float, change: StateChange, more: float = 0.0) -> float:
        """Derivative of the distance, which is known at the state, along a change of unknowns, position and load."""
        return (self.of(at.moved(change, more, PROBE)) - distance) / PROBE


@dataclass(frozen=True)
class LimitTangent:
    """The tangent at one state, and what the load changes there.

    Attributes
    ----------
    tangent : ElementTangent
        That of state and position.
    by_load : (array, array)
        Change of unknowns and position by the logarithm of the load.
    slope : float
        Derivative of the distance from the limit by the same.
    """

    tangent: ElementTangent
    by_load: StateChange
    slope: float

    @classmethod
    def at(cls, at: LoadedState, distance: float, limit: LoadLimit, hand: FactorAtHand) -> LimitTangent:
        """The tangent at a state, whose distance from the limit is known.

        It is found by the factor at hand if that is near enough, else by one of its own.

        Raises
        ------
        NoPointsError
            A larger load does not lead to the limit, where it must, or the contacts do not determine the petals.
        """
        solver, matrix, layout = current_run().film_solver, at.equations.steady, at.equations.problem.layout
        common = len(at.equations.deflection) + len(at.equations.pressures)
        if near := hand.near(matrix, common, layout, solver):
            try:
                return cls.by(at, distance, limit, near)
            except NotNearError:
                pass
        try:
            factor = solver.factor(matrix)
        except SingularMatrixError:
            raise NoPointsError("the contacts do not determine the petals") from None
        hand.keep(factor, layout)
        return cls.by(at, distance, limit, factor)

    @classmethod
    def by(cls, at: LoadedState, distance: float, limit: LoadLimit, factor: Inverse) -> LimitTangent:
        """The tangent at a state, whose `J` is ready to solve with."""
        load = at.size * limit.direction
        tangent = ElementTangent.of(at.equations, load, factor)
        move = np.asarray(np.linalg.solve(tangent.gradient, -load), dtype=np.float64)
        by_load = tangent.units @ move, move
        slope = limit.along(at, distance, by_load, 1.0)
        if not (slope < 0.0 or (limit.turns and slope > 0.0)):
            raise NoPointsError("more load does not lead nearer to the limit")
        return cls(tangent, by_load, slope)

    def stepped(self, at: LoadedState, distance: float, limit: LoadLimit) -> LoadedState:
        """The state after a step, shortened where film or pressures would vanish or the journal goes too far."""
        tangent, (dX, move) = self.tangent, self.by_load
        own = tangent.correction(at.equations.newton_residual, unbalanced(at.equations, at.size * limit.direction))
        more = -(distance + limit.along(at, distance, own)) / self.slope
        more = min(max(more, -MOST_LOAD), max(MOST_LOAD, limit.small / at.size))
        change = own[0] + more * dX, own[1] + more * move
        return at.moved(change, more, at.admitted(change))


def at_limit(start: LoadedState, limit: LoadLimit, hand: FactorAtHand) -> LoadedState:
    """The state and the size of the load at the limit, followed from a neighbour.

    Raises
    ------
    NoPointsError
        The limit was not reached.
    """
    at, errors, left = start, [math.inf, math.inf], TANGENTS
    tangent: LimitTangent | None = None
    for _ in range(STEPS):
        residual, distance = limit.residual(at), limit.of(at)
        error = max(residual, abs(distance))
        if tangent is not None and residual <= SETTLED:
            other = at.revised()
            if other is None and residual <= RESIDUAL_TOLERANCE and abs(distance) <= REACHED:
                current_run().note("limit", residual=largest(at.equations), tangents=TANGENTS - left)
                return at
            at, tangent = (at, tangent) if other is None else (other, None)
        if tangent is None or tangent.tangent.n != at.equations.n or slow(error, errors):
            at = at if tangent is None else at.revised(CERTAIN * residual) or at
            if left == 0 or limit.residual(at) > FARTHEST_STATE:
                break
            tangent, left, errors = LimitTangent.at(at, distance, limit, hand), left - 1, [math.inf, math.inf]
        try:
            at, errors = tangent.stepped(at, distance, limit), [errors[1], error]
        except NotNearError:
            hand.drop()
            tangent = None
    raise NoPointsError(f"the limit was not reached with {TANGENTS - left} tangents")


def followed_to(
    problem: CoupledProblem, near: ElementEquilibrium, size: float, limit: LoadLimit, hand: FactorAtHand
) -> LoadedState:
    """The state at the limit under the equations of `problem`, from that `near` under a load of some `size`.

    Where it is lost between two speeds, those between follow one after the other.

    Raises
    ------
    NoPointsError
        It was lost between speeds `LEAST_PART` of the way apart.
    """
    before, ahead = near.equations.problem.bearing_number, problem.bearing_number
    done, part, at = 0.0, 1.0, near
    while True:
        there = before * (ahead / before) ** (done + part)
        target = problem if done + part == 1.0 else problem.at(bearing_number=there)
        try:
            found = at_limit(loaded_state(at, target, size), limit, hand)
        except NoPointsError:
            if before == ahead or part <= LEAST_PART:
                raise
            part *= 0.5
            continue
        done, at, size = done + part, found.positioned, found.size
        if done == 1.0:
            return found


def slow(error: float, before: list[float]) -> bool:
    """Whether the factor at hand serves no longer, by the error now and at the last two steps."""
    return error > CHORD * before[1] and (error > SETTLING or error > CHORD * before[0])
