"""One step along a branch: by the contact set if it leads there, else by the interior point. Was it a jump, then?"""

from __future__ import annotations

import numpy as np

from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.branches import fingerprint
from petalfoil.equilibria.cold import solve_cold
from petalfoil.equilibria.warm import follow, restart
from petalfoil.equilibria.work import Work
from petalfoil.problem.coupled import CoupledProblem
from petalfoil.solvers.active_set import ActiveOptions

WARM = ActiveOptions(max_steps=7)
"""A contact set that leads on does so in 2 to 6 steps."""

SUSPECT = 0.05
"""Change of the push on the journal, over its size, beyond which a restarted point is checked for a jump."""

SUBSTEPS = (4, 16)
"""Parts into which the way is cut to see whether the branch leads there."""


def advance(known: Answer, problem: CoupledProblem, work: Work) -> tuple[Answer, bool]:
    """The equilibrium at `problem` on the branch of `known`, and whether the branch had to be left.

    Raises
    ------
    ConvergenceError
        Nothing was found.
    """
    step = follow(known, problem, work, WARM)
    if step is not None:
        return step, False
    found = restart(known, problem, work) or solve_cold(problem, work)
    if not suspicious(known, found):
        return found, False
    for count in SUBSTEPS:
        gentle = by_small_steps(known, problem, count, work)
        if gentle is not None:
            return gentle, False
    return found, True


def suspicious(known: Answer, found: Answer) -> bool:
    """The push on the journal changed by more than a small step would."""
    before, after = fingerprint(known), fingerprint(found)
    return bool(np.max(np.abs(after - before)) > SUSPECT * max(before[0], after[0]))


def by_small_steps(known: Answer, problem: CoupledProblem, count: int, work: Work) -> Answer | None:
    """Follow the branch in `count` equal parts; None where it does not lead on."""
    start, current = known.problem, known
    for part in range(1, count + 1):
        share = part / count
        between = problem.at(
            bearing_number=start.bearing_number + share * (problem.bearing_number - start.bearing_number),
            displacement=start.displacement + share * (problem.displacement - start.displacement),
        )
        step = follow(current, between, work, WARM)
        if step is None:
            return None
        current = step
    return current
