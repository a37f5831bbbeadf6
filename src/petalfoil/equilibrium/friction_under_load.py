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

from petalfoil.equilibrium.friction_handover import PathState, at_points, shared_friction
from petalfoil.equilibrium.friction_history import LONGEST_MOVE, assembled
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.line_friction_path import slide_on_lines
from petalfoil.equilibrium.line_handover import forces_at_nodes, on_lines_in_film
from petalfoil.equilibrium.nodal_state import sampled_lines, sampled_solution, shared_reactions, unknowns_at_nodes
from petalfoil.equilibrium.pack_on_lines import PackOnLines
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.point_friction_path import RubbingPoints, reached, slide_at_points
from petalfoil.equilibrium.rubbing_lines import RubbingLines
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.sinking import Medium, SinkingEquations
from petalfoil.equilibrium.sinking_lines import SinkingLines
from petalfoil.equilibrium.sliding_newton import SlidingNewton, SlidingOptions
from petalfoil.equilibrium.solution import FrictionPath, RefinedState, Solution
from petalfoil.equilibrium.under_load import FORCE_TOLERANCE
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import FrictionState, energy_lost, slips
from petalfoil.system.loaded import load_scale
from petalfoil.system.point_friction import RubbingEquations
from petalfoil.system.sinking_points import SinkingPoints

Array = NDArray[np.float64]

StateUnderLoad = FrictionResult | RubbingPoints | RubbingLines
"""A state of a path under a load, wherever its contacts are."""

BALANCE = SlidingOptions(accuracy=1e-10, first=0.2, slow=0.2, tangents=12)
"""A state ends by residual and force: corrections go on until they are rounding."""

SINKINGS = 200
"""Most steps of a journal that sinks: 1 mm in steps of full length."""

THIN, THICKER, THICKEST = 1e-4, 10.0, 8
"""What holds petals back, over the load for the longest step, where a step is not found; by how much more where that
does not serve either, and how often."""

NEARLY = 0.5
"""Part of the longest step below which a balance without the medium is tried: it is not far any more."""

