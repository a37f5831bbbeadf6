"""Contact lines at the end of a motion in its result, as arrays of numbers, and from there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.line_stage import LineStepContacts
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.physics.line_points import LinePoints
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]

PARTS_OF_POINTS = 4
"""Numbers of each point: kind, line, angle, reaction."""


class HeldState(NamedTuple):
    """Unknowns (n,) of a bearing in `problem` at the end of a motion."""

    problem: StepProblem
    x: Array


def numbers_of(lines: LineContacts) -> Array:
    """Contact lines as numbers: how many points, their kinds, lines, angles, reactions, then nodes and theirs."""
    points = lines.points
    of_points = points.kind, points.line, points.phi, lines.reaction
    held = np.flatnonzero(lines.held), lines.held_reaction
    return np.concatenate([[len(lines.reaction)], *of_points, *held], dtype=np.float64)


def lines_of(numbers: Array, end: HeldState) -> LineStepContacts | None:
    """Contact lines from these numbers; None if they are none of this bearing."""
    if not len(numbers) or not np.all(np.isfinite(numbers)):
        return None
    k, contacts = int(numbers[0]), end.problem.layout.wall.contacts
    rest = len(numbers) - 1 - PARTS_OF_POINTS * k
    if k < 0 or rest < 0 or rest % 2:
        return None
    kind, line, phi, reaction, held, held_reaction = np.split(numbers[1:], [*(k * np.arange(1, 5)), 4 * k + rest // 2])
    whole = np.concatenate([kind, line, held])
    if np.any(whole != np.floor(whole)) or np.any(whole < 0) or np.any(held >= len(contacts.rest)):
        return None
    if np.any(kind >= len(contacts.lines)) or np.any(np.diff(held) <= 0):
        return None
    places = zip(kind.astype(np.intp), line, phi, strict=True)
    for lines, at, angle in ((contacts.lines[one], at, angle) for one, at, angle in places):
        if at >= len(lines.number) or not lines.phi[0] <= angle <= lines.phi[-1]:
            return None
    at_nodes = np.zeros(len(contacts.rest), dtype=np.bool_)
    at_nodes[held.astype(np.intp)] = True
    points = LinePoints(contacts.lines, len(at_nodes), kind.astype(np.intp), line.astype(np.intp), phi)
    return LineStepContacts(end.problem, end.x, points, reaction, at_nodes, held_reaction, None)
