"""An equilibrium with contact points under a fine film, from that of the same petals under a coarse one (2-D).

Petals have elements of their own, the same under every grid of the film: deflections and contact points are carried
over as they are. Pressures follow by monotone cubics of their logarithm, and Newton's method goes on from there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.element_contacts import (
    agreeing,
    clear_of_journal,
    over_normal_forces,
    start_at,
    tightened,
)
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.nodal_state import sampled_solution
from petalfoil.equilibrium.point_contacts import PointContacts, Search, searched
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.mesh.splines import monotone
from petalfoil.solvers.constraints import constrain
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointState

Array = NDArray[np.float64]

COARSE_FILM_CELLS = 32
"""Cells per pitch of the coarse film, as many as a petal has elements by default: nodes of both coincide."""

WORTH = 2.0
"""Least number of cells over those of the coarse film: with fewer an equilibrium there saves little."""

SEARCHED = Search(48, 2)
"""The search for contact points under the coarse film: one factor serves most of its tangents."""

CARRIED = Search(12, 2)
"""The search for contact points from those of the coarse film: one or two tangents serve, the rig takes seven."""

CARRIED_OWN = 1
"""Tangents of that search with factors of their own: the first of them has the pressures that the others have."""

APART = 0.1
"""Largest difference of the force from that under the coarse film, over that force."""


def coarser_film(case: Case, load: Array | None = None) -> Case | None:
    """The same bearing under a coarse film; None where that saves little, and where that leads nowhere.

    It does not in 3-D, with temperatures, friction between petals or unequal bearings. A moment is balanced under a
    `load` only.
    """
    slides, balances = case.surface.petal_friction == 0.0, load is not None or case.operation.moment is None
    has_points = case.has_contact_points and case.heat is None and case.shares_evenly and case.operation.speed > 0.0
    if not (has_points and slides and balances) or case.cells_per_pitch < WORTH * COARSE_FILM_CELLS:
        return None
    return case.replace(**{"model.cells_per_pitch": COARSE_FILM_CELLS})


def points_near(solution: Solution) -> PointContacts | None:
    """The equilibrium with contact points near one with contacts at nodes that a single search finds, or None."""
    problem, load = solution.problem, solution.load
    whole = problem.layout.elements
    if whole is None or not constrain(problem.G, solution.active).determinate:
        return None
    try:
        found = searched(PointEquations(whole, problem, start_at(whole, solution)), load, SEARCHED, sparing=True)
        agreeing(found, solution)
    except NoPointsError as failure:
        current_run().note("contact points", outcome=str(failure))
        return None
    return found


def from_coarse_film(known: PointContacts, problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium of `problem` to which one under a coarse film leads; None where it leads nowhere near.

    It is at the position of `problem`, or under a `load` (n_position,).
    """
    before = known.equations.problem
    here = problem if load is None else problem.at(displacement=before.displacement)
    try:
        found = searched(carried(known.equations, here), load, CARRIED, own=CARRIED_OWN)
        answer = sampled_solution(clear_of_journal(tightened(found, load)), load)
    except NoPointsError as failure:
        current_run().note("fine film", outcome=str(failure))
        return None
    apart = change_of_force(known, answer)
    current_run().note("fine film", force_apart=apart)
    return answer if apart <= APART else None


def carried(equations: PointEquations, problem: CoupledProblem) -> PointEquations:
    """The equations of `problem` at a state under another grid of the film."""
    state, before, here = equations.state, equations.problem.layout, problem.layout
    points = replace(state.points, reaction=state.points.reaction * (before.scales.force / here.scales.force))
    coarse, film = before.wall.film, here.wall.film
    ln_P = monotone(coarse.phi, np.log(before.balance.nodal_pressure(state.P)), axis=1)(film.phi)
    whole = here.elements
    assert whole is not None
    w = state.w * (before.scales.length / here.scales.length)
    return PointEquations(whole, problem, PointState(w, film.at_unknowns(np.exp(ln_P)), points))


def change_of_force(known: PointContacts, answer: Solution) -> float:
    """Difference of the force from that of `known` under a coarse film, over that force [1].

    Under a load both carry it, each at its position: the difference is that of the load over the way between.
    """
    found = answer.elements
    assert isinstance(found, PointContacts)
    here, before = found.equations.problem, known.equations.problem
    force = known.equations.force * (before.layout.scales.force / here.layout.scales.force)
    apart = found.equations.force - force
    if found.gradient is not None and found.gradient.size:
        apart = found.gradient @ (here.displacement - before.displacement)
    return over_normal_forces(apart, force, answer)
