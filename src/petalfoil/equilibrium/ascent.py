"""The branch from rest: the assembled package, followed up to speed at a fixed journal position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from petalfoil.equilibrium.package_at_rest import at_rest
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution, from_closed
from petalfoil.equilibrium.warm_start import follow, restart
from petalfoil.solvers.contact_newton import ActiveOptions, active_set
from petalfoil.system.coupled import CoupledProblem


@dataclass(frozen=True)
class AscentOptions:
    """Numbers of the method."""

    first_share: float = 1e-3
    """First share of the speed: films start at the film floor, where the bearing number is 100 times larger."""
    factor: float = 10.0
    """Factor on the speed a step, where the contact set follows."""
    least_factor: float = 1.02
    """Factor below which the branch is taken to have ended: the interior point then finds where it settles."""
    max_steps: int = 200


def ascend(problem: CoupledProblem, work: RunLog, options: AscentOptions | None = None) -> tuple[Solution | None, int]:
    """Follow the assembled package from rest up to the speed of `problem`.

    Returns
    -------
    (Solution or None, int)
        The equilibrium at speed, None if it was lost on the way; and how often the branch ended before and the
        bearing settled elsewhere.
    """
    numbers = options or AscentOptions()
    known, jumps = rest(problem, work), 0
    share, factor = 0.0, numbers.factor
    for _ in range(numbers.max_steps):
        if known is None or share >= 1.0:
            return known, jumps
        ahead = min(1.0, share * factor if share else numbers.first_share)
        target = problem.at(bearing_number=ahead * problem.bearing_number)
        step = follow(known, target, work, ActiveOptions(max_steps=8))
        if step is not None:
            known, share, factor = step, ahead, min(factor**1.5, numbers.factor)
        elif factor > numbers.least_factor and share:
            factor = factor**0.5
        else:
            known, share, factor, jumps = restart(known, target, work), ahead, numbers.factor, jumps + 1
    return None, jumps


def rest(problem: CoupledProblem, work: RunLog) -> Solution | None:
    """The assembled package with its film at rest."""
    still = problem.at(bearing_number=0.0)
    package = at_rest(still, work)
    if package is None:
        return None
    w, closed = package
    x = np.concatenate([w, np.ones(problem.layout.n - problem.layout.n_wall)])
    answer, outcome = active_set(still, x, closed, work.film_solver, ActiveOptions())
    work.note("contacts", outcome=outcome.value)
    return from_closed(still, answer, "assembled package at rest")
