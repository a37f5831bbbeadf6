"""From a known equilibrium to a neighbour, along a branch.

`follow` takes the tangent and the active contacts of the known equilibrium, `restart` the interior point from there,
`advance` both, and finds out whether the branch was left. `ascend` follows the branch from rest up to speed; `settle`
finds where an unstable equilibrium goes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.branches import fingerprint
from petalfoil.equilibrium.cold_start import finish, solve_cold
from petalfoil.equilibrium.other_grids import or_from_other_grids
from petalfoil.equilibrium.pack_at_rest import at_rest
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.interior_point import InteriorOptions
from petalfoil.solvers.problem import PrimalDualPoint, positive_step
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]

RESTART_BARRIER = 0.3
"""Barrier of a warm interior point: 0.1 to 1 cost 7 to 11 factorisations, smaller ones stall near the old contacts."""

# ---------------------------------------------------------------------------------------------- one step


def predict(known: Solution, problem: CoupledProblem) -> Array:
    """First-order change of the unknowns from `known` to another speed or position (T5), shape (n,); no factorisation.

    Active gaps stay closed; the tangent is the last one that led to `known`.
    """
    if known.contacts is None:
        return np.zeros_like(known.x)
    constraints, tangent = known.contacts.constraints, known.contacts.tangent.tangent
    moved = problem.gaps(known.x) - known.problem.gaps(known.x)
    before = known.problem.linearize(known.x)
    follow = constraints.close(moved[constraints.held])
    force = before.matrix(np.zeros(len(moved))) @ follow + before.slack_derivative(moved)
    if problem.film_number != known.problem.film_number or problem.bearing_number != known.problem.bearing_number:
        faster = known.problem.at(bearing_number=problem.bearing_number, temperatures=problem.temperatures)
        grown = known.problem.gaps(known.x) - faster.gaps(known.x)  # counted in `moved`: the film stays as it is
        force = force + faster.linearize(known.x, grown).residual - before.residual
    return np.asarray(follow + tangent.step(force))


def predicted(known: Solution, problem: CoupledProblem, change: Array | None = None) -> Array:
    """Unknowns foretold at `problem`, (n,), the change shortened so that pressures stay positive."""
    change = predict(known, problem) if change is None else change
    return known.x + positive_step(problem, known.x, change) * change


def widened(problem: CoupledProblem, x: Array, lam: Array) -> PrimalDualPoint:
    """A point of the interior-point method near unknowns `x` and reactions `lam`."""
    s = np.maximum(problem.gaps(x), np.sqrt(RESTART_BARRIER))
    return PrimalDualPoint(x, s, np.maximum(lam, RESTART_BARRIER * problem.weight / s))


def follow(
    known: Solution, problem: CoupledProblem, options: ContactOptions | None = None, change: Array | None = None
) -> Solution | None:
    """The neighbour of `known` on its own branch by tangent and active contacts alone; None if they do not lead there.

    `change` is what `predict` foretells, if it is at hand; likewise in `restart`.
    """
    run, start = current_run(), (predicted(known, problem, change), known.active)
    tangent = None if known.contacts is None else known.contacts.tangent
    contacts, outcome = solve_contacts(problem, start, run.film_solver, options, tangent)
    run.note("contacts", outcome=outcome.value)
    return from_contacts(problem, contacts, "followed from the neighbouring point")


def restart(known: Solution, problem: CoupledProblem, change: Array | None = None) -> Solution | None:
    """The interior point from `known`, widened; it may find another branch."""
    start = widened(problem, predicted(known, problem, change), known.lam)
    try:
        return finish(problem, start, "interior point from the neighbouring point")
    except SingularMatrixError as failure:
        current_run().note("film", outcome=str(failure))
        return None


def settle(unstable: Solution) -> Solution | None:
    """Disturb an unstable equilibrium and march in time to where it goes; None if it comes to no rest."""
    problem, x = unstable.problem, unstable.x.copy()
    pressures = x[problem.positive]
    x[problem.positive] = pressures * (1.0 + DISTURBANCE * np.random.default_rng(0).standard_normal(len(pressures)))
    path = "marched in time from a disturbed unstable equilibrium"
    try:
        return finish(problem, widened(problem, x, unstable.lam), path, InteriorOptions(march=True))
    except SingularMatrixError as failure:
        current_run().note("film", outcome=str(failure))
        return None


DISTURBANCE = 0.01
"""Relative disturbance of the pressures of an unstable equilibrium."""

# ---------------------------------------------------------------------------------------------- along a branch

WARM = ContactOptions(tangents=7)
"""Active contacts that lead on do so in 2 to 6 tangents."""

SUSPECT = 0.05
"""Change of the force on the journal, over its size, beyond which a restarted point is checked for a jump."""

FAR, FAR_FOLLOWED = 3.0, 10.0
"""Times that a restarted or a followed point may be as far as the tangent foretold without such a check. A contact that
opens on the way takes a followed one seven times as far, a fold that it leaps a hundred times."""

NEAR = 1e-6
"""A point nearer than this to its neighbour is no jump, however little was foretold: it is the same point again."""

LEAP = 0.5
"""Fraction of the whole distance in one small step that makes it a jump: along a branch it falls as the steps do."""

SUBSTEPS = (4, 16)
"""Parts into which a step is cut to see whether the branch leads there."""


def advance(known: Solution, problem: CoupledProblem) -> tuple[Solution, bool]:
    """The equilibrium at `problem` on the branch of `known`, and whether the branch had to be left.

    Raises
    ------
    ConvergenceError
        Nothing was found.
    """
    change = predict(known, problem)
    step = follow(known, problem, WARM, change)
    found = step or restart(known, problem, change) or or_from_other_grids(solve_cold, problem)
    moved, foretold = distance(known, found), max(float(np.max(np.abs(change), initial=0.0)), NEAR)
    if step is not None and (moved <= FAR_FOLLOWED * foretold or known.contacts is None):  # or nothing was foretold
        return found, False
    if step is None and moved <= FAR * foretold and not pushes_otherwise(known, found):
        return found, False
    for count in SUBSTEPS:
        gentle = by_small_steps(known, problem, count, LEAP * moved)
        if gentle is not None:
            return gentle, False
    return found, True


def distance(one: Solution, other: Solution) -> float:
    """Largest difference of an unknown: a deflection over the reference film, a pressure over the ambient one."""
    return float(np.max(np.abs(other.x - one.x), initial=0.0))


def pushes_otherwise(known: Solution, found: Solution) -> bool:
    """The force on the journal changed by more than a small step would."""
    before, after = fingerprint(known), fingerprint(found)
    return bool(np.max(np.abs(after - before)) > SUSPECT * max(before[0], after[0]))


def by_small_steps(known: Solution, problem: CoupledProblem, count: int, farthest: float) -> Solution | None:
    """Follow the branch in `count` equal parts, none of them beyond `farthest`; None where it does not lead on so."""
    current = known
    for part in range(1, count + 1):
        step = follow(current, on_the_way(known.problem, problem, part / count), WARM)
        if step is None or distance(current, step) > farthest:
            return None
        current = step
    return current


def on_the_way(start: CoupledProblem, end: CoupledProblem, share: float) -> CoupledProblem:
    """The problem `end` at a share of the way in speed and position from `start` [1]."""
    return end.at(
        bearing_number=start.bearing_number + share * (end.bearing_number - start.bearing_number),
        displacement=start.displacement + share * (end.displacement - start.displacement),
    )


# ---------------------------------------------------------------------------------------------- from rest to speed


@dataclass(frozen=True)
class AscentOptions:
    """Numbers of the ascent."""

    first: float = 1e-3
    """First fraction of the speed: films start as thin as contact allows, with a bearing number 100 times larger."""
    factor: float = 10.0
    """Factor on the speed a step, where the active contacts lead on."""
    least_factor: float = 1.02
    """Factor below which the branch is taken to have ended: the interior point then finds where it settles."""
    max_steps: int = 200


def ascend(problem: CoupledProblem, options: AscentOptions | None = None) -> tuple[Solution | None, int]:
    """Follow the assembled foil pack from rest up to the speed of `problem`.

    Returns
    -------
    (Solution or None, int)
        The equilibrium at speed, None if it was lost on the way; and how often the branch ended before and the
        bearing settled elsewhere.
    """
    numbers = options or AscentOptions()
    known, jumps = rest(problem), 0
    fraction, factor = 0.0, numbers.factor
    for _ in range(numbers.max_steps):
        if known is None or fraction >= 1.0:
            return known, jumps
        ahead = min(1.0, fraction * factor if fraction else numbers.first)
        target = problem.at(bearing_number=ahead * problem.bearing_number)
        step = follow(known, target, ContactOptions(tangents=8))
        if step is not None:
            known, fraction, factor = step, ahead, min(factor**1.5, numbers.factor)
        elif factor > numbers.least_factor and fraction:
            factor = factor**0.5
        else:
            known, fraction, factor, jumps = restart(known, target), ahead, numbers.factor, jumps + 1
    return None, jumps


def rest(problem: CoupledProblem) -> Solution | None:
    """The assembled foil pack at zero speed, its film at rest; None if none was found."""
    still, run = problem.at(bearing_number=0.0), current_run()
    pack = at_rest(still)
    if pack is None:
        return None
    start = problem.layout.ambient(pack.x), pack.active
    contacts, outcome = solve_contacts(still, start, run.film_solver)
    run.note("contacts", outcome=outcome.value)
    return from_contacts(still, contacts, "assembled foil pack at zero speed")
