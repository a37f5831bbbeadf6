"""Contact points followed from one equilibrium to the next by Newton's method.

The first step is foretold by the last tangent of the neighbour: `F_s` is what another speed leaves of its rows, `de`
the way to a given position, which enters as it does in (C10).

    J dX + F_e de = -F_s                                                                               (C14)
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.amended_factor import ServingFactor
from petalfoil.equilibrium.contact_runs import divisions
from petalfoil.equilibrium.contact_sets import listed, packed, revised
from petalfoil.equilibrium.continuation import FAR_FOLLOWED
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError, unbalanced
from petalfoil.equilibrium.point_contacts import (
    POLISHED,
    PointContacts,
    admitted,
    all_unknowns,
    changed,
    norm,
)
from petalfoil.equilibrium.point_prospects import diverged
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.secants import Secants
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations

Array = NDArray[np.float64]

TANGENTS = 8
"""Most tangents from an equilibrium to the next: one to three between points of a curve, four over a third of
the speed."""

OWN = 4
"""Tangents with factors of their own, before the last of these serves on: few take more, and to amend one costs as much
as three or four factors."""

SURE = 3
"""Tangents after which a residual that grows from one to the next is not going to fall."""

FARTHEST_MOVE = 0.5
"""Longest move of the journal under a load in a step, in units of the reference film (5 um)."""

FARTHEST_TRAVEL = 3.0
"""Farthest that a contact point travels in a step, in elements."""

CHORD = 0.1
"""Residual after a step over that before it, up to which the factor at hand serves another step. Steps along the
steepest part of a run-up leave 0.1 to 0.3, and a tangent costs three of them."""

ROUNDED, ROUNDED_AT_MOST = 1.25, 0.1
"""Residual over that of the neighbour, whose steps ended where rounding is left, and over that of a solution, below
which no more than that is left here either."""

NEAR = 1e-3
"""Foretold change of an unknown at least, of which ten times is no jump: a contact that is found 2 nm deep moves the
others by as much."""


def followed(
    near: PointContacts, problem: CoupledProblem, load: Array | None, serving: ServingFactor | None = None
) -> PointContacts:
    """The equilibrium of a neighbouring problem from that `near`, in a few whole steps; under a load with its position.

    A factor that is `serving` already serves its tangents; else the first ones have factors of their own.

    The residual may grow on the way: for points that travel it does so in the first step, and halving that step would
    lead there in ten short ones.

    Raises
    ------
    NoPointsError
        None was found, or one much farther away than the tangent foretold.
    """
    equations, tangent = under(near.equations, problem), foretelling(near, load)
    foretold, before, serving = NEAR, np.inf, serving or ServingFactor(current_run().film_solver, OWN)
    for count in range(TANGENTS):
        size, largest = norm(equations, load)
        if count and largest <= RESIDUAL_TOLERANCE and not np.any(way(equations, problem, load)):
            points = revised(equations, closely=True)
            if distance(near.equations, equations) > FAR_FOLLOWED * foretold:
                raise NoPointsError("it is much farther away than the tangent foretold")
            if points is None:
                return PointContacts(equations, float(np.max(np.abs(equations.scaled))), tangent)
            equations, largest = replace(equations, state=replace(equations.state, points=points)), np.inf
        if diverged(equations.state) or (count >= SURE and before < largest < np.inf):
            break
        before = largest
        if count or tangent is None:
            tangent = serving.tangent(equations, load)
        given, secants = count == 0 or bool(np.any(way(equations, problem, load))), Secants()
        equations = stepped(equations, (tangent, None if given else secants), problem, load)
        if not count:
            foretold = max(distance(near.equations, equations), NEAR)
            points = evenly_divided(equations.state.points)
            equations = replace(equations, state=replace(equations.state, points=points))
        part = 1.0 if given else norm(equations, load)[0] / size
        equations = settled(equations, (tangent, secants), problem, (load, part, near.residual))
    raise NoPointsError(f"not followed with at most {TANGENTS} tangents")


def under(equations: PointEquations, problem: CoupledProblem) -> PointEquations:
    """Those of a state under another problem, at the state's position; the same, with all they know, at one speed."""
    before = equations.problem
    start = problem.at(displacement=before.displacement)
    steady = type(start) is CoupledProblem and type(before) is CoupledProblem
    known = start.layout is before.layout and start.temperatures is before.temperatures
    if steady and known and start.bearing_number == before.bearing_number:
        return equations
    return replace(equations, problem=start)


