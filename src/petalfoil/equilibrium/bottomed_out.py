"""A package that a load has pressed solid between journal and bushing.

Where journal, petals and bushing touch at one angle, three closed gaps say what two of them say already: no contact set
determines the reactions, and the rigid stack carries what the load asks for. The interior point answers all the same.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from petalfoil.equilibrium.loaded import Balance, force_residual
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import RefinedState, Solution, total_residual
from petalfoil.solvers.cone import ConePoint
from petalfoil.solvers.interior_point import InteriorOptions, Step, interior_point
from petalfoil.system.coupled import RESIDUAL_TOLERANCE
from petalfoil.system.loaded import LoadedProblem


def pressed_solid(whole: LoadedProblem, point: ConePoint, work: RunLog) -> Balance | None:
    """The interior point's own answer: it goes on from `point` until gap or reaction of every pair has vanished."""
    look = work.watch("solid", lambda step: False)

    def answered(at: ConePoint, step: Step) -> bool:
        return look(at, step) or solid_answer(whole, at).residual <= RESIDUAL_TOLERANCE

    for goal in SOLID_GOALS:
        point, found = interior_point(
            whole, point, work.film_solver, replace(SOLID_STEPS, least_barrier=goal), answered
        )
        if found:
            answer = solid_answer(whole, point)
            return Balance(answer, force_residual(answer, whole.load))
    return None


def solid_answer(whole: LoadedProblem, point: ConePoint) -> Solution:
    """The state of `point`, its slacks dropped."""
    problem = whole.at(point.x)
    state = RefinedState(point.x[:-2], np.zeros(problem.layout.n_wall), point.lam)
    return Solution(problem, state, total_residual(problem, state), SOLID)


SOLID_GOALS = (1e-13, 1e-14, 1e-15, 1e-16)
"""Barriers that a package pressed solid is followed to: pairs off the path need decades more than their mean."""

SOLID_STEPS = InteriorOptions(max_steps=4)
"""Newton's answer loses digits at such barriers: more steps gain nothing."""

SOLID = "interior point; petals are pressed solid between journal and bushing"
"""How such an answer was reached."""
