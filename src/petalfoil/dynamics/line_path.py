"""Instants of a motion with contact lines: what is kept of them, and where the next one is looked for."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.point_path import KNOTS, foretelling, weighted
from petalfoil.dynamics.time_state import AtNodes, Instant, TimeState
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_sets import start_at
from petalfoil.equilibrium.line_signs import freed_near_ends
from petalfoil.equilibrium.line_stretches import Stretches
from petalfoil.solvers.constraints import constrain
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class InstantAtNodes:
    """An instant with contacts at nodes, as contact lines are placed from one.

    Attributes
    ----------
    problem : StepProblem
        Speed and position.
    x : (n,) array
        Unknowns.
    lam : (m,) array
        Reactions.
    active : (m,) bool array
        Contacts that carry load.
    load : None
        Lines are placed at a given position.
    """

    problem: StepProblem
    x: Array
    lam: Array
    active: Mask
    load: Array | None = None


def on_lines_instant(tau: float, state: LineContacts, moving: TimeState, change: TimeState) -> Instant:
    """The instant of a state with contact lines; it keeps no matrices and no tangent."""
    bare = LineContacts(
        state.problem, state.x, state.points, state.reaction, state.held, state.held_reaction, load=None
    )
    nodal, left = AtNodes(state.x, state.lam, state.active), Stretches.of(state, len(state.held))
    return Instant(tau, moving, change, nodal, lines=bare, stretches=left)


def line_guesses(problem: StepProblem, path: list[Instant], tau: float) -> list[LineContacts]:
    """States at `tau`: foretold from the latest instants of `path`, else as it was last; none without lines."""
    still = lines_at(problem, path[-1])
    if still is None:
        return []
    known = path[-KNOTS:]
    states = [instant.lines for instant in known if instant.lines is not None]
    if len(states) < max(len(known), 3):
        return [still]
    if not all(alike(one, still) for one in states):
        known, states = known[-3:], states[-3:]
    weights = foretelling([instant.tau for instant in known], tau)
    x, e = weighted(weights, [one.x for one in states]), weighted(weights, [instant.e for instant in known])
    ahead = replace(still, problem=still.problem.at(displacement=e), x=x)
    if all(alike(one, still) for one in states):
        phi = weighted(weights, [one.points.phi for one in states])
        ahead = replace(
            ahead,
            points=still.points.moved(phi - still.points.phi),
            reaction=weighted(weights, [one.reaction for one in states]),
            held_reaction=weighted(weights, [one.held_reaction for one in states]),
        )
    return [ahead, still]


def lines_at(problem: StepProblem, instant: Instant) -> LineContacts | None:
    """The state of an instant; of one with contacts at nodes with its isolated ones as points (K8).

    One factorisation then; None where its contacts do not determine the petals.
    """
    if instant.lines is not None:
        return instant.lines
    if not np.any(instant.active) or not constrain(problem.G, instant.active).determinate:
        return None
    there = problem.at(displacement=instant.e)
    return freed_near_ends(start_at(InstantAtNodes(there, instant.x, instant.lam, instant.active)))


def alike(one: LineContacts, other: LineContacts) -> bool:
    """Whether two states have the same contacts, points at other places."""
    points, others = one.points, other.points
    return (
        np.array_equal(points.kind, others.kind)
        and np.array_equal(points.line, others.line)
        and np.array_equal(one.held, other.held)
    )
