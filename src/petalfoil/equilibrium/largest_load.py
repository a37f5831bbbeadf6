"""The largest load on a branch of equilibria that leads to a limit: at the limit, or where the branch turns back.

A branch is followed by the distance `q` of its states from the limit (C13), down to zero. The load may have its largest
value on the way: the branch goes on with less load, and under more there is no equilibrium near, so that the bearing
snaps to another one. There `d ln W / d q` vanishes; it is negative before and positive behind.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from petalfoil.equilibrium.at_limit import REACHED, LimitTangent, LoadedState, LoadLimit, followed_to
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.solvers.near_factor import FactorAtHand
from petalfoil.system.coupled import CoupledProblem

LEAST_STEP = 0.01
"""Least step along a branch, in distances from the limit (a film 1 % thinner): where less is lost, the branch is."""

BACK = 10
"""Most such steps back to where more load leads to the limit; one between speeds a twentieth apart."""

STEPS = 40
"""Most steps along a branch, and most between two of its states; three to six are usual."""


@dataclass(frozen=True)
class BranchState:
    """An equilibrium of a branch.

    Attributes
    ----------
    at : LoadedState
        The state and its load.
    distance : float
        Its distance from the limit.
    rise : float
        Derivative of the logarithm of the load by the distance: negative as long as more load leads to the limit.
    """

    at: LoadedState
    distance: float
    rise: float


@dataclass
class LoadBranch:
    """A branch under one direction of the load, followed by the distance from a limit.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing at its speed.
    limit : LoadLimit
        The limit.
    hand : FactorAtHand
        The last factor.
    """

    problem: CoupledProblem
    limit: LoadLimit
    hand: FactorAtHand

    def state(self, near: ElementEquilibrium, size: float, distance: float) -> BranchState:
        """The state at a distance from the limit, from one `near` under a load of some `size`, at another speed too.

        Raises
        ------
        NoPointsError
            It was lost.
        """
        there = replace(
            self.limit, distance=lambda found, load: self.limit.distance(found, load) - distance, turns=True
        )
        found = followed_to(self.problem, near, size, there, self.hand)
        tangent = LimitTangent.at(found, there.of(found), there, self.hand)
        return BranchState(found, distance, 1.0 / tangent.slope)

    def largest(self, near: ElementEquilibrium, size: float) -> BranchState:
        """The state of the largest load between one `near` and the limit.

        Raises
        ------
        NoPointsError
            The branch was lost before either.
        """
        here = self.state(near, size, max(self.limit.distance(near, size), 0.0))
        if near.equations.problem.bearing_number != self.problem.bearing_number:
            here = self.before_turn(here)
        if here.rise > 0.0:
            raise NoPointsError("more load leads away from the limit")
        step = here.distance
        for _ in range(STEPS):
            if here.distance <= REACHED:
                return here
            ahead = self.ahead(here, max(here.distance - step, 0.0))
            if ahead is None and step < LEAST_STEP:
                raise NoPointsError("the branch was lost before the limit")
            if ahead is None:
                step *= 0.5
            elif ahead.rise > 0.0:
                return self.turn(here, ahead)
            else:
                here = ahead
        raise NoPointsError(f"the limit was not reached in {STEPS} steps along the branch")

    def before_turn(self, here: BranchState) -> BranchState:
        """A state before the largest load, from one that may be a little behind it, as of another speed."""
        for _ in range(BACK):
            if here.rise < 0.0:
                return here
            here = self.beside(here, here.distance + LEAST_STEP)
        return here

    def ahead(self, here: BranchState, distance: float) -> BranchState | None:
        """The state at a distance nearer to the limit; None if it is lost, or a turn and another one lie between."""
        try:
            found = self.beside(here, distance)
        except NoPointsError:
            return None
        return None if found.rise < 0.0 and found.at.size < here.at.size else found

    def beside(self, here: BranchState, distance: float) -> BranchState:
        """The state at another distance."""
        return self.state(here.at.positioned, here.at.size, distance)

    def turn(self, before: BranchState, behind: BranchState) -> BranchState:
        """The state of the largest load between one before it and one behind it, by secants that keep it enclosed."""
        low, high = before.rise, behind.rise
        for _ in range(STEPS):
            apart = behind.distance - before.distance
            middle = self.beside(before, before.distance - apart * low / (high - low))
            bend = (behind.rise - before.rise) / apart
            if middle.rise**2 <= 2.0 * REACHED * abs(bend):  # what the load still grows by, relative to it
                return middle
            if middle.rise < 0.0:
                before, low, high = middle, middle.rise, 0.5 * high
            else:
                behind, high, low = middle, middle.rise, 0.5 * low
        raise NoPointsError("the largest load of the branch was not enclosed")
