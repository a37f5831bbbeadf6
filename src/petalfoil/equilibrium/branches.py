"""Whether there is more than one equilibrium at a position; a coarse grid answers at little cost.

Petals may rest on the next along a stretch or along a line, and they do so on every grid. Which state the interior
point finds depends on the barrier at which the film joins.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.cold_start import finish
from petalfoil.equilibrium.pack_at_rest import central_point, with_ambient
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.forces import node_area
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

PROBE_BARRIERS = (30.0, 3.0, 0.3)
"""Barriers at which the film joins the pack: falling, so that the pack goes on along its central path."""

DIFFERENT = 1e-6
"""Equilibria whose normal forces on the journal differ by more than this fraction are different ones: a hundred times
the tolerance of a solution. Stiff packs have some that differ by 1e-4, in which contacts end a node apart."""


def fingerprint(answer: Solution) -> Array:
    """Normal forces on the journal: sum of magnitudes, sum, and components along both axes; (4,) [N]."""
    problem = answer.problem
    film, radius = problem.layout.wall.film, problem.layout.balance.radius
    push = (problem.pressure(answer.x) - 1.0) * node_area(film, radius) * problem.layout.scales.pressure
    reactions = answer.lam[problem.layout.wall.contacts.journal] * problem.layout.scales.force
    if len(reactions):
        push = push + reactions.reshape(push.shape)
    radial = push.sum(axis=2)
    parts = [np.abs(push), radial, radial * np.cos(film.theta), radial * np.sin(film.theta)]
    return np.array([part.sum() for part in parts])


def distinct(answers: list[Solution]) -> int:
    """Number of different equilibria among `answers`, which share a grid and a position."""
    found: list[Array] = []
    for answer in answers:
        mark = fingerprint(answer)
        if all(np.max(np.abs(mark - other)) > DIFFERENT * max(mark[0], other[0]) for other in found):
            found.append(mark)
    return len(found)


def probe(problem: CoupledProblem) -> int:
    """Number of different equilibria that a few cold starts find, at least 1."""
    answers: list[Solution] = []
    with running() as question:
        pack: PrimalDualPoint | None = None
        for barrier in PROBE_BARRIERS:
            try:
                pack = central_point(problem, barrier, pack)
                start = with_ambient(problem, pack)
                answer = finish(problem, start, f"interior point from the assembled pack, barrier {barrier:g}")
            except SingularMatrixError as failure:
                current_run().note("film", outcome=str(failure))
                continue
            answers += [] if answer is None else [answer]
    current_run().probes.factorizations += question.film.factorizations + question.pack.factorizations
    count = max(1, distinct(answers))
    current_run().note("probe", equilibria=count)
    return count
