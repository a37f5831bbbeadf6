"""The equilibrium of petals with continuous slopes near one with contacts at nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.asperity_contacts import with_asperities
from petalfoil.equilibrium.contact_sets import from_active_nodes
from petalfoil.equilibrium.element_response import ElementMotion
from petalfoil.equilibrium.point_contacts import NoPointsError, PointContacts, with_points
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.constraints import constrain
from petalfoil.system.loaded import load_scale
from petalfoil.system.point_equations import PointLayout, PointState
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]

TOUCHING = 2e-5
"""A node with a gap below this belongs to a run of active nodes, in units of the reference film (0.2 nm)."""

FORCE_APART = 0.1
"""Largest difference of the force from that with contacts at nodes, over that force."""

BALANCES = 5
"""Most positions tried under a load: two or three are typical."""

CARRIED = 1e-7
"""Unbalanced force over the load at which it is carried: it moves slopes by as little."""

FARTHEST = 0.5
"""Longest move from one of them to the next, in units of the reference film (5 um)."""

LEAST_FORCE = 1.0
"""Force that differences are compared with where there is hardly any, over the unit of force."""


def near_nodes(solution: Solution) -> ElementEquilibrium | None:
    """The equilibrium with contact points near one with contacts at nodes, else that with asperities, or None.

    Under a load that with points is at the position where it carries the load. There is none for a wall without
    elements, for a shaft that tilts, for a bottomed-out pack, and where neither is found or has another force: the run
    log says so.
    """
    problem = solution.problem
    layout, case = problem.layout, solution.case
    plain = not layout.fields and layout.n_position == len(case.operation.eccentricity)
    pack = wall_kind(case).elements(case, layout.wall) if plain else None
    if pack is None or not constrain(problem.G, solution.active).determinate:
        return None
    whole = PointLayout(pack, layout)
    state = start_at(whole, solution)
    try:
        points = with_points(whole, problem, state)
        agreeing(points, solution)
        return carrying(points, solution.load)
    except NoPointsError as failure:
        current_run().note("contact points", outcome=str(failure))
    found = with_asperities(whole, problem, state)
    try:
        return None if found is None else agreeing(found, solution)
    except NoPointsError as failure:
        current_run().note("asperities", outcome=str(failure))
        return None


def carrying(found: PointContacts, load: Array | None) -> PointContacts:
    """`found` at the position where it carries `load` (n_position,), over the unit of force; as it is without a load.

    Grids move the position under a load by some tenths of a micrometre, and with it the slopes. Where no such position
    is found nearby it stays where it is, and the run log says so.
    """
    near = found
    for count in range(BALANCES):
        unbalanced = np.zeros(1) if load is None else near.equations.force + load
        if load is None or np.linalg.norm(unbalanced) <= CARRIED * load_scale(load):
            return near
        gradient = ElementMotion(near).growing(0.0, current_run().film_solver).force_gradient
        problem, move = near.equations.problem, np.linalg.solve(gradient, -unbalanced)
        if np.linalg.norm(move) > FARTHEST:
            break
        try:
            near = near.at(problem.at(displacement=problem.displacement + move))
        except NoPointsError as failure:
            current_run().note("contact points", outcome=f"at position {count + 1} under the load: {failure}")
            return found
    current_run().note("contact points", outcome="the load is not carried nearby")
    return found


def start_at(whole: PointLayout, solution: Solution) -> PointState:
    """The state of an equilibrium with contacts at nodes, its runs of active nodes as points and stretches."""
    touching = solution.active | (solution.problem.gaps(solution.x) < TOUCHING)
    points = from_active_nodes(whole, solution.lam, touching)
    return PointState(whole.pack.from_nodes(solution.deflection), solution.x[solution.problem.positive], points)


def agreeing(found: ElementEquilibrium, solution: Solution) -> ElementEquilibrium:
    """`found`, if it has the force of the solution.

    Raises
    ------
    NoPointsError
        It is another equilibrium, or one of the two grids is too coarse for it.
    """
    force = solution.problem.journal_force(solution.x, solution.lam)
    apart = float(np.linalg.norm(found.equations.force - force) / max(float(np.linalg.norm(force)), LEAST_FORCE))
    if apart > FORCE_APART:
        raise NoPointsError(f"the force differs by {100.0 * apart:.2g} % from that with contacts at nodes")
    return found
