"""Equilibria with contact points that travel: from an equilibrium with contacts at nodes, by Newton's method.

Runs of active nodes become points or stretches (`contact_sets.py`). Newton's method on deflections, pressures,
reactions and places (C6) to (C8) follows, with steps halved until the residual falls. Then signs are looked at: a
reaction that pulls leaves, a gap that has closed elsewhere gains a contact, and Newton's method goes on.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import merged, revised
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import AT_POINTS
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.problem import POSITIVE_FRACTION, RESIDUAL_TOLERANCE, fraction_to_boundary
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointLayout, PointState
from petalfoil.walls.element_pack import ElementPack

Array = NDArray[np.float64]

STEPS = 48
"""Most Newton steps, all sets of contacts together. Of 40 random packs 18 take up to 5, eight more 22 to 40."""

TRUST = 0.35
"""Farthest that a point travels in a step, in elements."""

MOST_GROWTH = 4.0
"""Largest growth of a film pressure in a step, over the pressure."""

FARTHEST_STATE = 1e4
"""Film pressure over ambient pressure, and deflection over the reference film (0.1 m), past which Newton's method
diverges."""

SHORTEST = 0.1
"""Shortest step over Newton's; it is taken even if the residual does not fall."""


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

    @property
    def pack(self) -> ElementPack:
        """Its petals."""
        return self.equations.whole.pack

    @property
    def points(self) -> ContactPoints:
        """Its contacts."""
        return self.equations.state.points

    @property
    def contact_slopes(self) -> str:
        """Where its contacts are, for people."""
        return AT_POINTS

    def at(self, problem: CoupledProblem) -> PointContacts:
        """The equilibrium of a neighbouring problem.

        Raises
        ------
        NoPointsError
            None was found.
        """
        return with_points(self.equations.whole, problem, self.equations.state)


class NoPointsError(ArithmeticError):
    """Newton's method found no equilibrium with contact points; it says why."""


def with_points(whole: PointLayout, problem: CoupledProblem, state: PointState) -> PointContacts:
    """The equilibrium of `problem` near a state.

    Raises
    ------
    NoPointsError
        None was found.
    """
    left, changes = STEPS, 0
    while True:
        equations, steps = newton(PointEquations(whole, problem, state), left)
        points, left = revised(equations), left - steps
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
        state, changes = replace(equations.state, points=points), changes + 1


def newton(equations: PointEquations, most: int) -> tuple[PointEquations, int]:
    """Newton's method with the contacts as they are, apart from points that meet, and its steps, `most` at most.

    Raises
    ------
    NoPointsError
        It does not converge.
    """
    last = np.inf
    for step in range(most):
        residual = float(np.max(np.abs(equations.scaled)))
        if residual <= RESIDUAL_TOLERANCE and residual > 0.1 * last:
            return equations, step
        last = residual
        if diverged(equations.state):
            raise NoPointsError("Newton's method diverges")
        try:
            factor = current_run().film_solver.factor(equations.steady)
        except SingularMatrixError:
            raise NoPointsError("the contacts do not determine the petals") from None
        equations = stepped(equations, factor.solve(-np.concatenate(equations.residual)))
    raise NoPointsError(f"contacts or the residual, {last:.1e}, still change after {STEPS} steps")


def diverged(state: PointState) -> bool:
    """Whether a state is that of no bearing."""
    far = max(float(np.max(np.abs(state.w), initial=0.0)), float(np.max(state.P, initial=0.0)))
    return not far <= FARTHEST_STATE


def stepped(equations: PointEquations, change: Array) -> PointEquations:
    """The equations after the longest part of `change` that lessens the residual."""
    before, state = equations.scaled, equations.state
    sizes = len(state.w), len(state.P), len(state.points.reaction)
    dw, dP, dlam, dt = np.split(change, np.cumsum(sizes))
    closing = equations.whole.film_by_w @ dw
    length = min(
        1.0,
        POSITIVE_FRACTION * fraction_to_boundary(state.P, dP),
        fraction_to_boundary(MOST_GROWTH * state.P, -dP),
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
