"""Contact lines followed from one equilibrium to the next by Newton's method, foretold by the last tangent (C14)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.continuation import FAR_FOLLOWED, on_the_way
from petalfoil.equilibrium.followed_points import NEAR
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError, changed
from petalfoil.equilibrium.line_sets import settled
from petalfoil.equilibrium.line_signs import bearing_alone, freed
from petalfoil.equilibrium.line_tangent import LineResiduals, LineTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

TANGENTS = 5
"""Most tangents with one set of contacts: one or two serve from point to point of a curve."""

PARTS = (1, 2, 4)
"""Parts of the way, in the order of trial."""

FARTHEST_TRAVEL = 3.0
"""Farthest that a point travels in the step that is foretold, in cells."""


def followed_lines(near: LineContacts, problem: CoupledProblem, load: Array | None) -> LineContacts:
    """The equilibrium of a neighbouring problem from that `near`, in equal parts of the way where one step fails.

    Under a `load` (n_position,) with its position.

    Raises
    ------
    NoLinesError
        None was found, or one much farther away than the tangent foretold.
    """
    for parts in PARTS[:-1]:
        try:
            return in_parts(near, problem, load, parts)
        except NoLinesError as failure:
            current_run().note("followed", parts=parts, outcome=str(failure))
    return in_parts(near, problem, load, PARTS[-1])


def in_parts(near: LineContacts, problem: CoupledProblem, load: Array | None, parts: int) -> LineContacts:
    """The same in a number of equal parts.

    Raises
    ------
    NoLinesError
        One of them failed.
    """
    current = near
    for share in np.arange(1, parts) / parts:
        carried = None if load is None or near.load is None else near.load + share * (load - near.load)
        current = stepped(current, on_the_way(near.problem, problem, share), carried)
    return stepped(current, problem, load)


def stepped(near: LineContacts, problem: CoupledProblem, load: Array | None) -> LineContacts:
    """The same in one step.

    Raises
    ------
    NoLinesError
        None was found, or one much farther away than the tangent foretold.
    """
    start = foretold(near, problem, load)
    found = settled(freed(bearing_alone(start)), TANGENTS)
    if distance(near, found) > FAR_FOLLOWED * max(distance(near, start), NEAR):
        raise NoLinesError("it is much farther away than the tangent foretold")
    return found


def foretold(near: LineContacts, problem: CoupledProblem, load: Array | None) -> LineContacts:
    """The state at another speed, position or load by the tangent of that `near` (C14); no factorisation as a rule.

    Raises
    ------
    NoLinesError
        The film closes on the way, or the contacts do not determine the petals.
    """
    tangent = near.tangent and near.tangent.on(near)
    try:
        tangent = tangent or LineTangent.of(near, near.motion.growing(0.0, current_run().film_solver))
    except SingularMatrixError:
        raise NoLinesError("the contacts do not determine the petals") from None
    start = near.under(problem.at(displacement=near.problem.displacement), load)
    way = None if load is not None else problem.displacement - start.problem.displacement
    change = tangent.correction(start, LineResiduals.of(start), way)
    ahead = changed(start, tangent, change, FARTHEST_TRAVEL)
    return ahead if load is not None else replace(ahead, problem=problem)


def distance(one: LineContacts, other: LineContacts) -> float:
    """Largest difference of an unknown: a deflection over the reference film, a pressure over the ambient one [1]."""
    return float(np.max(np.abs(other.x - one.x), initial=0.0))
