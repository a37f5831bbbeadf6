"""One implicit stage in time with contact points that travel (`travelling_stage.py`), in 2-D.

The stage is a balance under a load (`system/point_step.py`), so that the steps of statics serve it (C10). With friction
between petals the force at each point is part of a correction (M13).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.compiled_stages import compiled_equations
from petalfoil.dynamics.stage import Stage, told
from petalfoil.dynamics.time_state import TimeState
from petalfoil.dynamics.travelling_stage import TravellingSolution, TravellingStage
from petalfoil.equilibrium.contact_sets import revised
from petalfoil.equilibrium.element_tangent import ElementTangent, unbalanced
from petalfoil.equilibrium.point_contacts import refuse_closed, stepped
from petalfoil.equilibrium.rubbing_tangent import RubbingTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.system.point_equations import PointState, same, same_contacts
from petalfoil.system.point_friction import RubbingStepEquations, carried
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.point_step import PointStepEquations
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]

PointChange = tuple[Array, Array]
"""Changes of the unknowns and of the position."""


@dataclass(frozen=True)
class PointStage(TravellingStage[PointStepEquations, ElementTangent, PointChange]):
    """A stage with contact points.

    Attributes
    ----------
    whole : PointLayout
        The petals.
    stage : Stage
        Film, speed, rotor and what the stage starts from.
    compiled : bool
        Whether the equations are evaluated in compiled loops.
    """

    whole: PointLayout
    stage: Stage
    compiled: bool = False

    def at(self, state: PointState, e: Array) -> PointStepEquations:
        """The equations at a state."""
        problem = self.stage.problem.at(displacement=e)
        if not isinstance(problem, StepProblem):
            raise TypeError("contacts of a shaft in two bearings are at nodes")
        resists, friction = self.stage.border_stiffness, self.stage.point_friction
        if friction is None:
            kind = compiled_equations() if self.compiled else PointStepEquations
            return kind(self.whole, problem, state, resists=resists)
        force = carried(friction.force, friction.begin.points, state.points)
        return RubbingStepEquations(self.whole, problem, state, resists=resists, friction_force=force)

    def solved(
        self, start: tuple[PointState, Array], tangent: ElementTangent | None
    ) -> TravellingSolution[PointStepEquations, ElementTangent] | None:
        """The stage's state near `start`, a state and a displacement; None if there is none near it."""
        return self.reached(self.at(*start), tangent)

    def refuse_closed(self, state: PointStepEquations) -> None:
        """Raise where the film is closed."""
        refuse_closed(state)

    def revised(self, state: PointStepEquations) -> PointStepEquations | None:
        """The equations with other contacts, where the signs ask for them; None where they are right.

        Points do not split: halves that meet again would split without end.
        """
        points = revised(state, self.stage.options.accuracy, splitting=False)
        if points is None:
            return None
        return with_contacts(state, replace(state, state=replace(state.state, points=points)))

    def tangent_at(self, state: PointStepEquations) -> ElementTangent:
        """The factorised equations at a state.

        Raises
        ------
        NoPointsError
            They have no inverse.
        """
        solver = current_run().film_solver
        if isinstance(state, RubbingStepEquations):
            return RubbingTangent.about(state, self.load, solver)
        return ElementTangent.at(state, self.load, solver)

    def serving(self, tangent: ElementTangent, state: PointStepEquations, *, closely: bool) -> ElementTangent | None:
        """The tangent where it is that of the contacts of the state; None where not, or where it is to serve `closely`.

        A factorisation costs as much as six corrections here.
        """
        return tangent if not closely and serves(tangent, state) else None

    def serves(self, tangent: ElementTangent, state: PointStepEquations) -> bool:
        """Whether it still is."""
        return serves(tangent, state)

    def correction(self, state: PointStepEquations, tangent: ElementTangent) -> tuple[PointChange, PointStepEquations]:
        """Changes of unknowns and position, and the equations they belong to: with their friction forces (M13).

        Raises
        ------
        NoPointsError
            Contacts and friction do not determine them.
        """
        friction = self.stage.point_friction
        if friction is None or not isinstance(state, RubbingStepEquations):
            return tangent.correction(state.newton_residual, unbalanced(state, self.load)), state
        if not isinstance(tangent, RubbingTangent):
            raise TypeError("a tangent without friction")
        change, force = tangent.step(state, friction, self.load)
        return change, replace(state, friction_force=force)

    def size(self, change: PointChange) -> float:
        """Size of a correction [reference films, ambient pressures]."""
        (dX, move), n = change, self.whole.n_wall + self.whole.n_film
        return float(max(np.max(np.abs(dX[:n])), np.max(np.abs(move))))

    def stepped(self, state: PointStepEquations, tangent: ElementTangent, change: PointChange) -> PointStepEquations:
        """The state after a correction; points that meet are one."""
        return with_contacts(state, stepped(state, change, self.load, whole_step=True))

    def asked_for(self, tangent: ElementTangent, state: PointStepEquations) -> float:
        """Correction that what is left of the film's rows asks for, as far as the tangent has been seen to answer.

        With friction it is not told: slips are known to follow Coulomb's law by the next correction alone.
        """
        return np.inf if isinstance(state, RubbingStepEquations) else told(tangent.response, state.film_imbalance)

    def residual(self, state: PointStepEquations) -> float:
        """Largest scaled residual."""
        return float(np.max(np.abs(state.scaled)))

    def moving(self, state: PointStepEquations) -> TimeState:
        """Gas, position and velocity of a state of this stage."""
        e = state.problem.displacement
        return TimeState(state.gas, e, self.stage.rate * (e - self.stage.base.e))


def with_contacts(before: PointStepEquations, equations: PointStepEquations) -> PointStepEquations:
    """The equations after their contacts have changed from those `before`, with the friction forces of each."""
    if not isinstance(equations, RubbingStepEquations) or not isinstance(before, RubbingStepEquations):
        return equations
    if same_contacts(before.state, equations.state):
        return equations
    return replace(
        equations, friction_force=carried(before.friction_force, before.state.points, equations.state.points)
    )


def serves(tangent: ElementTangent, equations: PointStepEquations) -> bool:
    """Whether a tangent is that of the same contacts."""
    was = tangent.equations
    if not isinstance(was, PointStepEquations) or was.whole is not equations.whole:
        return False
    if isinstance(equations, RubbingStepEquations) and not isinstance(tangent, RubbingTangent):
        return False
    alike = same(was.travels, equations.travels) and same(was.idle, equations.idle)
    return alike and same_contacts(was.state, equations.state)
