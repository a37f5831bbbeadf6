"""A loaded journal with friction between petals that slide along themselves: set down on the pack at rest, and run up.

Each state comes from the one before, as petals keep the friction forces of the path that they have gone. A journal out
of balance sinks without inertia (M7), in steps of bounded length: `c` is the unbalanced force of the step before over
the longest step, until a step without the medium is no longer than that. Only the direction of the path depends on the
medium, not the time. Petals that snap sink too: where no state is found, they are held back as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.friction_history import LONGEST_MOVE, assembled
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.sinking import Medium, SinkingEquations
from petalfoil.equilibrium.sliding_newton import SlidingNewton, SlidingOptions
from petalfoil.equilibrium.solution import FrictionPath, RefinedState, Solution
from petalfoil.equilibrium.under_load import FORCE_TOLERANCE
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import energy_lost
from petalfoil.system.loaded import load_scale

Array = NDArray[np.float64]

BALANCE = SlidingOptions(accuracy=1e-10, first=0.2, slow=0.2, tangents=12)
"""A state ends by residual and force: corrections go on until they are rounding."""

SINKINGS = 200
"""Most steps of a journal that sinks: 1 mm in steps of full length."""

THIN, THICKER, THICKEST = 1e-4, 10.0, 8
"""What holds petals back, over the load for the longest step, where a step is not found; by how much more where that
does not serve either, and how often."""

NEARLY = 0.5
"""Part of the longest step below which a balance without the medium is tried: it is not far any more."""

PARTS = 2
"""Times that a change of speed may be halved."""

FROM_REST = (0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Parts of a speed through which a pack that was loaded at rest comes to it."""

PATH = "assembled, loaded at rest and run up with friction between the petals"
"""How such a state was reached."""


@dataclass(frozen=True)
class LoadedPath:
    """States of a journal under one load, each from the one before.

    Attributes
    ----------
    friction : Friction
        The law between the petals.
    load : (n_position,) array
        Load over the unit of force [1].
    """

    friction: Friction
    load: Array

    def set_down(self, problem: CoupledProblem) -> Solution | None:
        """The pack of `problem` assembled at rest round the centred journal, which then sinks; None if it fails."""
        still = problem.at(bearing_number=0.0, displacement=np.zeros(problem.layout.n_position))
        pack = assembled(self.friction, still)
        if pack is None:
            return None
        start = replace(pack, x=problem.layout.ambient(pack.x))
        return self.sunk(still, start) if np.any(self.load) else self.solution(still, start)

    def run_up(self, known: Solution, problem: CoupledProblem) -> Solution | None:
        """The state at the speed of `problem` after `known`; from rest through parts of it. None if it fails."""
        begin, end = known.problem.bearing_number, problem.bearing_number
        ways = [end * part for part in FROM_REST] if begin == 0.0 < end else [end]
        found: Solution | None = known
        for number in ways:
            found = None if found is None else self.at_speed(found, number, PARTS)
        return found

    def at_speed(self, known: Solution, bearing_number: float, parts: int) -> Solution | None:
        """The state at another bearing number; half the way first where that is too far. None if it fails."""
        there = known.problem.at(bearing_number=bearing_number)
        found = self.balanced(there, path_of(known)) or self.sunk(there, path_of(known))
        if found is None and parts:
            half = self.at_speed(known, 0.5 * (known.problem.bearing_number + bearing_number), parts - 1)
            found = None if half is None else self.at_speed(half, bearing_number, parts - 1)
        return found

    def sunk(self, problem: CoupledProblem, before: FrictionResult) -> Solution | None:
        """The journal released where `problem` has it (M7), until it balances; None if it does not come to rest."""
        longest, thicker = longest_step(problem), 0
        unbalanced = load_scale(self.load)
        for _ in range(SINKINGS):
            thick = THIN * THICKER**thicker * load_scale(self.load) / (longest * problem.layout.n_wall)
            step = self.stepped(problem, before, Medium(unbalanced / longest, thick if thicker else 0.0))
            if step is None:
                thicker += 1
                if thicker > THICKEST:
                    return None
                continue
            moved = float(np.linalg.norm(step[0].displacement - problem.displacement))
            problem, before = step
            unbalanced = float(np.linalg.norm(problem.journal_force(before.x, before.lam) + self.load))
            found = self.balanced(problem, before) if moved < NEARLY * longest else None
            if found is not None:
                return found
            thicker = max(thicker - 1, 0)
        return None

    def balanced(self, problem: CoupledProblem, before: FrictionResult) -> Solution | None:
        """The balance no farther than a step from where `problem` has the journal; None if there is none."""
        step = self.stepped(problem, before, Medium())
        if step is None:
            return None
        moved = float(np.linalg.norm(step[0].displacement - problem.displacement))
        found = self.solution(*step)
        good = found.residual <= RESIDUAL_TOLERANCE and found.force_residual <= FORCE_TOLERANCE
        return found if good and moved <= longest_step(problem) else None

    def stepped(
        self, problem: CoupledProblem, before: FrictionResult, medium: Medium
    ) -> tuple[CoupledProblem, FrictionResult] | None:
        """The state after a step in a `medium`; None if it is not found."""
        equations = SinkingEquations(problem, self.load, before.x, medium)
        newton = SlidingNewton(equations, self.friction, before.friction, BALANCE)
        found = newton.solved((before.x, problem.displacement, before.active, before.lam, before.friction.force))
        current_run().note("friction", outcome="not found" if found is None else "found")
        if found is None:
            return None
        state, after = newton.state(*found)
        lost = before.lost + energy_lost(self.friction, before.friction, after)
        reached = FrictionResult(state.x, state.lam, state.active, state.residual, after, lost)
        return problem.at(displacement=state.b), reached

    def solution(self, problem: CoupledProblem, reached: FrictionResult) -> Solution:
        """A state as a solution that knows its path."""
        state = RefinedState(reached.x, np.zeros(problem.layout.n_wall), reached.lam)
        path = FrictionPath(reached.friction, reached.active, reached.lost)
        return Solution(problem, state, reached.residual, PATH, load=self.load, friction=path)


def longest_step(problem: CoupledProblem) -> float:
    """Longest step of the journal over the reference length [1]."""
    return LONGEST_MOVE / problem.layout.scales.length


def path_of(known: Solution) -> FrictionResult:
    """A known state, to go on from."""
    path = known.friction
    if path is None:
        raise ValueError("a solution without friction forces")
    return FrictionResult(known.x, known.lam, path.active, known.residual, path.state, path.lost)