PARTS, PARTS_ON_LINES = 2, 4
"""Times that a change of speed may be halved, with contact lines and otherwise."""

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
        """The pack of `problem` assembled at rest round the centred journal, which then sinks; None if it fails.

        With contact points or lines if they lead there, else with contacts at nodes.
        """
        still = problem.at(bearing_number=0.0, displacement=np.zeros(problem.layout.n_position))
        between = problem.layout.elements is not None or problem.layout.case.has_contact_lines
        for points in (True, False) if between else (False,):
            pack = assembled(self.friction, still, points=points)
            start = None if pack is None else in_film(pack.state, still, self.load)
            if start is None or (points and isinstance(start, FrictionResult)):
                continue
            found = self.sunk(still, start) if np.any(self.load) else self.solution(still, start)
            if found is not None:
                return found
        return None

    def run_up(self, known: Solution, problem: CoupledProblem) -> Solution | None:
        """The state at the speed of `problem` after `known`; from rest through parts of it. None if it fails.

        Where contact points or lines are lost, nodes hold the contacts until they are found again.
        """
        begin, end = known.problem.bearing_number, problem.bearing_number
        ways = [end * part for part in FROM_REST] if begin == 0.0 < end else [end]
        found: Solution | None = known
        for number in ways:
            start = None if found is None else path_of(found)
            if found is None or start is None:
                return None
            parts = PARTS_ON_LINES if isinstance(start, RubbingLines) else PARTS
            known, found = found, self.at_speed((found.problem, start), number, parts)
            if found is None and not isinstance(start, FrictionResult):
                current_run().note("friction", outcome="contact points lost")
                found = self.at_speed((known.problem, sampled(self.friction, start)), number, PARTS)
        return found

    def at_speed(
        self, known: tuple[CoupledProblem, StateUnderLoad], bearing_number: float, parts: int
    ) -> Solution | None:
        """The state at another bearing number; half the way first where that is too far. None if it fails.

        With contact lines, whose corrections contract in short steps, the journal sinks in the shortest ones alone.
        """
        before, start = known
        there = before.at(bearing_number=bearing_number)
        points = self.with_points(there, start)
        found = None if points is None else self.balanced(there, points)
        found = found or self.balanced(there, start)
        if found is None and not (parts and isinstance(start, RubbingLines)):
            found = self.sunk(there, start)
        if found is None and parts:
            half = self.at_speed(known, 0.5 * (before.bearing_number + bearing_number), parts - 1)
            if half is not None:
                found = self.at_speed((half.problem, path_of(half)), bearing_number, parts - 1)
        return found

    def sunk(self, problem: CoupledProblem, before: StateUnderLoad) -> Solution | None:
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
            unbalanced = float(np.linalg.norm(force_of(problem, before) + self.load))
            found = self.balanced(problem, before) if moved < NEARLY * longest else None
            if found is not None:
                return found
            thicker = max(thicker - 1, 0)
        return None

    def balanced(self, problem: CoupledProblem, before: StateUnderLoad) -> Solution | None:
        """The balance no farther than a step from where `problem` has the journal; None if there is none."""
        step = self.stepped(problem, before, Medium())
        if step is None:
            return None
        moved = float(np.linalg.norm(step[0].displacement - problem.displacement))
        found = self.solution(*step)
        good = found.reported_residual <= RESIDUAL_TOLERANCE and found.force_residual <= FORCE_TOLERANCE
        return found if good and moved <= longest_step(problem) else None

    def stepped(
        self, problem: CoupledProblem, before: StateUnderLoad, medium: Medium
    ) -> tuple[CoupledProblem, StateUnderLoad] | None:
        """The state after a step in a `medium`; None if it is not found."""
        if isinstance(before, RubbingPoints):
            found = self.points_after(problem, before, medium)
        elif isinstance(before, RubbingLines):
            found = self.lines_after(problem, before, medium)
        else:
            found = self.nodes_after(problem, before, medium)
        current_run().note("friction", outcome="not found" if found is None else "found")
        return found

    def points_after(
        self, problem: CoupledProblem, before: RubbingPoints, medium: Medium
    ) -> tuple[CoupledProblem, StateUnderLoad] | None:
        """The same of contact points."""
        own, at = before.equations, (problem.displacement, before.state.w)
        ahead = SinkingPoints(
            own.whole, problem, own.state, None, own.friction_force, medium.journal, medium.petals, *at
        )
        found = slide_at_points(ahead, before.law(self.friction.coefficient), current_run().film_solver, self.load)
        if found is None:
            return None
        lost = before.lost + found.lost
        return problem.at(displacement=found.equations.problem.displacement), replace(found, lost=lost)

    def lines_after(
        self, problem: CoupledProblem, before: RubbingLines, medium: Medium
    ) -> tuple[CoupledProblem, StateUnderLoad] | None:
        """The same of contact lines."""
        own, at = replace(before, problem=problem, load=self.load), (medium, problem.displacement, before.x)
        found = slide_on_lines(SinkingLines.of(own, *at), before, current_run().film_solver)
        if found is None:
            return None
        reached = replace(found.still, lost=before.lost + found.lost)
        return problem.at(displacement=reached.problem.displacement), reached

    def nodes_after(
        self, problem: CoupledProblem, before: FrictionResult, medium: Medium
    ) -> tuple[CoupledProblem, StateUnderLoad] | None:
        """The same of contacts at nodes."""
        equations = SinkingEquations(problem, self.load, before.x, medium)
        newton = SlidingNewton(equations, self.friction, before.friction, BALANCE)
        found = newton.solved((before.x, problem.displacement, before.active, before.lam, before.friction.force))
        if found is None:
            return None
        state, after = newton.state(*found)
        lost = before.lost + energy_lost(self.friction, before.friction, after)
        reached = FrictionResult(state.x, state.lam, state.active, state.residual, after, lost)
        return problem.at(displacement=state.b), reached

    def with_points(self, problem: CoupledProblem, nodal: StateUnderLoad) -> RubbingPoints | RubbingLines | None:
        """A state with contacts at nodes with contact points or lines in their place and its friction forces.

        Near it under the load, with lines where the journal is. None where there are none, or none are looked for.
        """
        whole = problem.layout.elements
        if not isinstance(nodal, FrictionResult):
            return None
        if problem.layout.case.has_contact_lines:
            return on_lines_in_film(self.friction, problem, nodal)
        if whole is None:
            return None
        state, force = at_points(whole, self.friction, nodal)
        ahead = RubbingEquations(whole, problem, replace(state, P=nodal.x[problem.positive]), friction_force=force)
        found = slide_at_points(ahead, None, current_run().film_solver, self.load)
        return None if found is None else replace(found, lost=nodal.lost)

    def solution(self, problem: CoupledProblem, reached: StateUnderLoad) -> Solution:
        """A state as a solution that knows its path."""
        if isinstance(reached, RubbingPoints):
            found = PointContacts(plain(reached.equations), reached.residual)
            known = sampled_solution(found, self.load)
            state = FrictionState.fresh(self.friction, known.x, known.lam)
            path = FrictionPath(state, known.lam > 0.0, reached.lost)
            return replace(known, solution_path=PATH, friction=path)
        if isinstance(reached, RubbingLines):
            nodes = sampled(self.friction, reached)
            path = FrictionPath(nodes.friction, nodes.active, reached.lost)
            return replace(sampled_lines(reached, self.load), solution_path=PATH, friction=path)
        nodal = RefinedState(reached.x, np.zeros(problem.layout.n_wall), reached.lam)
        path = FrictionPath(reached.friction, reached.active, reached.lost)
        return Solution(problem, nodal, reached.residual, PATH, load=self.load, friction=path)


