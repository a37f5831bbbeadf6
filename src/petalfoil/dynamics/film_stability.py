"""Is an equilibrium stable at a fixed journal position?

The wall has no mass; the film has. With the contacts that carry load kept closed, small disturbances obey
`J u + s M u = 0` (E1) in `exp(s tau)`, `tau = omega t`: stable if every `s` has a negative real part.
"""

from __future__ import annotations

import numpy as np

from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.constraints import tie
from petalfoil.solvers.eigenvalues import Pencil, rightmost

TIME_STEP = 0.15
"""Radians of rotation a step of the eigenvalue's time map: what grows or dies out in a few of them is seen first."""


def leading_eigenvalue(answer: Solution, work: RunLog) -> complex:
    """Leading eigenvalue in radians of rotation; nan for a shaft at rest, whose film does not move."""
    problem = answer.problem
    if problem.bearing_number == 0.0:
        return complex(np.nan, np.nan)
    line, none = problem.linearize(answer.x), np.zeros(len(problem.weight))
    steady = line.matrix(none)
    ties = answer.closed.ties if answer.closed is not None else tie(problem.G, answer.in_contact)
    first = int(ties.group[: problem.layout.n_wall].max(initial=-1)) + 1
    pencil = Pencil(ties.reduce(steady), ties.reduce(line.stored), first, ties.rank(problem.rank))
    return rightmost(pencil, TIME_STEP, work.probe_solver)
