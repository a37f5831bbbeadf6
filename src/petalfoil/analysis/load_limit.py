"""The largest load in one direction under which a bearing keeps to stated limits.

The load grows from where all limits are kept until one of them is reached. Each balance is followed from the one
before: its last tangent foretells how the limits change with the load, so that Newton's method on the logarithm of the
load needs a few balances, and most of them no factorisation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.fields import all_fields
from petalfoil.analysis.heat_results import with_heat
from petalfoil.analysis.other_bearing import bearing_of
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.case import Case
from petalfoil.equilibrium.element_tangent import ElementTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold, from_neighbour, reloaded
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.loaded import load_of
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]

KEPT = 1e-6
"""Relative distance from a limit at which it counts as reached."""
NARROW = 1e-9
"""Relative width of a bracket of loads in which a limit is crossed in a jump."""
PROBE = 1e-5
"""Relative change of the load by which the tangent foretells the slope of a limit."""
NARROW_WITHOUT = 1e-3
"""The same where no balance is found on the far side, or the pack is bottomed out: each look there is expensive."""
GROWTH = 2.0
"""Largest factor between one load and the next."""
LEAST, MOST = 1e-6, 20.0
"""Loads that are looked at, over ambient pressure times length times diameter."""
BALANCES = 60
"""Most balances of one search."""
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


@dataclass(frozen=True)
class Capacity:
    """The largest load that keeps to the limits.

    Attributes
    ----------
    at : Loaded or None
        The balance there; None where not even the least load keeps to them.
    status : str
        ``"converged"``, or what bounds the load instead of a limit.
    """

    at: Loaded | None
    status: str = "converged"


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
    """

    case: Case
    direction: tuple[float, float]
    limits: Limits
    known: Solution | None = None
    base: CoupledProblem = field(init=False)

    def __post_init__(self) -> None:
        if not self.case.shares_evenly:
            rotor = self._rotor(0.0)
            self.base = rotor.supports[int(rotor.turned)].problem
            return
        self.base = build_problem(self.case.replace(**{"operation.eccentricity": (0.0, 0.0)}))
        if self.known is not None:  # its layout has the factors' elimination orders
            self.base = self.known.problem.at(
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

    def at(self, size: float) -> Loaded | str:
        """The balance under a load [N], or why there is none that a bearing can run with."""
        known = self.known
        try:
            if self.case.shares_evenly:
                load = self.load(size)
                answer = balance_cold(self.base, load) if known is None else self._neighbour(known, load)
                answer = None if answer is None else with_heat(self.case, answer)
            else:
                answer = self._rotor(size).at(self.case.operation.speed, known)
        except ConvergenceError:
            return NO_BALANCE
        if answer is None:
            return NO_BALANCE
        if answer.contacts is None:  # the interior point had the last word
            return BOTTOMED_OUT
        self.known = answer if answer.other is not None else reported(self.case, answer, known)
        return self._judged(size, self.known)

    def _rotor(self, size: float) -> RotorInBearings:
        """The rotor under a load [N], where its bearings do not share it evenly."""
        x, y = self.direction
        return RotorInBearings.of(self.case, (size * x, size * y))

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


def foretold(answer: Solution, more: Array, faster: float = 0.0) -> Solution:
    """The balance under `more` load (n_position,) than that of `answer`, and a part `faster`, by its tangent alone."""
    if answer.elements is not None:
        return replace(answer, elements=foretold_on_elements(answer.elements, more, faster))
    if answer.lines is not None:
        return replace(answer, lines=answer.lines.foretold(more, faster))
    if answer.contacts is None:
        raise ValueError("an equilibrium of the interior point alone has no tangent")
    tangent, problem = answer.contacts.tangent, answer.problem
    there = problem.at(bearing_number=problem.bearing_number * (1.0 + faster))
    forcing = there.linearize(answer.x).residual - problem.linearize(answer.x).residual
    closing = there.gaps(answer.x) - problem.gaps(answer.x)
    move = np.linalg.solve(tangent.gradient, -more - tangent.border.rows(*tangent.respond(forcing, closing)))
    change, reactions = tangent.respond(
        forcing + tangent.forcing @ move, closing + tangent.border.gap_derivative @ move
    )
    moved = there.at(displacement=problem.displacement + move)
    return replace(answer, problem=moved, state=replace(answer.state, x=answer.x + change, lam=answer.lam + reactions))


def foretold_on_elements(found: ElementEquilibrium, more: Array, faster: float) -> ElementEquilibrium:
    """The same of petals with continuous slopes; one factorisation."""
    equations = found.equations
    problem, whole = equations.problem, equations.problem.layout.elements
    if whole is None:
        raise ValueError("this bearing has no petals with continuous slopes")
    there = problem.at(bearing_number=problem.bearing_number * (1.0 + faster))
    ahead = found.under(whole, there)
    tangent = ElementTangent.at(equations, -equations.force, current_run().probe_solver)
    forcing = ahead.equations.newton_residual - equations.newton_residual
    change, move = tangent.correction(forcing, ahead.equations.force - equations.force + more)
    return ahead.moved(there.at(displacement=problem.displacement + move), change)


def largest_load(ray: LoadRay, guess: float) -> Capacity:
    """The largest load of a ray that keeps to its limits, from a `guess` [N]."""
    size = min(max(guess, LEAST * ray.unit), MOST * ray.unit)
    kept: Loaded | None = None
    beyond, reason = math.inf, ""
    for _ in range(BALANCES):
        here = ray.at(size)
        if isinstance(here, Loaded) and abs(here.margin) <= KEPT:
            return Capacity(here)
        if isinstance(here, Loaded) and here.margin > 0.0:
            kept = here
        else:
            beyond = size
            reason = here if isinstance(here, str) else f"{here.limit} passes its limit there in a jump"
        if ended := bounded(ray, kept, (beyond, reason)):
            return ended
        size = following(ray, here, kept, beyond)
        if isinstance(here, str) and kept is not None:
            ray.known = kept.found.answer
    return Capacity(kept, "bounded from below: the search for the limit ran out of balances")


def bounded(ray: LoadRay, kept: Loaded | None, over: tuple[float, str]) -> Capacity | None:
    """What bounds the load where no limit is met exactly; None while the search goes on.

    Parameters
    ----------
    ray : LoadRay
        The loads.
    kept : Loaded or None
        The largest load that keeps to the limits.
    over : (float, str)
        The least load that does not [N], and why.
    """
    beyond, reason = over
    if kept is None:
        why = f"no load keeps to the limits: {reason}"
        return Capacity(None, why) if beyond <= LEAST * ray.unit else None
    if kept.size >= MOST * ray.unit:
        return Capacity(kept, f"no limit is reached up to {kept.size:.3g} N")
    narrow = NARROW_WITHOUT if reason in (NO_BALANCE, BOTTOMED_OUT) else NARROW
    return Capacity(kept, f"converged; {reason}") if beyond / kept.size - 1.0 <= narrow else None


def following(ray: LoadRay, here: Loaded | str, kept: Loaded | None, beyond: float) -> float:
    """The next load to look at: Newton's, inside what is known, else by a factor or in the middle [N]."""
    low, high = (0.0 if kept is None else kept.size), beyond
    if isinstance(here, Loaded) and (slope := ray.slope(here)) < 0.0:
        step = min(max(-here.margin / slope, -math.log(GROWTH)), math.log(GROWTH))
        if low < (ahead := here.size * math.exp(step)) < high:
            return min(max(ahead, LEAST * ray.unit), MOST * ray.unit)
    if math.isinf(high):
        return min(GROWTH * low, MOST * ray.unit)
    return math.sqrt(low * high) if low else max(high / GROWTH, LEAST * ray.unit)