def longest_step(problem: CoupledProblem) -> float:
    """Longest step of the journal over the reference length [1]."""
    return LONGEST_MOVE / problem.layout.scales.length


def path_of(known: Solution) -> StateUnderLoad:
    """A known state, to go on from."""
    path, found = known.friction, known.elements
    if path is None:
        raise ValueError("a solution without friction forces")
    if found is not None and isinstance(found.equations, RubbingEquations):
        return replace(reached(found.equations, None), lost=path.lost)
    if isinstance(known.lines, RubbingLines):
        return replace(known.lines, lost=path.lost)
    return FrictionResult(known.x, known.lam, path.active, known.residual, path.state, path.lost)


def plain(equations: RubbingEquations) -> RubbingEquations:
    """A state as it is under its film, out of any medium."""
    return RubbingEquations(
        equations.whole, equations.problem, equations.state, friction_force=equations.friction_force
    )


def force_of(problem: CoupledProblem, reached: StateUnderLoad) -> Array:
    """Force of film and contacts on the journal over the unit of force, (d,) [1]."""
    if isinstance(reached, RubbingPoints):
        return reached.equations.journal_force
    if isinstance(reached, RubbingLines):
        return reached.force
    return problem.journal_force(reached.x, reached.lam)


def in_film(state: PathState, problem: CoupledProblem, load: Array) -> StateUnderLoad:
    """A pack that was moved without film under one at ambient pressure and a `load` (d,), nothing lost so far."""
    if isinstance(state, RubbingPoints):
        return replace(state, equations=plain(state.equations), lost=0.0)
    if isinstance(state, PackOnLines):
        return state.in_film(problem, load)
    return replace(state, x=problem.layout.ambient(state.x), lost=0.0)


def sampled(friction: Friction, known: RubbingPoints | RubbingLines) -> FrictionResult:
    """A state with contact points at the nodes, where petals and friction forces are; not in equilibrium there."""
    if isinstance(known, RubbingLines):
        x, lam, force = known.x, known.shared, forces_at_nodes(friction, known)
    else:
        found = PointContacts(known.equations, known.residual)
        x, lam, force = unknowns_at_nodes(found), shared_reactions(found), shared_friction(friction, known)
    kept = FrictionState(slips(friction, x), force, friction.coefficient * friction.normal(lam))
    return FrictionResult(x, lam, lam > 0.0, known.residual, kept, known.lost)
