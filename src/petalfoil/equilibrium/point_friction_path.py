"""Film, petals and journal with friction at contact points, moved a step further along a path (M13).

The law is that of a step in time; what a path leaves out is what film and rotor store. Every tangent comes with the
columns of unit friction forces, so that contacts stick or slip in each correction. Steps end by their residual and by
the law. Contacts follow by their signs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_sets import revised, without_loose
from petalfoil.equilibrium.element_tangent import NoPointsError, scaled_force, unbalanced
from petalfoil.equilibrium.point_contacts import refuse_closed, stepped
from petalfoil.equilibrium.point_prospects import SearchedSets
from petalfoil.equilibrium.rubbing_tangent import RubbingTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState
from petalfoil.system.point_equations import PointState, same_contacts
from petalfoil.system.point_friction import PointFriction, RubbingEquations, carried
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]

SETS = 12
"""Most sets of contacts of a step."""

TANGENTS = 8
"""Most factorisations with one set of contacts: three are typical, steps that take more are cheaper in halves."""

UNSETTLED, RELEASES = 3, 3
"""Factorisations after which contacts that pull are given up, and how often: one that wanders along its gap keeps all
others from settling. Eleven of twelve failures of a pack were of this kind."""

CHORD = 0.2
"""Residual after a correction over that before it, up to which the factor at hand serves another one."""


@dataclass(frozen=True)
class RubbingPoints:
    """A state of a path.

    Attributes
    ----------
    equations : RubbingEquations
        The equations at its state, with its friction forces.
    residual : float
        Largest scaled residual.
    friction : FrictionState
        Slip since the state before, force and its limit, of every contact.
    lost : float
        Energy lost in the step, over the units of force and length (D3) [1].
    """

    equations: RubbingEquations
    residual: float
    friction: FrictionState
    lost: float

    @property
    def state(self) -> PointState:
        """Its unknowns."""
        return self.equations.state

    @property
    def whole(self) -> PointLayout:
        """Its petals."""
        return self.equations.whole

    @property
    def force(self) -> Array:
        """Friction forces, (j,) [1]."""
        return self.equations.friction_force

    def law(self, coefficient: float) -> PointFriction:
        """The law of a step that begins here."""
        return PointFriction(self.whole, coefficient, self.state, self.force)


def slide_at_points(
    ahead: RubbingEquations, law: PointFriction | None, solver: LinearSolver, load: Array | None = None
) -> RubbingPoints | None:
    """The equilibrium near the state of `ahead` after a step from where `law` begins; None if there is none near it.

    Under a `load` (d,) the journal's position is found with it. Without a law friction forces stay as they are. Points
    that have met again after they were split stay one: gaps beside them gain contacts of their own.
    """
    try:
        refuse_closed(ahead)
        splits, before, seen = True, -1, SearchedSets()
        for _ in range(SETS):
            ahead = settled(ahead, law, solver, load)
            splits, before = splits and len(ahead.state.points.reaction) != before, len(ahead.state.points.reaction)
            points = revised(ahead, splitting=splits)
            seen.check(ahead, points)
            if points is None:
                return reached(ahead, law)
            ahead = carrying(ahead, replace(ahead, state=replace(ahead.state, points=points)))
    except NoPointsError as failure:
        current_run().note("friction", outcome=str(failure))
    return None


def reached(equations: RubbingEquations, law: PointFriction | None) -> RubbingPoints:
    """A state that is solved, after a step from where `law` begins."""
    residual, force = float(np.max(np.abs(equations.scaled))), equations.friction_force
    if law is None:
        return RubbingPoints(equations, residual, FrictionState(0.0 * force, force, np.abs(force)), 0.0)
    after = law.state(equations.state, force)
    return RubbingPoints(equations, residual, after, law.lost(after, equations.state.points))


def settled(
    equations: RubbingEquations, law: PointFriction | None, solver: LinearSolver, load: Array | None
) -> RubbingEquations:
    """The state with the contacts as they are, apart from points that meet and from those that pull and do not settle.

    Raises
    ------
    NoPointsError
        It is not found.
    """
    count = releases = 0
    while count < TANGENTS:
        kept = without_loose(equations) if count == UNSETTLED and releases < RELEASES else None
        if kept is not None:
            equations = carrying(equations, replace(equations, state=replace(equations.state, points=kept)))
            count, releases = 0, releases + 1
        count += 1
        tangent, gain, size = RubbingTangent.about(equations, load, solver), 0.0, np.inf
        while gain <= CHORD and tangent.n == equations.n:
            change, force = corrected(tangent, equations, law, load)
            rubbing = replace(equations, friction_force=force)
            equations = carrying(rubbing, stepped(rubbing, change, load, whole_step=True))
            before, size = size, left_over(equations, law, load)
            if size <= RESIDUAL_TOLERANCE:
                return equations
            gain = size / before
    raise NoPointsError(f"petals with friction do not settle: {size:.1e} is left")


def corrected(
    tangent: RubbingTangent, equations: RubbingEquations, law: PointFriction | None, load: Array | None
) -> tuple[tuple[Array, Array], Array]:
    """Changes of unknowns and position at a state, and the friction forces (j,) that go with them."""
    if law is not None:
        return tangent.step(equations, law, load)
    return tangent.correction(equations.newton_residual, unbalanced(equations, load)), equations.friction_force


def left_over(equations: RubbingEquations, law: PointFriction | None, load: Array | None) -> float:
    """Largest of the scaled residuals, the unbalanced force, and what breaks the law of friction.

    Raises
    ------
    NoPointsError
        The film has closed.
    """
    refuse_closed(equations)
    size = float(np.max(np.abs(np.concatenate([equations.scaled, scaled_force(equations, load)]))))
    if not np.isfinite(size):
        raise NoPointsError("petals with friction do not settle: they go to infinity")
    if law is None or size > RESIDUAL_TOLERANCE:
        return size
    return max(size, law.broken(law.state(equations.state, equations.friction_force)))


def carrying(before: RubbingEquations, equations: RubbingEquations) -> RubbingEquations:
    """The equations after their contacts have changed from those `before`, with the friction forces of each."""
    if same_contacts(before.state, equations.state):
        return equations
    force = carried(before.friction_force, before.state.points, equations.state.points)
    return replace(equations, friction_force=force)
