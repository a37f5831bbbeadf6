"""Equilibria with contact points that travel: from an equilibrium with contacts at nodes, by Newton's method.

Runs of active nodes become points or stretches (`contact_sets.py`). Newton's method on deflections, pressures,
reactions and places (C6) to (C8) follows, with steps halved until the residual falls. Then signs are looked at: a
reaction that pulls leaves, a gap that has closed elsewhere gains a contact, and Newton's method goes on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import from_active_nodes, merged, revised
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.problem import POSITIVE_FRACTION, RESIDUAL_TOLERANCE, fraction_to_boundary
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointLayout, PointState
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]

STEPS = 40
"""Most Newton steps with one set of contacts: 4 or 5 are typical."""

CHANGES = 25
"""Most changes of the set of contacts."""

TRUST = 0.35
"""Farthest that a point travels in a step, in elements."""

SHORTEST = 0.1
"""Shortest step over Newton's; it is taken even if the residual does not fall."""


TOUCHING = 2e-5
"""A node with a gap below this belongs to a run of active nodes, in units of the reference film (0.2 nm)."""

FORCE_APART = 0.1
"""Largest difference of the force from that with contacts at nodes, over that force."""

LEAST_FORCE = 1.0
"""Force that differences are compared with where there is hardly any, over the unit of force."""


@dataclass(frozen=True)
class PointContacts:
    """An equilibrium with contact points.

    Attributes
    ----------
    equations : PointEquations
        The equations at its state.
    residual : float
        Largest scaled residual.
    """

    equations: PointEquations
    residual: float


class NoPointsError(ArithmeticError):
    """Newton's method found no equilibrium with contact points; it says why."""


def near_nodes(solution: Solution) -> PointContacts | None:
    """The equilibrium with contact points near one with contacts at nodes; None where there is none.

    There is none for a wall without elements, for a shaft that tilts, for a bottomed-out pack, and where Newton's
    method does not find it: the run log says so.
    """
    problem = solution.problem
    layout, case = problem.layout, solution.case
    plain = not layout.fields and layout.n_position == len(case.operation.eccentricity)
    pack = wall_kind(case).elements(case, layout.wall) if plain else None
    if pack is None or not constrain(problem.G, solution.active).determinate:
        return None
    whole, gaps = PointLayout(pack, layout), problem.gaps(solution.x)
    points = from_active_nodes(whole, solution.lam, solution.active | (gaps < TOUCHING))
    state = PointState(pack.from_nodes(solution.deflection), solution.x[problem.positive], points)
    try:
        return agreeing(with_points(whole, problem, state), solution)
    except NoPointsError as failure:
        current_run().note("contact points", outcome=str(failure))
        return None


def agreeing(found: PointContacts, solution: Solution) -> PointContacts:
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


def with_points(whole: PointLayout, problem: CoupledProblem, state: PointState) -> PointContacts:
    """The equilibrium of `problem` near a state.

    Raises
    ------
    NoPointsError
        None was found.
    """
    for changes in range(CHANGES):
        equations = newton(PointEquations(whole, problem, state))
        points = revised(equations)
        if points is None:
            residual = float(np.max(np.abs(equations.scaled)))
            found = equations.state.points
            current_run().note(
                "contact points",
                residual=residual,
                changes=changes,
                points=len(found.curve),
                in_stretches=int(found.inner.sum()),
            )
            return PointContacts(equations, residual)
        state = replace(equations.state, points=points)
    raise NoPointsError(f"contacts still change after {CHANGES} changes")


def newton(equations: PointEquations) -> PointEquations:
    """Newton's method with the contacts as they are, apart from points that meet.

    Raises
    ------
    NoPointsError
        It does not converge.
    """
    last = np.inf
    for _ in range(STEPS):
        residual = float(np.max(np.abs(equations.scaled)))
        if residual <= RESIDUAL_TOLERANCE and residual > 0.1 * last:
            return equations
        last = residual
        try:
            factor = current_run().film_solver.factor(equations.steady)
        except SingularMatrixError:
            raise NoPointsError("the contacts do not determine the petals") from None
        equations = stepped(equations, factor.solve(-np.concatenate(equations.residual)))
    if last <= RESIDUAL_TOLERANCE:
        return equations
    raise NoPointsError(f"the residual is {last:.1e} after {STEPS} steps")


def stepped(equations: PointEquations, change: Array) -> PointEquations:
    """The equations after the longest part of `change` that lessens the residual."""
    before, state = equations.scaled, equations.state
    sizes = len(state.w), len(state.P), len(state.points.reaction)
    dw, dP, dlam, dt = np.split(change, np.cumsum(sizes))
    closing = equations.whole.film_by_w @ dw
    length = min(
        1.0,
        POSITIVE_FRACTION * fraction_to_boundary(state.P, dP),
        POSITIVE_FRACTION * fraction_to_boundary(equations.film_thickness.ravel(), closing),
    )
    while True:
        points = replace(
            state.points,
            position=moved(equations, np.clip(length * dt, -TRUST, TRUST)),
            reaction=state.points.reaction + length * dlam,
        )
        ahead = replace(equations, state=PointState(state.w + length * dw, state.P + length * dP, merged(points)))
        other_contacts = len(ahead.scaled) != len(before)
        if other_contacts or length <= SHORTEST or np.linalg.norm(ahead.scaled) < np.linalg.norm(before):
            return ahead
        length = max(0.5 * length, SHORTEST)


def moved(equations: PointEquations, change: Array) -> Array:
    """Places of the travelling points after `change`, on their curves."""
    points = equations.state.points
    return np.clip(points.position + change, 0.0, equations.whole.curves.elements[points.curve])
