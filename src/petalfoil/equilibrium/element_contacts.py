"""The equilibrium of petals with continuous slopes near one with contacts at nodes: what results are taken from."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.amended_factor import serving_factor
from petalfoil.equilibrium.asperity_contacts import AsperityContacts, with_asperities
from petalfoil.equilibrium.asperity_path import from_free_petals
from petalfoil.equilibrium.contact_runs import from_active_nodes
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.followed_points import followed
from petalfoil.equilibrium.point_contacts import PointContacts, with_points
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.settled_points import settled_points
from petalfoil.equilibrium.small_motion import AT_ASPERITIES, AT_POINTS, ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.interior_point import InteriorOptions
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.units import format_percent

Array = NDArray[np.float64]
Found = TypeVar("Found", bound=ElementEquilibrium)

TOUCHING = 2e-5
"""A node with a gap below this belongs to a run of active nodes, in units of the reference film (0.2 nm)."""

FORCE_APART = 0.5
"""Largest difference of the force from that with contacts at nodes, over that force. In stiff packs contacts at nodes
themselves miss their limit on fine grids by that much: random pack 34 has 2.9, 5.2, 5.7, 5.9 kN on 64 to 512 cells."""

ALIKE = 0.02
"""Largest difference of the forces with contact points and with asperities of one equilibrium, over the force."""

DEEPEST = 5e-3
"""Farthest that the film may be thinner than where surfaces touch, in units of the reference film: ten mean heights of
the asperities (50 nm). Random packs have at most 25 nm; petals bent to 14 GPa were 0.9 um through the journal."""

LEAST_FORCE = 1.0
"""Force that differences are compared with where there is hardly any, over the unit of force."""

LEAST_PART = 0.02
"""The same over the sum of all normal forces: those on the journal nearly cancel in a light bearing."""


def with_elements(solution: Solution, known: Solution | None = None) -> Solution:
    """The solution with the equilibrium of petals with continuous slopes near it, as far as there is one.

    `known` is a neighbour, whose own may lead to it.
    """
    if solution.elements_sought:
        return solution
    found = near_nodes(solution, known)
    apart = None if found is None else force_apart(found, solution)
    return replace(solution, elements=found, elements_sought=True, nodal_force_difference=apart)


def near_nodes(solution: Solution, known: Solution | None = None) -> ElementEquilibrium | None:
    """The equilibrium with contact points near one with contacts at nodes, else that with asperities, or None.

    Under a load it is at the position where it carries the load. There is none for a wall without elements, for a shaft
    that tilts, for a bottomed-out pack, and where neither is found or is another one: the run log says so.
    """
    if solution.elements_sought:
        return solution.elements
    whole = solution.problem.layout.elements
    if whole is None or not constrain(solution.problem.G, solution.active).determinate:
        return None
    refused: list[ElementEquilibrium] = []
    for phase, way in ways(whole, solution, None if known is None else known.elements):
        try:
            found = tightened(way(), load=solution.load)
            refused.append(found)
            return with_points_of(agreeing(found, solution, known), refused)
        except NoPointsError as failure:
            current_run().note(phase, outcome=str(failure))
    return None


def ways(
    whole: PointLayout, solution: Solution, known: ElementEquilibrium | None
) -> Iterator[tuple[str, Callable[[], ElementEquilibrium]]]:
    """How it is looked for, one after the other, and what that is in the run log.

    Where a neighbour has contact points or asperities, these lead on; else both are looked for from the nodes.
    """
    problem, load = solution.problem, solution.load
    from_nothing = known is None and load is None and solution.shortest_step is not None
    neighbour = None if known is None or known.equations.problem.layout is not problem.layout else known
    if neighbour is not None and neighbour.contact_model == AT_ASPERITIES:
        yield "asperities", partial(neighbour.at, placed(problem, neighbour, load), load)
    state = start_at(whole, solution)
    yield "contact points", partial(with_points, whole, problem, state, load)
    if neighbour is not None and neighbour.contact_model == AT_POINTS:
        yield "contact points", partial(neighbour.at, placed(problem, neighbour, load), load)
    if from_nothing:
        yield "asperities", partial(from_free_petals, whole, problem)
    else:
        yield "asperities", partial(with_asperities, whole, problem, state, load)


def placed(problem: CoupledProblem, neighbour: ElementEquilibrium, load: Array | None) -> CoupledProblem:
    """The problem at its position; under a load at that of the neighbour, where its state belongs."""
    return problem if load is None else problem.at(displacement=neighbour.equations.problem.displacement)


def start_at(whole: PointLayout, solution: Solution) -> PointState:
    """The state of an equilibrium with contacts at nodes, its runs of active nodes as points and stretches."""
    touching = solution.active | (solution.problem.gaps(solution.x) < TOUCHING)
    points = from_active_nodes(whole, solution.lam, touching)
    return PointState(whole.pack.from_nodes(solution.deflection), solution.x[solution.problem.positive], points)


def tightened(found: ElementEquilibrium, load: Array | None) -> ElementEquilibrium:
    """The same equilibrium with contacts that meet (K12b), so that it does not depend on the way that led there.

    Where they do not settle so, wherever gaps are below zero by more than points that are followed allow; where they do
    not settle so closely either, it stays as it is.
    """
    if not isinstance(found, PointContacts):
        return found
    settled = settled_points(found, load)
    if settled is not None and settled is not found:
        return settled
    try:
        served = serving_factor(found.tangent, current_run().film_solver)
        close = followed(found, found.equations.problem, load, served)
    except NoPointsError as failure:
        current_run().note("contact points", outcome=f"kept with contacts 2 nm deep: {failure}")
        return found
    return close if settled is None else settled_points(close, load) or close


def agreeing(found: ElementEquilibrium, solution: Solution, known: Solution | None = None) -> ElementEquilibrium:
    """`found`, if it is the same equilibrium as the solution and no petal lies in the journal.

    Its force does not differ by more than `FORCE_APART`, or by twice as much as that of the neighbour `known` that led
    to it, unless both are reached from the assembled pack alike. Its film is not thinner by more than `DEEPEST` than a
    contact.

    Raises
    ------
    NoPointsError
        It is another equilibrium, or one of the two grids is too coarse for it.
    """
    apart = force_apart(found, solution)
    current_run().note(found.contact_model.split(" on ")[0], force_apart=apart)
    before = 0.0 if known is None else known.nodal_force_difference or 0.0
    if not apart <= max(FORCE_APART, 2.0 * before) and not reached_alike(found, solution):
        raise NoPointsError(f"the force differs by {format_percent(apart)} from that with contacts at nodes")
    return clear_of_journal(found)


def reached_alike(found: ElementEquilibrium, solution: Solution) -> bool:
    """Whether both are ends of central paths from the assembled pack, without a step that points to a fold."""
    own = found.shortest_step if isinstance(found, AsperityContacts) else None
    return min(own or 0.0, solution.shortest_step or 0.0) >= InteriorOptions.short


def with_points_of(found: ElementEquilibrium, refused: list[ElementEquilibrium]) -> ElementEquilibrium:
    """Contact points whose force is within `ALIKE` of that with asperities, where these confirm them; else `found`."""
    force = found.equations.force
    for one in refused:
        close = np.linalg.norm(one.equations.force - force) <= ALIKE * np.linalg.norm(force)
        if isinstance(one, PointContacts) and found.contact_model == AT_ASPERITIES and close:
            return clear_of_journal(one)
    return found


def clear_of_journal(found: Found) -> Found:
    """`found`, if no petal lies in the journal by more than `DEEPEST`.

    Raises
    ------
    NoPointsError
        One does.
    """
    floor = found.pack.floor / found.equations.problem.layout.scales.length
    deep = float(np.max(floor - found.equations.film_thickness.ravel()))
    if deep > DEEPEST:
        raise NoPointsError(f"a petal lies in the journal by {deep:.2g} of the reference film")
    return found


def force_apart(found: ElementEquilibrium, solution: Solution) -> float:
    """Difference of the force from that with contacts at nodes, over that force [1].

    Under a load both carry the load, each at its position: the difference is that of the load over the way between.
    """
    equations, problem = found.equations, solution.problem
    force = problem.journal_force(solution.x, solution.lam)
    apart = equations.force - force
    if found.gradient is not None and found.gradient.size:
        apart = found.gradient @ (equations.problem.displacement - problem.displacement)
    return over_normal_forces(apart, force, solution)


def over_normal_forces(apart: Array, force: Array, solution: Solution) -> float:
    """A difference (n_position,) of forces over the `force`, or over a part of all normal forces if that is more."""
    problem = solution.problem
    pushes = np.sum(np.abs(problem.border.row_derivative) @ np.abs(solution.x[problem.positive] - 1.0))
    reactions = float(np.sum(solution.lam[problem.layout.wall.contacts.journal]))
    least = max(LEAST_FORCE, LEAST_PART * (float(pushes) + reactions))
    return float(np.linalg.norm(apart)) / max(float(np.linalg.norm(force)), least)
