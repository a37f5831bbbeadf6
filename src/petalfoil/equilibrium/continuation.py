"""One step along a branch: by the contact set if it leads there, else by the interior point. Was it a jump, then?"""

from __future__ import annotations

import numpy as np

from petalfoil.equilibrium.branches import fingerprint
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.warm_start import follow, predict, restart
from petalfoil.solvers.contact_newton import ActiveOptions
from petalfoil.system.coupled import CoupledProblem

WARM = ActiveOptions(max_steps=7)
"""A contact set that leads on does so in 2 to 6 steps."""

SUSPECT = 0.05
"""Change of the push on the journal, over its size, beyond which a restarted point is checked for a jump."""

FAR, FAR_FOLLOWED = 3.0, 10.0
"""Times that a restarted or a followed point may be as far as the tangent foretold without such a check. A contact that
opens on the way takes a followed one seven times as far, a fold that it leaps a hundred times."""

NEAR = 1e-6
"""What is not farther than this from a neighbour is no jump, however little was foretold: the same point again."""

LEAP = 0.5
"""Share of the whole way in one small step that makes it a jump: along a branch it falls as the steps do."""

SUBSTEPS = (4, 16)
"""Parts into which the way is cut to see whether the branch leads there."""


def advance(known: Solution, problem: CoupledProblem, work: RunLog) -> tuple[Solution, bool]:
    """The equilibrium at `problem` on the branch of `known`, and whether the branch had to be left.

    Raises
    ------
    ConvergenceError
        Nothing was found.
    """
    change = predict(known, problem)
    step = follow(known, problem, work, WARM, change)
    found = step or restart(known, problem, work, change) or solve_cold(problem, work)
    way, foretold = distance(known, found), max(float(np.max(np.abs(change), initial=0.0)), NEAR)
    if step is not None and (way <= FAR_FOLLOWED * foretold or known.closed is None):  # or nothing was foretold
        return found, False
    if step is None and way <= FAR * foretold and not pushes_otherwise(known, found):
        return found, False
    for count in SUBSTEPS:
        gentle = by_small_steps(known, problem, count, LEAP * way, work)
        if gentle is not None:
            return gentle, False
    return found, True


def distance(one: Solution, other: Solution) -> float:
    """Largest difference of an unknown: a deflection over the reference film, a pressure over the ambient one."""
    return float(np.max(np.abs(other.x - one.x), initial=0.0))


def pushes_otherwise(known: Solution, found: Solution) -> bool:
    """The push on the journal changed by more than a small step would."""
    before, after = fingerprint(known), fingerprint(found)
    return bool(np.max(np.abs(after - before)) > SUSPECT * max(before[0], after[0]))


def by_small_steps(
    known: Solution, problem: CoupledProblem, count: int, farthest: float, work: RunLog
) -> Solution | None:
    """Follow the branch in `count` equal parts, none of them beyond `farthest`; None where it does not lead on so."""
    start, current = known.problem, known
    for part in range(1, count + 1):
        share = part / count
        between = problem.at(
            bearing_number=start.bearing_number + share * (problem.bearing_number - start.bearing_number),
            displacement=start.displacement + share * (problem.displacement - start.displacement),
        )
        step = follow(current, between, work, WARM)
        if step is None or distance(current, step) > farthest:
            return None
        current = step
    return current
