"""Balances under loads of one direction, each from the nearest of those before, and how far they are from limits."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.fields import all_fields
from petalfoil.analysis.foretold_balance import foretold
from petalfoil.analysis.heat_results import with_heat
from petalfoil.analysis.other_bearing import bearing_of
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.case import Case
from petalfoil.equilibrium.at_limit import LoadedState, LoadLimit, followed_to
from petalfoil.equilibrium.element_contacts import clear_of_journal
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.followed_points import followed
from petalfoil.equilibrium.largest_load import LoadBranch
from petalfoil.equilibrium.nodal_state import sampled_solution
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold, from_neighbour, reloaded
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.near_factor import FactorAtHand
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.loaded import load_of
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]

FOLLOWED = 0.1
"""Relative change of the load over which contact points are followed by themselves: farther they are lost."""
PROBE = 1e-5
"""Relative change of the load by which the tangent foretells the slope of a limit."""
LEAST, MOST = 1e-6, 20.0
"""Loads that are looked at, over ambient pressure times length times diameter."""
SMALL = 1e-3
"""Load that hardly moves the journal, likewise: smaller ones grow to it in one step."""
CLEAR = 0.3
"""Distance beyond a limit (a film a quarter too thin) from which contacts at nodes lead on to a smaller load: points
take a hundred factorisations under heavy contact. Once a load is kept, all others are judged with points."""
PAST_TURN = 1.001
"""Load over the largest one of a branch, at which it is looked where the bearing snaps to."""
NO_BALANCE = "no balance was found beyond it"
BOTTOMED_OUT = "the pack is bottomed out beyond it"
"""Why a load is not carried, beside a limit."""


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a load must leave: each None where it does not matter.

    Attributes
    ----------
    min_film_thickness : float or None
        Least minimum film thickness [m].
    contact_fraction : float or None
        Largest contact fraction [1].
    max_stress : float or None
        Largest maximum bending stress [Pa].
    """

    min_film_thickness: float | None = None
    contact_fraction: float | None = None
    max_stress: float | None = None

    def margin(self, found: Evaluation) -> tuple[float, str]:
        """Relative distance from the nearest limit, negative beyond it, and the result that it limits."""
        margins: list[tuple[float, str]] = []
        if self.min_film_thickness is not None:
            margins.append((math.log(found.film().min_film_thickness / self.min_film_thickness), "min_film_thickness"))
        if self.contact_fraction is not None:
            margins.append((1.0 - found.contact_fraction / self.contact_fraction, "contact_fraction"))
        if self.max_stress is not None:
            stress = float(wall_kind(found.case).scalars(all_fields(found))["max_bending_stress"])
            margins.append((math.log(self.max_stress / max(stress, 1e-300)), "max_bending_stress"))
        return min(margins)


@dataclass(frozen=True)
class Loaded:
    """A balance, and how far it is from the limits.

    Attributes
    ----------
    size : float
        Its load [N].
    found : Evaluation
        The state.
    margin : float
        Distance from the nearest limit.
    limit : str
        The result that this limits.
    """

    size: float
    found: Evaluation
    margin: float
    limit: str


