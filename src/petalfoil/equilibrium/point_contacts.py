"""Equilibria with contact points that travel: from an equilibrium with contacts at nodes, by Newton's method.

Runs of active nodes become points or stretches (`contact_runs.py`). Newton's method on deflections, pressures,
reactions and places (C6) to (C8) follows, under a load with the journal's position bordered (C10). Steps are halved
until the residual falls. Then signs are looked at: a reaction that pulls leaves, a gap that has closed elsewhere gains
a contact, and Newton's method goes on.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.amended_factor import OWN, ServingFactor
from petalfoil.equilibrium.contact_sets import SAMPLES, beside_contacts, merged, revised
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError, scaled_force, unbalanced
from petalfoil.equilibrium.point_prospects import SearchedSets, check_prospects
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import AT_POINTS
from petalfoil.physics.gap_curves import ContactPoints, sampled
from petalfoil.solvers.problem import POSITIVE_FRACTION, RESIDUAL_TOLERANCE
from petalfoil.solvers.secants import Secants
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.walls.element_pack import ElementPack

Array = NDArray[np.float64]
AnyEquations = TypeVar("AnyEquations", bound=PointEquations)

TRUST = 0.35
"""Farthest that a point travels in a step, in elements."""

MOST_GROWTH = 4.0
"""Largest growth of a film pressure in a step, over the pressure."""

CLOSED = 1e-6
"""Film thickness over that of a contact below which the film has closed: steps that take four fifths of it each end at
zero by rounding. A solution has at least the film of a contact less `element_contacts.DEEPEST`."""

SHORTEST = 0.1
"""Shortest step over Newton's; it is taken even if the residual does not fall."""

CREEP = 0.9
"""Residual after a tangent over that before it above which Newton's method creeps."""


class Search(NamedTuple):
    """One way to search for contact points.

    Attributes
    ----------
    most : int
        Most factorisations, all sets of contacts together.
    creeping : int
        Tangents that creep after which a whole step is taken, whatever its residual: where points meet or pass a node
        no short step lessens it. 13 of 122 random packs took up to 42 steps there, to the same points.
    """

    most: int
    creeping: int


FIRST, SECOND = Search(48, 3), Search(48, 4)
"""A search that takes all its factorisations begins again and creeps once more before a whole step: some packs are
found by either alone. In vain it is 48 more for a seventh of random packs."""

FARTHEST_MOVE = 0.5
"""Longest move of the journal under a load in a step, in units of the reference film (5 um)."""

CHORD, CLOSE_CHORD = 0.2, 0.35
"""Residual after a step over that before it, up to which the factor at hand serves another step, at half the cost: far
from a solution, and close to it, where steps are bettered by secants (C15)."""

CLOSE = 1e-3
"""Residual (root of the squares) from which on a solution is close. Farther away secants lead elsewhere: with them the
rig has no contact points."""

POLISHED = 1e-3
"""Residual over that of a solution below which another step changes no printed digit."""


