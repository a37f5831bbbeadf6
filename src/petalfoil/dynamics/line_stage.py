"""One implicit stage in time with contact lines that cross axial stations between nodes, in 3-D.

    wall, film   F(x) + rate (m - m_start) - G^T lam - n^T lam_c = 0                                   (C11), (O2)
    points       p = 0 ,  p' = 0   at each                                                             (C12)
    rotor        F_journal + L - S e = 0 ,  S = M rate^2 + N rate                                      (O3)

The stage is a balance under the load `L` of a journal that springs `S` hold, so that the steps of statics serve it
(`line_contacts.py`), and factors serve other contacts as they do there (`line_exchange.py`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.stage import Stage, told
from petalfoil.dynamics.time_state import TimeState
from petalfoil.dynamics.travelling_stage import TravellingSolution, TravellingStage
from petalfoil.equilibrium.line_contacts import TRUST, LineContacts, NoLinesError, changed
from petalfoil.equilibrium.line_signs import EARLY_PULL, bearing_alone, met, parted
from petalfoil.equilibrium.line_stretches import Stretches, revised_in_time
from petalfoil.equilibrium.line_tangent import STIFFER, LineChange, LineResiduals, LineTangent
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.time_step import StepProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]

CLOSELY = 0.05
"""Change of a point's travel stiffness past which a factor is amended for it where its corrections do not contract."""


@dataclass(frozen=True)
class LineStepContacts(LineContacts):
    """The equations of a stage at one state.

    Attributes
    ----------
    problem : StepProblem
        Speed and position, and what the film's storage starts from.
    resists : (d, d) array
        `S` [1].
    """

    problem: StepProblem
    resists: Array = field(default_factory=lambda: np.zeros((2, 2)))

    @property
    def springs(self) -> Array:
        """`S`, (d, d)."""
        return self.resists

    @cached_property
    def force(self) -> Array:
        """Force of film and contacts on the journal less that of the springs `S`, over the unit of force, (d,)."""
        return self.problem.journal_force(self.x, self.lam) - self.resists @ self.problem.displacement

    @cached_property
    def film_imbalance(self) -> float:
        """Largest residual of the film's rows over the flows of their cells."""
        return self._largest(PRESSURE)

    @property
    def wall_imbalance(self) -> float:
        """Largest residual of the petals' rows over what they are compared with."""
        return self._largest(DEFLECTION)

    @property
    def opening(self) -> float:
        """Largest gap, and slope over a cell, at the contacts [reference films]."""
        slopes = np.abs(self.slopes * self.points.cell_length)
        return float(max(np.max(np.abs(self.closed), initial=0.0), np.max(slopes, initial=0.0)))

    def _largest(self, block: str) -> float:
        """Largest residual of a block of the rows over its scale."""
        own = self.problem.layout.unknowns[block]
        return float(np.max(np.abs(self.rows[own]) / self.linearized.row_scale[own], initial=0.0))


@dataclass(frozen=True)
class LineStage(TravellingStage[LineStepContacts, LineTangent, LineChange]):
    """A stage with contact lines.

    Attributes
    ----------
    stage : Stage
        Film, speed, rotor and what the stage starts from.
    before : Stretches
        Stretches of contacts at nodes at the instant before.
    """

    stage: Stage
    before: Stretches

    def at(self, state: LineContacts, tangent: LineTangent | None) -> LineStepContacts:
        """The equations at a state; those of its points that `tangent` serves know their numbers there.

        `tangent` is the one that led to the state, or None.
        """
        problem = self.stage.problem.at(displacement=state.problem.displacement)
        if not isinstance(problem, StepProblem):
            raise TypeError("contacts of a shaft in two bearings are at nodes")
        points = state.points if tangent is not None else replace(state.points, before=None)
        found = state.x, points, state.reaction, state.held, state.held_reaction
        return LineStepContacts(problem, *found, self.load, resists=self.stage.border_stiffness)

    def solved(
        self, start: LineContacts, tangent: LineTangent | None
    ) -> TravellingSolution[LineStepContacts, LineTangent] | None:
        """The stage's state near `start`; None if there is none near it.

        `tangent` is the one that led to what `start` is foretold from.
        """
        return self.reached(bearing_alone(self.at(start, tangent)), tangent)

    def refuse_closed(self, state: LineStepContacts) -> None:
        """Raise where the film is closed."""
        if not state.problem.admits(state.x):
            raise NoLinesError("the film closes")

    def revised(self, state: LineStepContacts) -> LineStepContacts | None:
        """The state with other contacts, where the signs ask for them; None where they are right."""
        return revised_in_time(state, EARLY_PULL, self.before)

    def tangent_at(self, state: LineStepContacts) -> LineTangent:
        """The factorised equations at a state.

        Raises
        ------
        NoLinesError
            They have no inverse.
        """
        if not state.contacts.constraints.determinate:
            raise NoLinesError("contacts repeat each other")
        try:
            return LineTangent.of(state, state.motion.growing(0.0, current_run().film_solver))
        except SingularMatrixError:
            raise NoLinesError("the contacts do not determine the petals") from None

    def serving(self, tangent: LineTangent, state: LineStepContacts, *, closely: bool) -> LineTangent | None:
        """The tangent as it serves the contacts of the state; None where a factorisation is better."""
        if not closely and tangent.serves(state):
            return tangent
        return tangent.on(state, CLOSELY if closely else STIFFER)

    def untangled(self, state: LineStepContacts) -> LineStepContacts:
        """With contacts at the nodes beside each point at which the gap does not curve upward."""
        return parted(state) if np.any(state.doubled) else state

    def serves(self, tangent: LineTangent, state: LineStepContacts) -> bool:
        """Whether no points have met in a correction."""
        return len(tangent.numbers) == len(state.reaction)

    def correction(self, state: LineStepContacts, tangent: LineTangent) -> tuple[LineChange, LineStepContacts]:
        """A step of Newton's method from the state."""
        return tangent.correction(state, LineResiduals.of(state), None), state

    def size(self, change: LineChange) -> float:
        """Size of a correction [reference films, ambient pressures]."""
        return float(max(np.max(np.abs(change.x)), np.max(np.abs(change.displacement))))

    def stepped(self, state: LineStepContacts, tangent: LineTangent, change: LineChange) -> LineStepContacts:
        """The state after a correction; points that meet are one."""
        return met(changed(state, tangent, change, TRUST))

    def asked_for(self, tangent: LineTangent, state: LineStepContacts) -> float:
        """Correction that what is left of the film's rows asks for, as far as the tangent has been seen to answer."""
        return told(tangent.response, state.film_imbalance)

    def residual(self, state: LineStepContacts) -> float:
        """Largest scaled residual."""
        return state.residual

    def moving(self, state: LineStepContacts) -> TimeState:
        """Gas, position and velocity of a state of this stage."""
        return self.stage.moving(state.x, state.problem.displacement)