@dataclass
class LoadRay:
    """Balances of loads of one direction at one speed, each from the nearest of those before.

    Attributes
    ----------
    case : Case
        The bearing at its speed.
    direction : (2,)
        Unit vector of the load.
    limits : Limits
        What the loads must leave.
    known : Solution or None
        A balance to begin from, at any speed and under any load.
    points_alone : bool
        Whether contact points may be followed without an equilibrium with contacts at nodes beside them.
    hand : FactorAtHand
        The last factor of a search for a limit.
    lost : bool
        Whether the limit could not be followed from the known balance at another speed: the load or its contacts jump.
    nearest : Loaded or None
        Of the balances that were looked at, the one with the largest margin.
    """

    case: Case
    direction: tuple[float, float]
    limits: Limits
    known: Solution | None = None
    points_alone: bool = False
    hand: FactorAtHand = field(default_factory=FactorAtHand)
    lost: bool = field(default=False, init=False)
    nearest: Loaded | None = field(default=None, init=False)
    base: CoupledProblem = field(init=False)

    def __post_init__(self) -> None:
        if not self.case.shares_evenly:
            rotor = self._rotor(0.0)
            self.base = rotor.supports[int(rotor.turned)].problem
            return
        self.base = build_problem(self.case.replace(**{"operation.eccentricity": (0.0, 0.0)}))
        self.start_from(self.known)

    def start_from(self, known: Solution | None) -> None:
        """Balances are sought from a known one: its layout has the factors' elimination orders."""
        self.known = known
        if known is not None and self.case.shares_evenly:
            self.base = known.problem.at(
                bearing_number=self.base.bearing_number, displacement=np.zeros_like(self.base.displacement)
            )

    @property
    def unit(self) -> float:
        """Ambient pressure times length times diameter, of all bearings [N]."""
        bearing = self.case.bearing
        area = 2.0 * bearing.journal_radius * bearing.length
        return self.case.bearings * self.case.gas.ambient_pressure * area

    def load(self, size: float) -> Array:
        """The load over the unit of force, (n_position,) [1]."""
        x, y = self.direction
        return load_of(self.case, (size * x, size * y), self.base.layout)

    def at(self, size: float, *, cold: bool = False, by_nodes: bool = False) -> Loaded | str:
        """The balance under a load [N], or why there is none that a bearing can run with.

        Where the known one does not lead to it, it is sought from nothing if `cold` is set. With `by_nodes` it may be
        that with contacts at nodes, where that is far beyond a limit.
        """
        found = self._balanced(size, cold=cold, by_nodes=by_nodes and size > LEAST * self.unit)
        if isinstance(found, Loaded) and (self.nearest is None or found.margin >= self.nearest.margin):
            self.nearest = found
        return found

    def past(self, turn: Loaded) -> Loaded | str:
        """The balance, from nothing, under a little more than the load at which a branch turns back."""
        self.known = None
        return self.at(PAST_TURN * turn.size, cold=True)

    def _balanced(self, size: float, *, cold: bool, by_nodes: bool) -> Loaded | str:
        known = self.known
        if found := self._followed(size):
            return found
        try:
            answer = self._balance(size, cold=cold)
        except ConvergenceError:
            return NO_BALANCE
        if answer is None:
            return NO_BALANCE
        if answer.bottomed_out or (answer.other is not None and answer.other.bottomed_out):
            return BOTTOMED_OUT
        if answer.other is None and not (by_nodes and self._judged(size, answer).margin <= -CLEAR):
            answer = reported(self.case, answer, known)
        self.known = answer
        return self._judged(size, answer)

    def _balance(self, size: float, *, cold: bool) -> Solution | None:
        """The balance with contacts at nodes."""
        if not self.case.shares_evenly:
            return self._rotor(size).at(self.case.operation.speed, self.known)
        load = self.load(size)
        answer = None if self.known is None else self._neighbour(self.known, load)
        if answer is None and (self.known is None or cold):
            answer = balance_cold(self.base.at(displacement=np.zeros_like(self.base.displacement)), load)
        return None if answer is None else with_heat(self.case, answer)

    def to_limit(self) -> Loaded | None:
        """The balance at the limit, followed from the known one with the load as an unknown; None if it is lost."""
        return self._led(lambda known: followed_to(self.base, known, self._known_size, self._limit, self.hand))

    def along_branch(self) -> Loaded | None:
        """The balance of the largest load between the known one and the limit, followed likewise; None if it is lost.

        It is at the limit, or where the branch of the known one turns back.
        """
        known = self.known
        branch = LoadBranch(self.base, self._limit, self.hand)
        found = self._led(lambda near: branch.largest(near, self._known_size).at)
        if found is None and self._has_elements and known is not None:
            self.lost |= known.problem.bearing_number != self.base.bearing_number
        return found

    def under_known_load(self) -> Loaded | None:
        """The balance at this speed under the load of the known one, followed from it; None if it is lost."""
        size = self._known_size
        same = LoadLimit(self.load(1.0), lambda found, here: math.log(size / here))
        return self._led(lambda known: followed_to(self.base, known, size, same, self.hand))

    @property
    def _limit(self) -> LoadLimit:
        """The nearest limit of a state under a load of this direction."""
        unit = self.load(1.0)
        return LoadLimit(
            unit,
            lambda found, size: self._judged(size, sampled_solution(found, size * unit)).margin,
            small=SMALL * self.unit,
        )

    def _led(self, follow: Callable[[ElementEquilibrium], LoadedState]) -> Loaded | None:
        """The balance to which the known one is followed with the load as an unknown; None if it is lost."""
        known, unit = self.known, self.load(1.0)
        if not self._has_elements or known is None or known.elements is None:
            return None
        try:
            found = follow(known.elements)
            self.known = sampled_solution(clear_of_journal(found.positioned), found.size * unit)
        except NoPointsError as failure:
            current_run().note("limit", outcome=str(failure))
            return None
        return self._judged(found.size, self.known)

    @property
    def _has_elements(self) -> bool:
        """Whether contact points or asperities under a load are known, and followed by themselves."""
        known = self.known
        return self._follows and known is not None and known.load is not None and known.elements is not None

    @property
    def _known_size(self) -> float:
        """Size of the load of the known balance [N]; nan without one."""
        if self.known is None or self.known.load is None:
            return math.nan
        return float(np.linalg.norm(self.known.load) / np.linalg.norm(self.load(1.0)))

    def _followed(self, size: float) -> Loaded | None:
        """The balance under a load [N] whose contact points are followed from the known one; None if they are lost."""
        known, load = self.known, self.load(size)
        if not self._follows or known is None:
            return None
        if not isinstance(known.elements, PointContacts) or known.load is None:
            return None
        if not np.linalg.norm(load - known.load) <= FOLLOWED * np.linalg.norm(known.load):
            return None
        there = self.base.at(displacement=known.elements.equations.problem.displacement)
        try:
            self.known = sampled_solution(clear_of_journal(followed(known.elements, there, load)), load)
        except NoPointsError as failure:
            current_run().note("followed", outcome=str(failure))
            return None
        return self._judged(size, self.known)

    @property
    def _follows(self) -> bool:
        """Whether contact points are followed by themselves: those of one bearing alone, without a heat network."""
        return self.points_alone and self.case.heat is None and self.case.shares_evenly

    def _rotor(self, size: float) -> RotorInBearings:
        """The rotor under a load [N], where its bearings do not share it evenly."""
        x, y = self.direction
        return replace(self._bearings, load=(size * x, size * y))

    @cached_property
    def _bearings(self) -> RotorInBearings:
        """The rotor without load: its bearings are discretised once for all loads."""
        return RotorInBearings.of(self.case, (0.0, 0.0))

    def _neighbour(self, known: Solution, load: Array) -> Solution | None:
        if self.case.heat is not None:
            return from_neighbour(known, self.base.at(temperatures=known.problem.temperatures), load)
        same = known.problem.bearing_number == self.base.bearing_number
        return (reloaded(known, load) if same else None) or from_neighbour(known, self.base, load)

    def slope(self, here: Loaded) -> float:
        """Derivative of the margin by the logarithm of the load, foretold by the last tangent; nan without one.

        The tangent of a bearing with a heat network has the temperatures beside the position, and foretells none.
        """
        answer = here.found.answer
        if answer.contacts is None or answer.load is None or self.case.heat is not None or answer.other is not None:
            return math.nan
        ahead = self._judged(here.size, foretold(answer, PROBE * answer.load))
        return (ahead.margin - here.margin) / PROBE if ahead.limit == here.limit else math.nan

    def growth(self, here: Loaded) -> float:
        """Derivative of the logarithm of the load at the limit by that of the speed, foretold likewise; nan without."""
        answer, by_load = here.found.answer, self.slope(here)
        if answer.contacts is None or not by_load < 0.0:
            return math.nan
        ahead = self._judged(here.size, foretold(answer, np.zeros_like(self.load(here.size)), faster=PROBE))
        return -(ahead.margin - here.margin) / PROBE / by_load if ahead.limit == here.limit else math.nan

    def _judged(self, size: float, answer: Solution) -> Loaded:
        found = Evaluation.of(bearing_of(self.case, answer), answer)
        margin, limit = self.limits.margin(found)
        if answer.other is not None:  # the bearing that is nearer to its limit bounds the load
            other = Evaluation.of(self._rotor(size).untold(answer.other), answer.other)
            margin, limit = min((margin, limit), self.limits.margin(other))
        return Loaded(size, found, margin, limit)
