"""One implicit stage in time with contacts between nodes: film, petals, contacts and rotor in one Newton.

The stage is a balance under a load: Newton's method on deflections, pressures, reactions, places and position, then
contacts by their signs. One factorisation serves as many corrections, stages and steps as it contracts, as long as the
contacts are the same or differ in what it can be amended by; a stage ends by the size of its correction.

Two kinds of contacts are solved so: contact points in 2-D (`point_stage.py`), contact lines in 3-D (`line_stage.py`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, Protocol, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.stage import Stage, left_after
from petalfoil.dynamics.time_state import TimeState
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.line_contacts import NoLinesError
from petalfoil.equilibrium.run_context import current_run

Array = NDArray[np.float64]

SETS = 12
"""Most sets of contacts of a stage: most stages have one, a step in which petals come to touch two or three."""

TANGENTS = 5
"""Most factorisations with one set of contacts."""

CORRECTIONS = 10
"""Most corrections with one tangent."""

AMENDMENTS = 2
"""Most times in turn that a factor is amended for what has changed since, before another one is made: with 1 and 3 six
turns of eight thin petals in 3-D take 71 and 51 factorisations for 59, in the same time."""

MORE = 2
"""Corrections that contract slowly and are still taken where they lead to the accuracy of a stage: a factorisation
costs as much as six of them."""

TOUCHING = 1e-4
"""Largest gap, and slope by the place in an element or a cell, at the points of a stage's state, in reference films."""

BALANCED = 1e-3
"""Largest residual of the petals' rows, over ambient pressure on a node, and of the film's over the flows of a cell:
where points travel far, corrections of films and pressures alone do not tell whether they are there. Contacts at nodes
leave up to 5e-4."""

GROWING = 2.0
"""Growth of the correction past which a tangent no longer serves."""


class StageEquations(Protocol):
    """The equations of a stage at one state, as its end is judged."""

    @property
    def film_imbalance(self) -> float:
        """Largest residual of the film's rows over the flows of their cells."""

    @property
    def wall_imbalance(self) -> float:
        """Largest residual of the petals' rows over what they are compared with."""

    @property
    def opening(self) -> float:
        """Largest gap, and slope by the place in an element or a cell, at the contacts [reference films]."""


class StageTangent(Protocol):
    """A factorised tangent that serves many stages."""

    def seen(self, correction: float, residual: float) -> Self:
        """The same after a correction of this size has answered what another one left."""


StageState = TypeVar("StageState", bound=StageEquations)
HeldTangent = TypeVar("HeldTangent", bound=StageTangent)
StageChange = TypeVar("StageChange")


@dataclass(frozen=True)
class TravellingSolution(Generic[StageState, HeldTangent]):
    """What a stage reaches: its equations, what is stepped, the tangent that found it, its largest scaled residual."""

    equations: StageState
    moving: TimeState
    tangent: HeldTangent
    residual: float


