"""One implicit stage in time with contact points that travel: film, petals, contacts and rotor in one Newton.

The stage is a balance under a load (`system/point_step.py`), so that the steps of statics serve it: Newton's method on
deflections, pressures, reactions, places and position (C10), then contacts by their signs. One factorisation serves as
many corrections, stages and steps as it contracts, as long as the contacts are the same; a stage ends by the size of
its correction.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.compiled_stages import compiled_equations
from petalfoil.dynamics.stage import Stage, left_after, told
from petalfoil.dynamics.time_state import TimeState
from petalfoil.equilibrium.contact_sets import revised
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError, unbalanced
from petalfoil.equilibrium.point_contacts import refuse_closed, stepped
from petalfoil.equilibrium.rubbing_tangent import RubbingTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.system.point_equations import PointState, same, same_contacts
from petalfoil.system.point_friction import RubbingStepEquations, carried
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.point_step import PointStepEquations
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]

SETS = 12
"""Most sets of contacts of a stage: most stages have one, a step in which petals come to touch two or three."""

TANGENTS = 5
"""Most factorisations with one set of contacts."""

CORRECTIONS = 10
"""Most corrections with one tangent."""

MORE = 2
"""Corrections that contract slowly and are still taken where they lead to the accuracy of a stage: a factorisation
costs as much as six of them."""

TOUCHING = 1e-4
"""Largest gap, and slope by the place in an element, at the points of a stage's state, in reference films."""

BALANCED = 1e-3
"""Largest residual of the petals' rows, over ambient pressure on a node: where points travel far, corrections of films
and pressures alone do not tell whether they are there. Contacts at nodes leave up to 5e-4."""

GROWING = 2.0
"""Growth of the correction past which a tangent no longer serves."""


@dataclass(frozen=True)
class PointStageSolution:
    """What a stage reaches, and the tangent that found it."""

    equations: PointStepEquations
    moving: TimeState
    tangent: ElementTangent

    @property
    def residual(self) -> float:
        """Largest scaled residual."""
        return float(np.max(np.abs(self.equations.scaled)))


@dataclass(frozen=True)
class PointStage:
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

    @property
    def load(self) -> Array:
        """`L`: all of (O3) that does not depend on the position, (d,) [1]."""
        stage = self.stage
        base = stage.base
        return np.asarray(stage.outside + stage.border_stiffness @ base.e + stage.rate * (stage.inertia @ base.v))

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

    def solved(self, start: tuple[PointState, Array], tangent: ElementTangent | None) -> PointStageSolution | None:
        """The stage's state near `start`, a state and a displacement; None if there is none near it."""
        equations, load, accuracy = self.at(*start), self.load, self.stage.options.accuracy
        try:
            refuse_closed(equations)
            for _ in range(SETS):
                equations, tangent = self.settled(equations, load, tangent)
                points = revised(equations, accuracy)
                if points is None:
                    return PointStageSolution(equations, self.moving(equations), tangent)
                equations = with_contacts(equations, replace(equations, state=replace(equations.state, points=points)))
        except NoPointsError as e:
            current_run().note("stage", outcome=str(e))
        return None

    def settled(
        self, equations: PointStepEquations, load: Array, tangent: ElementTangent | None
    ) -> tuple[PointStepEquations, ElementTangent]:
        """The state with the contacts as they are, apart from points that meet.

        Raises
        ------
        NoPointsError
            It is not found.
        """
        options, made = self.stage.options, 0
        while made < TANGENTS:
            if tangent is None or not serves(tangent, equations):
                tangent, made = self.tangent_at(equations, load), made + 1
            last = np.inf
            for number in range(CORRECTIONS):
                before = equations.film_imbalance if number else 0.0
                change, rubbing = self.correction(equations, tangent, load)
                size = self.size(change)
                if not np.isfinite(size) or size > GROWING * last:
                    break
                if number:
                    tangent = tangent.seen(size, before)
                equations = with_contacts(rubbing, stepped(rubbing, change, load, whole_step=True))
                if not serves(tangent, equations):
                    break
                contraction = size / last if number else options.slow
                left = left_after(size, contraction)
                if min(left, asked_for(tangent, equations)) <= options.accuracy and balanced(equations):
                    return equations, tangent
                if number and contraction > options.slow and left * contraction**MORE > options.accuracy:
                    break
                last = size
            tangent = None
        raise NoPointsError("the corrections of a stage do not contract")

    def tangent_at(self, equations: PointStepEquations, load: Array) -> ElementTangent:
        """The factorised equations at a state.

        Raises
        ------
        NoPointsError
            They have no inverse.
        """
        solver = current_run().film_solver
        if isinstance(equations, RubbingStepEquations):
            return RubbingTangent.about(equations, load, solver)
        return ElementTangent.at(equations, load, solver)

    def correction(
        self, equations: PointStepEquations, tangent: ElementTangent, load: Array
    ) -> tuple[tuple[Array, Array], PointStepEquations]:
        """Changes of unknowns and position, and the equations they belong to: with their friction forces (M13).

        Raises
        ------
        NoPointsError
            Contacts and friction do not determine them.
        """
        friction = self.stage.point_friction
        if friction is None or not isinstance(equations, RubbingStepEquations):
            return tangent.correction(equations.newton_residual, unbalanced(equations, load)), equations
        if not isinstance(tangent, RubbingTangent):
            raise TypeError("a tangent without friction")
        change, force = tangent.step(equations, friction, load)
        return change, replace(equations, friction_force=force)

    def size(self, change: tuple[Array, Array]) -> float:
        """Size of a correction [reference films, ambient pressures]."""
        (dX, move), n = change, self.whole.n_wall + self.whole.n_film
        return float(max(np.max(np.abs(dX[:n])), np.max(np.abs(move))))

    def moving(self, equations: PointStepEquations) -> TimeState:
        """Gas, position and velocity of a state of this stage."""
        e = equations.problem.displacement
        return TimeState(equations.gas, e, self.stage.rate * (e - self.stage.base.e))


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


def asked_for(tangent: ElementTangent, equations: PointStepEquations) -> float:
    """Correction that what is left of the film's rows asks for, as far as the tangent has been seen to answer.

    With friction it is not told: slips are known to follow Coulomb's law by the next correction alone.
    """
    if isinstance(equations, RubbingStepEquations):
        return np.inf
    return told(tangent.response, equations.film_imbalance)


def balanced(equations: PointStepEquations) -> bool:
    """Whether gaps and slopes vanish at the contact points, and the petals are in equilibrium."""
    return equations.opening <= TOUCHING and equations.wall_imbalance <= BALANCED