@dataclass(frozen=True)
class PointContacts:
    """An equilibrium with contact points.

    Attributes
    ----------
    equations : PointEquations
        The equations at its state.
    residual : float
        Largest scaled residual.
    tangent : ElementTangent or None
        The last tangent that led to it; None of a state that is not solved.
    """

    equations: PointEquations
    residual: float
    tangent: ElementTangent | None = field(default=None, repr=False)

    @property
    def gradient(self) -> Array | None:
        """Force by the journal's position under a load, from the last tangent; None at a given position."""
        return None if self.tangent is None or not self.tangent.gradient.size else self.tangent.gradient

    @property
    def pack(self) -> ElementPack:
        """Its petals."""
        return self.equations.whole.pack

    @property
    def points(self) -> ContactPoints:
        """Its contacts."""
        return self.equations.state.points

    @property
    def friction_points(self) -> ContactPoints:
        """Points at which friction between petals acts: its contacts."""
        return self.points

    @property
    def contact_model(self) -> str:
        """Where its contacts are, for people."""
        return AT_POINTS

    def at(self, problem: CoupledProblem, load: Array | None = None) -> PointContacts:
        """The equilibrium of a neighbouring problem; under a load from there.

        Raises
        ------
        NoPointsError
            None was found.
        """
        return with_points(self.equations.whole, problem, self.equations.state, load)

    @property
    def gaps(self) -> tuple[Array, NDArray[np.bool_]]:
        """Gaps along all curves over the reference length [1], and which of them are beside a contact, (sample,)."""
        curves, points = self.equations.whole.curves, self.points
        curve, position, gap = sampled(curves, points, self.equations.nodal_gaps, SAMPLES)
        return gap, beside_contacts(points, curve, position)

    def under(self, whole: PointLayout, problem: CoupledProblem) -> PointContacts:
        """The same state under other equations with as many elements, unsolved."""
        return PointContacts(PointEquations(whole, problem, self.equations.state), self.residual)

    def moved(self, problem: CoupledProblem, change: Array) -> PointContacts:
        """The state after a small `change` (n,) of the unknowns, under the equations of `problem`, unsolved."""
        state = changed(self.equations, change)
        return PointContacts(replace(self.equations, problem=problem, state=state), self.residual)

    def nonlinearity(self, moved: PointContacts) -> float:
        """How far points travel, in elements or in distances from the next point; 1 where points meet."""
        before, after, curve = self.points.position, moved.points.position, self.points.curve
        if len(after) != len(before):
            return 1.0
        apart, travel = np.diff(before)[np.diff(curve) == 0], after - before
        nearer = np.diff(travel)[np.diff(curve) == 0] / apart
        return float(np.max(np.abs(np.concatenate([travel, nearer])), initial=0.0))


class StillChangingError(NoPointsError):
    """A search for contact points took all its factorisations."""


def with_points(
    whole: PointLayout, problem: CoupledProblem, state: PointState, load: Array | None = None
) -> PointContacts:
    """The equilibrium of `problem` near a state; under a `load` (n_position,) at the position that carries it.

    Raises
    ------
    NoPointsError
        None was found.
    """
    start = PointEquations(whole, problem, state)
    try:
        return searched(start, load, FIRST)
    except StillChangingError:
        return searched(start, load, SECOND)


def searched(
    equations: PointEquations, load: Array | None, search: Search, *, own: int = OWN, sparing: bool = False
) -> PointContacts:
    """The equilibrium that one search leads to; `own` and `sparing` are those of its `ServingFactor`.

    Raises
    ------
    StillChangingError
        It would take more factorisations.
    NoPointsError
        It leads nowhere.
    """
    left, changes, seen = search.most, 0, SearchedSets()
    serving = ServingFactor(current_run().film_solver, own, sparing)
    while True:
        equations, steps, tangent = newton(equations, left, (load, serving), search)
        points, left = revised(equations), left - steps
        seen.check(equations, points)
        if points is None:
            residual, found = float(np.max(np.abs(equations.scaled))), equations.state.points
            current_run().note(
                "contact points",
                residual=residual,
                changes=changes,
                points=len(found.curve),
                in_stretches=int(found.inner.sum()),
            )
            return PointContacts(equations, residual, tangent)
        equations, changes = replace(equations, state=replace(equations.state, points=points)), changes + 1


def newton(
    equations: PointEquations, most: int, asked: tuple[Array | None, ServingFactor], search: Search
) -> tuple[PointEquations, int, ElementTangent | None]:
    """Newton's method with the contacts as they are, apart from points that meet, in at most `most` tangents.

    Returns the equations, the tangents and the last of them. A tangent serves on as long as every step with it
    lessens the residual to `CHORD` of it. `asked` are the load and the factor that serves all tangents.

    Raises
    ------
    StillChangingError
        It would take more.
    NoPointsError
        It does not converge.
    """
    (load, serving), tangent, creeping = asked, None, 0
    size, largest = norm(equations, load)
    for count in range(most):
        if largest <= RESIDUAL_TOLERANCE and count:
            return equations, count, tangent
        check_prospects(equations, search.most - most + count)
        tangent, first, whole_step = serving.tangent(equations, load), size, creeping == search.creeping
        equations = by_tangent(equations, tangent, load, whole_step=whole_step)
        size, largest = norm(equations, load)
        creeping = creeping + 1 if size > CREEP * first and not whole_step else 0
    raise StillChangingError(f"contacts or the residual, {largest:.1e}, still change after {search.most} steps")


