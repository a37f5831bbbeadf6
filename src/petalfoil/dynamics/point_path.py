"""Instants of a motion with contact points: what they are at the nodes, and where the next one is looked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.time_state import Instant, TimeState
from petalfoil.equilibrium.contact_runs import from_active_nodes
from petalfoil.equilibrium.contact_sets import merged
from petalfoil.equilibrium.nodal_state import sampled_deflection, shared_reactions, with_motion_along
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.system.point_equations import PointEquations, PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]


def at_points_instant(
    tau: float, equations: PointEquations, moving: TimeState, change: TimeState, *, inner: bool = False
) -> Instant:
    """The instant of a state with contact points, which is sampled at the nodes; not within a step."""
    if inner:
        none = np.zeros(0)
        return Instant(tau, none, none, none.astype(bool), moving, change, points=equations.state)
    found, layout = PointContacts(equations, 0.0), equations.whole.layout
    x, lam = np.zeros(layout.n), shared_reactions(found)
    x[layout.unknowns[DEFLECTION]] = with_motion_along(layout.stiffness, sampled_deflection(found))
    x[equations.problem.positive] = equations.state.P
    return Instant(tau, x, lam, lam > 0.0, moving, change, points=equations.state)


def point_guesses(whole: PointLayout, path: list[Instant], tau: float) -> list[tuple[PointState, Array]]:
    """State and displacement at `tau`: through the last three instants of `path`, else as they were last."""
    latest = path[-1]
    still = (state_at(whole, latest), latest.e)
    states = [instant.points for instant in path[-3:] if instant.points is not None]
    if len(states) < 3:
        return [still]
    weights = lagrange([instant.tau for instant in path[-3:]], tau)
    w, P = (np.asarray(sum(a * getattr(s, name) for a, s in zip(weights, states, strict=True))) for name in ("w", "P"))
    e = np.asarray(sum(a * instant.e for a, instant in zip(weights, path[-3:], strict=True)))
    points = states[-1].points
    if all(same_contacts(one, states[-1]) for one in states):
        place, reaction = (
            np.asarray(sum(a * getattr(s.points, name) for a, s in zip(weights, states, strict=True)))
            for name in ("position", "reaction")
        )
        held = (points.position <= 0.0) | (points.position >= whole.curves.elements[points.curve])
        place = np.where(held, points.position, np.clip(place, 0.0, whole.curves.elements[points.curve]))
        points = merged(replace(points, position=place, reaction=reaction))
    return [(PointState(w, P, points), e), still]


def same_contacts(one: PointState, other: PointState) -> bool:
    """Whether two states have contacts on the same curves."""
    same = (getattr(one.points, name) for name in ("curve", "inner"))
    return all(
        np.array_equal(mine, getattr(other.points, name)) for mine, name in zip(same, ("curve", "inner"), strict=True)
    )


def state_at(whole: PointLayout, instant: Instant) -> PointState:
    """The state of an instant; of one with contacts at nodes with its active nodes as points."""
    if instant.points is not None:
        return instant.points
    wall, unknowns = whole.layout.unknowns[DEFLECTION], whole.layout.unknowns
    points = from_active_nodes(whole, instant.lam, instant.active)
    return PointState(whole.pack.from_nodes(instant.x[wall]), instant.x[unknowns[PRESSURE]], points)


def lagrange(knots: list[float], tau: float) -> list[float]:
    """Weights of the parabola through values at `knots`, at `tau`."""
    a, b, c = knots
    return [
        (tau - b) * (tau - c) / ((a - b) * (a - c)),
        (tau - a) * (tau - c) / ((b - a) * (b - c)),
        (tau - a) * (tau - b) / ((c - a) * (c - b)),
    ]