class TravellingStage(ABC, Generic[StageState, HeldTangent, StageChange]):
    """A stage with contacts between nodes.

    Attributes
    ----------
    stage : Stage
        Film, speed, rotor and what the stage starts from.
    """

    stage: Stage

    @cached_property
    def load(self) -> Array:
        """`L`: all of (O3) that does not depend on the position, (d,) [1]."""
        stage = self.stage
        base = stage.base
        return np.asarray(stage.outside + stage.border_stiffness @ base.e + stage.rate * (stage.inertia @ base.v))

    def reached(
        self, state: StageState, tangent: HeldTangent | None
    ) -> TravellingSolution[StageState, HeldTangent] | None:
        """The stage's state near one; None if there is none near it."""
        try:
            self.refuse_closed(state)
            for _ in range(SETS):
                state, tangent = self.settled(state, tangent)
                other = self.revised(state)
                if other is None:
                    return TravellingSolution(state, self.moving(state), tangent, self.residual(state))
                state = other
        except (NoPointsError, NoLinesError) as e:
            current_run().note("stage", outcome=str(e))
        return None

    def settled(self, state: StageState, tangent: HeldTangent | None) -> tuple[StageState, HeldTangent]:
        """The state with the contacts as they are, apart from points that meet.

        Raises
        ------
        NoPointsError, NoLinesError
            It is not found.
        """
        made, amended = 0, 0
        while made < TANGENTS:
            if tangent is not None:
                tangent = self.serving(tangent, state, closely=amended > 0) if amended <= AMENDMENTS else None
            if tangent is None:
                tangent, made, amended = self.tangent_at(state), made + 1, 0
            state, tangent, found = self.corrected(state, tangent)
            if found:
                return state, tangent
            state, amended = self.untangled(state), amended + 1
        raise NoPointsError("the corrections of a stage do not contract")

    def corrected(self, state: StageState, tangent: HeldTangent) -> tuple[StageState, HeldTangent, bool]:
        """The state after corrections with one tangent, as long as they contract, and whether it is that of the stage.

        Raises
        ------
        NoPointsError, NoLinesError
            The film closes.
        """
        options, last = self.stage.options, np.inf
        for number in range(CORRECTIONS):
            before = state.film_imbalance if number else 0.0
            change, state = self.correction(state, tangent)
            size = self.size(change)
            if not np.isfinite(size) or size > GROWING * last:
                break
            if number:
                tangent = tangent.seen(size, before)
            state = self.stepped(state, tangent, change)
            if not self.serves(tangent, state):
                break
            contraction = size / last if number else options.slow
            left = left_after(size, contraction)
            if min(left, self.asked_for(tangent, state)) <= options.accuracy and balanced(state):
                return state, tangent, True
            if number and contraction > options.slow and left * contraction**MORE > options.accuracy:
                break
            last = size
        return state, tangent, False

    @abstractmethod
    def refuse_closed(self, state: StageState) -> None:
        """Raise where the film is closed."""

    @abstractmethod
    def revised(self, state: StageState) -> StageState | None:
        """The state with other contacts, where the signs ask for them; None where they are right."""

    @abstractmethod
    def tangent_at(self, state: StageState) -> HeldTangent:
        """The factorised equations at a state."""

    @abstractmethod
    def serving(self, tangent: HeldTangent, state: StageState, *, closely: bool) -> HeldTangent | None:
        """A tangent at hand as it serves the contacts of a state; None where it does not.

        `closely` where its corrections did not contract: amended for lesser changes too.
        """

    def untangled(self, state: StageState) -> StageState:
        """The state with other contacts in place of those that keep corrections from contracting: none of them."""
        return state

    @abstractmethod
    def serves(self, tangent: HeldTangent, state: StageState) -> bool:
        """Whether a tangent still does after a correction with it."""

    @abstractmethod
    def correction(self, state: StageState, tangent: HeldTangent) -> tuple[StageChange, StageState]:
        """A step of Newton's method, and the state it belongs to."""

    @abstractmethod
    def size(self, change: StageChange) -> float:
        """Size of a correction [reference films, ambient pressures]."""

    @abstractmethod
    def stepped(self, state: StageState, tangent: HeldTangent, change: StageChange) -> StageState:
        """The state after a correction."""

    @abstractmethod
    def asked_for(self, tangent: HeldTangent, state: StageState) -> float:
        """Correction that what is left of the film's rows asks for, as far as the tangent has been seen to answer."""

    @abstractmethod
    def residual(self, state: StageState) -> float:
        """Largest scaled residual."""

    @abstractmethod
    def moving(self, state: StageState) -> TimeState:
        """Gas, position and velocity of a state of this stage."""


def balanced(state: StageEquations) -> bool:
    """Whether gaps and slopes vanish at the contact points, and petals and film are in balance."""
    return petals_balanced(state) and state.film_imbalance <= BALANCED


def petals_balanced(state: StageEquations) -> bool:
    """The same of contacts and petals alone: between steps, what the film stores need not be that of a stage."""
    return state.opening <= TOUCHING and state.wall_imbalance <= BALANCED