def by_tangent(
    equations: PointEquations, tangent: ElementTangent, load: Array | None, *, whole_step: bool
) -> PointEquations:
    """The equations after steps with one tangent, as long as they gain; the first one may be a `whole_step`.

    Raises
    ------
    NoPointsError
        The film has closed.
    """
    gain, secants, (size, largest) = 0.0, Secants(), norm(equations, load)
    while largest > POLISHED * RESIDUAL_TOLERANCE and tangent.n == equations.n:
        if gain > (CHORD if size > CLOSE else CLOSE_CHORD):
            break
        change, move = tangent.correction(equations.newton_residual, unbalanced(equations, load))
        if size <= CLOSE:
            both = secants.bettered(all_unknowns(equations), np.concatenate([change, move]))
            change, move = both[: equations.n], both[equations.n :]
        equations = stepped(equations, (change, move), load, whole_step=whole_step and not gain)
        before, (size, largest) = size, norm(equations, load)
        gain = size / before
    return equations


def all_unknowns(equations: PointEquations) -> Array:
    """Deflections, pressures, reactions, places and the journal's position, (n + n_position,) [1]."""
    points = equations.state.points
    unknowns = equations.deflection, equations.pressures, points.reaction, points.position
    return np.concatenate([*unknowns, equations.problem.displacement])


def norm(equations: PointEquations, load: Array | None) -> tuple[float, float]:
    """Root of the squares of all scaled residuals, and the largest of them; the unbalanced force among them.

    Raises
    ------
    NoPointsError
        The film has closed.
    """
    refuse_closed(equations)
    left = np.concatenate([equations.scaled, scaled_force(equations, load)])
    return float(np.linalg.norm(left)), float(np.max(np.abs(left)))


def refuse_closed(equations: PointEquations) -> None:
    """Raise where the film has closed: its equations divide by it.

    Raises
    ------
    NoPointsError
        It has.
    """
    floor = equations.whole.pack.floor / equations.whole.layout.scales.length
    if not np.all(equations.film_thickness.ravel() > CLOSED * floor):
        raise NoPointsError("the film closes")


def stepped(
    equations: AnyEquations, change: tuple[Array, Array], load: Array | None, *, whole_step: bool = False
) -> AnyEquations:
    """The equations after the longest part of `change` (of unknowns and position) that lessens the residual.

    A `whole_step` is only shortened where pressures or the film would vanish, or the journal goes too far.
    """
    (dX, move), length = change, admitted(equations, change, FARTHEST_MOVE)
    before = np.inf if whole_step else norm(equations, load)[0]
    while True:
        problem = equations.problem.at(displacement=equations.problem.displacement + length * move)
        ahead = replace(equations, problem=problem, state=changed(equations, length * dX))
        other_contacts = ahead.n != equations.n
        if whole_step or other_contacts or length <= SHORTEST or norm(ahead, load)[0] < before:
            return ahead
        length = max(0.5 * length, SHORTEST)


def admitted(equations: PointEquations, change: tuple[Array, Array], farthest: float) -> float:
    """The part of a change (of unknowns and position) after which film and pressures are positive [1].

    The journal moves by `farthest` reference films at most.

    Raises
    ------
    NoPointsError
        The film has closed.
    """
    refuse_closed(equations)
    falls, growth = equations.relative_changes(*change)
    most = max(1.0, falls / POSITIVE_FRACTION, growth / MOST_GROWTH)
    return min(1.0 / most, farthest / max(math.hypot(*change[1]), farthest))


def changed(equations: PointEquations, change: Array, farthest: float = TRUST) -> PointState:
    """The state after a change of the unknowns, points on their curves and merged where they meet.

    Points travel by `farthest` elements at most.
    """
    state, whole = equations.state, equations.whole
    film = whole.n_wall
    lam = film + whole.n_film
    at = lam + len(state.points.reaction)
    place = state.points.position + np.maximum(np.minimum(change[at:], farthest), -farthest)
    points = replace(
        state.points,
        position=np.maximum(np.minimum(place, whole.curves.elements[state.points.curve]), 0.0),
        reaction=state.points.reaction + change[lam:at],
    )
    return PointState(state.w + change[:film], state.P + change[film:lam], merged(points))
