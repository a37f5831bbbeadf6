"""Instants of a motion with contact points: what they are at the nodes, and where the next one is looked for."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.time_state import AtNodes, Instant, TimeState
from petalfoil.equilibrium.contact_runs import at_nearest_points, from_active_nodes
from petalfoil.equilibrium.contact_sets import merged
from petalfoil.equilibrium.nodal_state import shared_reactions, unknowns_at_nodes
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.friction import FrictionState
from petalfoil.system.point_equations import PointEquations, PointState, same_contacts
from petalfoil.system.point_friction import PointFriction
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]

KNOTS = 5
"""Latest instants that the next one is guessed from (`foretelling`)."""


def at_points_instant(tau: float, equations: PointEquations, moving: TimeState, change: TimeState) -> Instant:
    """The instant of a state with contact points."""
    return Instant(tau, moving, change, partial(sampled_at_nodes, equations), equations=equations)


def sampled_at_nodes(equations: PointEquations) -> AtNodes:
    """A state with contact points at the nodes."""
    found = PointContacts(equations, 0.0)
    lam = shared_reactions(found)
    return AtNodes(unknowns_at_nodes(found), lam, lam > 0.0)


def nodal_friction(friction: Friction, instant: Instant) -> FrictionState:
    """Friction at the nodes from an instant on: of contact points their material keeps its place, sampled there."""
    if instant.friction is not None and instant.points is None:
        return instant.friction
    return FrictionState.fresh(friction, instant.x, instant.lam)


def point_friction(whole: PointLayout, friction: Friction, begin: Instant) -> PointFriction:
    """Friction at contact points of a step from an instant on: of nodes their material and forces, at the points there.

    A force at a node passes to the nearest point of its curve, as far as the limit of friction permits.
    """
    if begin.friction is None:
        raise ValueError("an instant without friction forces")
    state, force = state_at(whole, begin), begin.friction.force
    if begin.points is None:
        gaps = friction.reaction_share.T @ force
        free = PointFriction(whole, friction.coefficient, state, np.zeros(len(state.points.reaction)))
        limit = free.limit(state.points)
        force = np.clip(at_nearest_points(whole, state.points, gaps), -limit, limit)
    return PointFriction(whole, friction.coefficient, state, force)


def point_guesses(whole: PointLayout, path: list[Instant], tau: float) -> list[tuple[PointState, Array]]:
    """State and displacement at `tau`: foretold from the latest instants of `path`, else as they were last."""
    latest, known = path[-1], path[-KNOTS:]
    still = (state_at(whole, latest), latest.e)
    states = [instant.points for instant in known if instant.points is not None]
    if len(states) < max(len(known), 3):
        return [still]
    points, alike = states[-1].points, [same_contacts(one, states[-1]) for one in states]
    if not all(alike):
        known, states, alike = known[-3:], states[-3:], alike[-3:]
    weights = foretelling([instant.tau for instant in known], tau)
    w, P, e = (
        weighted(weights, values)
        for values in ([s.w for s in states], [s.P for s in states], [instant.e for instant in known])
    )
    if all(alike):
        place = weighted(weights, [s.points.position for s in states])
        reaction = weighted(weights, [s.points.reaction for s in states])
        last = whole.curves.elements[points.curve]
        held = (points.position <= 0.0) | (points.position >= last)
        place = np.where(held, points.position, np.maximum(np.minimum(place, last), 0.0))
        points = merged(replace(points, position=place, reaction=reaction))
    return [(PointState(w, P, points), e), still]


def weighted(weights: list[float], values: list[Array]) -> Array:
    """Sum of arrays of one shape times their weights."""
    return np.asarray(np.dot(weights, values))


def state_at(whole: PointLayout, instant: Instant) -> PointState:
    """The state of an instant; of one with contacts at nodes with its active nodes as points."""
    if instant.points is not None:
        return instant.points
    wall, unknowns = whole.layout.unknowns[DEFLECTION], whole.layout.unknowns
    points = from_active_nodes(whole, instant.lam, instant.active)
    return PointState(whole.pack.from_nodes(instant.x[wall]), instant.x[unknowns[PRESSURE]], points)


def foretelling(knots: list[float], tau: float) -> list[float]:
    """Weights of the values at the latest `knots`, three to `KNOTS`, in a guess at `tau`; (k,).

    The guess is on the parabola through the last three. Stages alternate: the one before last has the same place in its
    step, so that the parabola through the three before it missed it by about as much.
    """
    parabola = [0.0] * (len(knots) - 3) + lagrange(knots[-3:], tau)
    if len(knots) < KNOTS:
        return parabola
    missed = [*(-weight for weight in lagrange(knots[:3], knots[-2])), 1.0, 0.0]
    return [first + second for first, second in zip(parabola, missed, strict=True)]


def lagrange(knots: list[float], tau: float) -> list[float]:
    """Weights of the parabola through values at three `knots`, at `tau`, (3,)."""
    a, b, c = knots
    return [
        (tau - b) * (tau - c) / ((a - b) * (a - c)),
        (tau - a) * (tau - c) / ((b - a) * (b - c)),
        (tau - a) * (tau - b) / ((c - a) * (c - b)),
    ]