def distance(one: PointEquations, other: PointEquations) -> float:
    """Largest difference of an unknown of petals or film: over the reference film, over the ambient pressure [1]."""
    pairs = (one.deflection, other.deflection), (one.pressures, other.pressures)
    return max(float(np.max(np.abs(after - before), initial=0.0)) for before, after in pairs)


def foretelling(near: PointContacts, load: Array | None) -> ElementTangent | None:
    """The last tangent of an equilibrium, under a load with the position bordered; None if it is of other contacts."""
    tangent = near.tangent
    if tangent is None or tangent.n != near.equations.n:
        return None
    if load is None or tangent.units.shape[1]:
        return tangent
    return ElementTangent.of(near.equations, load, tangent.factor)


def way(equations: PointEquations, problem: CoupledProblem, load: Array | None) -> Array:
    """What is left of the way to a given position, (n_position,) [1]; nothing under a load, whose position follows."""
    if load is not None:
        return np.zeros(len(load))
    return np.asarray(problem.displacement - equations.problem.displacement)


def stepped(
    equations: PointEquations,
    chord: tuple[ElementTangent, Secants | None],
    problem: CoupledProblem,
    load: Array | None,
) -> PointEquations:
    """The equations after a step, shortened where pressures or the film would vanish.

    `chord` is a tangent and what steps with it have shown, None where the step also goes to a given position.
    """
    (tangent, secants), left, ahead = chord, way(equations, problem, load), equations.newton_residual
    if np.any(left):
        ahead = ahead + equations.forcing() @ left
    change, move = tangent.correction(ahead, unbalanced(equations, load))
    if secants is not None:
        both = secants.bettered(all_unknowns(equations), np.concatenate([change, move]))
        change, move = both[: equations.n], both[equations.n :]
    move, farthest = (left, np.inf) if load is None else (move, FARTHEST_MOVE)
    length = admitted(equations, (change, move), farthest)
    place = equations.problem.displacement + length * move
    if load is None and length == 1.0:
        place = problem.displacement
    state = changed(equations, length * change, FARTHEST_TRAVEL)
    return replace(equations, problem=problem.at(displacement=place), state=state)


def settled(
    equations: PointEquations,
    chord: tuple[ElementTangent, Secants],
    problem: CoupledProblem,
    asked: tuple[Array | None, float, float],
) -> PointEquations:
    """The equations after as many further steps with the same factor as leave `CHORD` of the residual each, or less.

    The last one is kept if it leaves less at all. Steps end where nothing but rounding is foretold: each leaves such a
    part as the one before it, or the residual is that of the neighbour. `asked` are the load, the part that the step
    before left, and that residual.
    """
    (load, part, rounded), (tangent, _) = asked, chord
    least = max(POLISHED, min(ROUNDED * rounded / RESIDUAL_TOLERANCE, ROUNDED_AT_MOST)) * RESIDUAL_TOLERANCE
    if np.any(way(equations, problem, load)):
        return equations
    size, left = norm(equations, load)
    while left > least and tangent.n == equations.n:
        ahead = stepped(equations, chord, problem, load)
        before, (size, largest) = size, norm(ahead, load)
        left = min(part * left, largest) if largest <= RESIDUAL_TOLERANCE else largest
        part = size / before
        if part < 1.0:
            equations = ahead
        if part > CHORD:
            break
    return equations


def evenly_divided(points: ContactPoints) -> ContactPoints:
    """The points with stretches divided anew, where they have become longer or shorter by a `SPACING`."""
    contacts = listed(points)
    for contact, ahead in pairwise(contacts):
        wanted = max(divisions(ahead.position - contact.position), 1)
        if contact.inner and wanted != len(contact.inner):
            contact.inner = [sum(contact.inner) / wanted] * wanted
    return packed(contacts)
