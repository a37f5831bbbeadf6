"""Contact lines between nodes, found from an equilibrium with contacts at nodes, and corrected by signs.

Newton's method of `line_contacts.py` takes two or three tangents: a step with the tangent at hand costs a solve. Then
signs are looked at (`line_signs.py`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.element_contacts import over_normal_forces
from petalfoil.equilibrium.heated import stiffness
from petalfoil.equilibrium.line_chords import by_chords, by_tangent
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError
from petalfoil.equilibrium.line_signs import closed_beside, freed_near_ends, parted, revised
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.travelling_contacts import NodalContacts, placed_points
from petalfoil.physics.contact import Contacts
from petalfoil.physics.contact_points import IsolatedContacts
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.constraints import constrain

Array = NDArray[np.float64]

STEPS = 10
"""Most tangents with one set of contacts; three or four serve in the median."""

PATIENCE = 2
"""Tangents after which a point at which the gap still does not curve upward is two contacts."""

SPLITS = 4
"""Most times that contacts split side by side; once or twice serves."""

SPLIT_STEPS = 4
"""Most tangents with one set of contacts that have split: none or one serve, since factors serve other contacts."""

REVISIONS = 16
"""Most sets of contacts: one or two serve in most packs, seven in ten petals at 280 µm, where ends of stretches recede
node by node."""


def with_lines(solution: Solution) -> Solution:
    """The solution with the equilibrium whose contact lines cross the stations between nodes, if there is one."""
    if solution.elements_sought:
        return solution
    found = between_nodes(solution)
    apart = None if found is None else force_apart(found, solution)
    return replace(solution, lines=found, elements_sought=True, nodal_force_difference=apart)


def force_apart(found: LineContacts, solution: Solution) -> float | None:
    """Difference of the force from that with contacts at nodes, over that force [1]; see `element_contacts`.

    On coarse grids several equilibria with contact lines lie near one with contacts at nodes: it tells how far this one
    may be from another. Under a load both carry the load: the difference is that of the load over the way between, by
    the stiffness with contacts at nodes; None where the interior point had the last word.
    """
    problem = solution.problem
    force = problem.journal_force(solution.x, solution.lam)
    if solution.load is None:
        return over_normal_forces(found.force - force, force, solution)
    if solution.contacts is None:
        return None
    by_position, way = solution.contacts.tangent.gradient, found.problem.displacement - problem.displacement
    if not by_position.size:  # of a bearing on a shaft, which was found where the shaft moved it
        by_position = -stiffness(solution, None)
    return over_normal_forces(by_position @ way, force, solution)


def between_nodes(solution: Solution) -> LineContacts | None:
    """The equilibrium with contact points near one with contacts at nodes; None where there is none nearby.

    None too where the contacts do not determine the pack (bottomed out) or the wall has fields of its own. The run log
    says so.
    """
    problem, run = solution.problem, current_run()
    if problem.layout.fields or not problem.layout.wall.contacts.lines or not np.any(solution.active):
        return None
    if not constrain(problem.G, solution.active).determinate:
        return None
    start = start_at(solution)
    freer = freed_near_ends(start)
    for begin in [start] if freer is start else [freer, start]:
        for plain in (False, True):
            try:
                found = settled(begin, plain=plain)
            except NoLinesError as failure:
                run.note("contact lines", outcome=str(failure))
                continue
            run.note("contact lines", residual=found.residual, points=len(found.reaction), nodes=int(found.held.sum()))
            return found
    return None


def start_at(solution: NodalContacts) -> LineContacts:
    """The state of an equilibrium with contacts at nodes, its isolated ones at the points where they are (K8)."""
    problem = solution.problem
    placed = placed_points(solution, problem.linearize(solution.x))
    points, reaction = points_on_lines(problem.layout.wall.contacts, placed)
    held = placed.at_nodes
    return LineContacts(problem, solution.x, points, reaction, held, solution.lam[held], solution.load)


def points_on_lines(contacts: Contacts, placed: IsolatedContacts) -> tuple[LinePoints, Array]:
    """Isolated contacts of a pack at their places on its lines, and their reactions (k,)."""
    groups, none = list(enumerate(placed.groups)), np.zeros(0, dtype=np.intp)
    points = LinePoints(
        contacts.lines,
        len(contacts.rest),
        np.concatenate([none, *(np.full(len(group.line), kind) for kind, group in groups)]),
        np.concatenate([none, *(group.line for _, group in groups)]),
        np.concatenate([np.zeros(0), *(group.position for _, group in groups)]),
    )
    return points, np.concatenate([np.zeros(0), *(group.reaction for _, group in groups)])


def settled(state: LineContacts, steps: int = STEPS, *, plain: bool = False) -> LineContacts:
    """Newton's method of as many `steps` at most, and other contacts as long as signs and gaps ask for them.

    With `plain` steps each set of contacts has tangents of its own: where points creep, that leads elsewhere.

    Raises
    ------
    NoLinesError
        Newton's method does not converge, or contacts keep changing.
    """
    return split(signed(state, steps, plain=plain), plain=plain)


def split(state: LineContacts, *, plain: bool = False) -> LineContacts:
    """The equilibrium with further points where gaps beside those of an equilibrium are below zero.

    Contacts that spread have split there. Where that leads to no other equilibrium, the gaps stay below zero; the run
    log says so.
    """
    failure = f"gaps still close after {SPLITS} sets of contacts"
    for _ in range(SPLITS):
        more = closed_beside(state)
        if more is None:
            return state
        try:
            state = signed(more, SPLIT_STEPS, plain=plain)
        except NoLinesError as reason:
            failure = str(reason)
            break
    current_run().note("contact lines", outcome=f"kept with gaps below zero beside contacts: {failure}")
    return state


def signed(state: LineContacts, steps: int, *, plain: bool) -> LineContacts:
    """Newton's method of as many `steps` at most, and other contacts as long as signs ask for them.

    Raises
    ------
    NoLinesError
        Newton's method does not converge, or contacts keep changing.
    """
    for _ in range(REVISIONS):
        state = newton(state, steps, plain=plain)
        other = revised(state) if state.balanced else parted(state)
        if other is None:
            return state
        state = other
    raise NoLinesError(f"contacts still change after {REVISIONS} sets of them")


def newton(state: LineContacts, steps: int, *, plain: bool = False) -> LineContacts:
    """Newton's method with the contacts as they are; it stops early where a point is two contacts (`doubled`).

    Raises
    ------
    NoLinesError
        The film has closed, or it does not converge.
    """
    if not state.problem.admits(state.x):
        raise NoLinesError("the film closes")
    state = state if plain else by_chords(state)
    for count in range(steps):
        if state.balanced or (count >= PATIENCE and np.any(state.doubled)):
            return state
        state = by_tangent(state, plain=plain)
        if state.balanced:
            return state
    raise NoLinesError(f"the residual is {state.residual:.1e} after {steps} tangents")
