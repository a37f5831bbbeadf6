"""Whether there is more than one equilibrium at a position; a coarse grid answers at little cost.

Petals may rest on the next along a stretch or along a line, and they do so on every grid. Which state the interior
point finds depends on the barrier at which the film joins. Where petals touch at lines only, others are not looked for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.cold_start import finish
from petalfoil.equilibrium.contact_runs import runs
from petalfoil.equilibrium.pack_at_rest import central_point, with_ambient
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.forces import node_area
from petalfoil.solvers.interior_point import InteriorOptions
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

PROBE_BARRIERS = (30.0, 3.0, 0.3)
"""Barriers at which the film joins the pack: falling, so that the pack goes on along its central path."""

PROBE_CELLS, PROBE_AXIAL = 24, 6
"""Grid on which other equilibria are looked for."""


DIFFERENT = 1e-6
"""Equilibria whose normal forces on the journal differ by more than this fraction are different ones: a hundred times
the tolerance of a solution. Stiff packs have some that differ by 1e-4, in which contacts end a node apart."""


STRETCH = 0.09
"""Length of a contact, over the pitch, from which on other equilibria are looked for. Of 400 random packs 12 with a
cold start have others; their longest contacts are 0.099 to 0.9 of the pitch, those of 58 % of all packs are shorter."""


SLOW = 3.0
"""Decay of an answer per radian of rotation below which others are looked for beside it. At the end of a branch it is
zero. Of 600 random packs 21 have several equilibria: where the steps to the answer were not short, it decays by 1.12 at
most, those that touch as long by 6 in the median."""


CHANCE = 0.01
"""Shortest step over Newton's below which rounding decides where the interior point ends: of 200 random bearings eight
took one, of 600 equal problems one such answer was another. Others are then looked for on its own grid."""


RESTLESS = 40
"""Steps of the interior point above which rounding decides likewise: half of those that it may take. Of 200 random
bearings all but four that lead to an answer take 33 at most; those of 65 and more end elsewhere, or nowhere, where
the modulus changes by 1e-13."""


def found_by_chance(answer: Solution | None) -> bool:
    """Whether an equal problem may lead elsewhere: the first start fails, hardly moves or long goes on."""
    if answer is None:
        return True
    shortest, count = answer.shortest_step, answer.step_count
    return (shortest is not None and shortest < CHANCE) or (count is not None and count > RESTLESS)


def by_short_steps(answer: Solution) -> bool:
    """Whether the interior point took a step on the way to an answer that points to a fold."""
    return answer.shortest_step is not None and answer.shortest_step < InteriorOptions.short


def off_path(answer: Solution) -> bool:
    """Whether the path to an answer is not the central one: by a short step, or not by the interior point."""
    return answer.shortest_step is None or by_short_steps(answer)


def may_have_others(answer: Solution, rate: complex) -> bool:
    """Whether other equilibria are worth looking for beside an answer with the leading eigenvalue `rate`.

    They are where it is unstable, where a petal touches along `STRETCH` or more, may rest on the next in more than one
    way and does not soon come back to the way it does, and where the path to the answer is not the central one.
    """
    comes_back = rate.real <= -SLOW
    return off_path(answer) or rate.real > 0.0 or (longest_contact(answer) >= STRETCH and not comes_back)


def longest_contact(answer: Solution) -> float:
    """Length of the longest run of active contacts around the shaft, over the pitch [1]."""
    wall = answer.problem.layout.wall
    lengths = [
        line.phi[run[-1]] - line.phi[run[0]]
        for line in wall.contacts.lines
        for contacts in answer.active[line.number]
        for run in runs(contacts)
    ]
    return float(max(lengths, default=0.0)) * wall.film.shape[0] / (2.0 * np.pi)


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


def different(answers: list[Solution]) -> list[Solution]:
    """The first of each of the different equilibria among `answers`, which share a grid and a position."""
    found: list[tuple[Array, Solution]] = []
    for answer in answers:
        mark = fingerprint(answer)
        if all(np.max(np.abs(mark - other)) > DIFFERENT * max(mark[0], other[0]) for other, _ in found):
            found.append((mark, answer))
    return [answer for _, answer in found]


def pressing_least(answers: list[Solution]) -> list[Solution]:
    """The same, those first whose normal forces on the journal are least."""
    return sorted(answers, key=lambda answer: float(fingerprint(answer)[0]))


def probe(problem: CoupledProblem) -> int:
    """Number of different equilibria that a few cold starts find, at least 1."""
    return max(1, len(cold_answers(problem)))


def coarse(case: Case) -> Case:
    """The same bearing on the grid of the probe."""
    changes: dict[str, object] = {"model.cells_per_pitch": min(case.cells_per_pitch, PROBE_CELLS)}
    if case.model.kind is ModelKind.THREE_D:
        changes["model.axial_cells"] = min(case.axial_cells, PROBE_AXIAL)
    return case.replace(**changes)


def is_coarse(case: Case) -> bool:
    """Whether the grid of the probe is the case's own."""
    fine = case.model.kind is ModelKind.THREE_D and case.axial_cells > PROBE_AXIAL
    return case.cells_per_pitch <= PROBE_CELLS and not fine


def known_on_few_cells(problem: CoupledProblem) -> int:
    """Number of different equilibria of the same bearing on the grid of the probe, at least 1."""
    few = build_problem(coarse(problem.layout.case))
    return probe(few.at(bearing_number=problem.bearing_number, displacement=problem.displacement))


def cold_answers(problem: CoupledProblem) -> list[Solution]:
    """The different equilibria that a few cold starts find."""
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
    found = different(answers)
    current_run().note("probe", equilibria=len(found))
    return found
