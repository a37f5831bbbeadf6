"""Film and foil pack from nothing: the assembled pack, then both through the interior point.

Where the equilibrium is unstable or the central path folds, that may lead nowhere. Then the wall is marched to rest
against a damping of its own, and at last the path is followed through its folds by its arc length.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from petalfoil.equilibrium.pack_at_rest import assembled
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts, from_point, refine
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.central_path import PathOptions, follow_central_path
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import ActiveContacts, solve_contacts
from petalfoil.solvers.interior_point import InteriorOptions, InteriorStep, contact_set, interior_point
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, ContactProblem, PrimalDualPoint
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.damped import DampedWall

BARRIERS = (3.0, 30.0, 0.3, 300.0)
"""Barriers at which the film joins, in ambient pressure times 10 um; the first serves 97 % of random bearings."""

FILM_ALONE = ContactOptions(tangents=60, near=0.3, gain=0.2, steps=9)
"""Over a rigid wall Newton converges from afar, and a step with the factor at hand costs a fifth of another."""

GOALS = (1e-5, 1e-8, 1e-11)
"""Barriers at which the active contacts are read and tried: they are right, or close, at the first on grids up to 512
cells per pitch."""


def solve_cold(problem: CoupledProblem, barriers: tuple[float, ...] = BARRIERS) -> Solution:
    """Solve from nothing: by each barrier in turn until one leads to an answer, else by what is slower and surer.

    Raises
    ------
    ConvergenceError
        Nothing led to an answer.
    """
    answer = by_barriers(problem, barriers) or by_slower_ways(problem)
    if answer is None:
        raise nothing_found(endless=problem.endless)
    return answer


def by_barriers(problem: CoupledProblem, barriers: tuple[float, ...] = BARRIERS) -> Solution | None:
    """The answer of the first barrier at which the interior point leads to one."""
    return next(filter(None, (attempt(problem, barrier) for barrier in barriers)), None)


def by_slower_ways(problem: CoupledProblem) -> Solution | None:
    """The answer of a march with a damped wall, or along the central path; None if they lead nowhere."""
    if not problem.layout.n_wall:
        return None
    damped, start = (lambda damping: DampedWall.of(problem, damping)), (lambda barrier: assembled(problem, barrier))
    return first_answer(problem, slower_ways(problem, damped, start))


def first_answer(problem: CoupledProblem, points: Iterable[tuple[PrimalDualPoint, str]]) -> Solution | None:
    """The first solution that points close to one lead to, each with how it was reached; None if none does."""
    for point, path in points:
        try:
            answer = finish(problem, point, path)
        except SingularMatrixError as failure:
            current_run().note("film", outcome=str(failure))
            continue
        if answer is not None:
            return answer
    return None


MARCHES = ((0.1, 3.0), (1.0, 3.0), (0.01, 3.0), (0.001, 3.0), (0.1, 30.0))
"""Dampings of the wall and barriers at which the film joins, in the order of trial. Of twelve bearings with continuous
edges that no barrier serves, either of the first two serves eight, in 40 to 114 factorisations."""

MARCH = InteriorOptions(march=True, max_steps=150, least_barrier=0.1 * GOALS[0])

MARCHED = "marched to rest with a damped wall"
"""How such a solution was reached."""

PATHS = ((100.0, 10.0, 2000), (10.0, 10.0, 200), (100.0, 1.0, 200), (1000.0, 1.0, 200))
"""First barriers of a central path, weights of the unknowns in its arc length and most steps, in the order of trial.
Petals that snap one by one fold a path a hundred times: the first has led to the end in 26 to 1017 steps."""

PATH_END = 1e-6
"""Barrier at the end of a path, whence the contact set is read."""


def slower_ways(
    problem: ContactProblem,
    damped: Callable[[float], ContactProblem],
    start: Callable[[float], PrimalDualPoint],
) -> Iterator[tuple[PrimalDualPoint, str]]:
    """Points close to a solution and how they were reached: with a damped wall (P6), along the central path (P7).

    Parameters
    ----------
    problem : ContactProblem
        What is solved.
    damped : callable
        The same with a damping of the wall.
    start : callable
        The assembled pack at a barrier.
    """
    run = current_run()
    yield from marches(damped, start)
    for barrier, weight, steps in PATHS:
        end, ends, options = None, (barrier, PATH_END), PathOptions(weight=weight, steps=steps)
        try:
            end = follow_central_path(problem, start(barrier), ends, run.film_solver, options)
        except SingularMatrixError as failure:
            run.note("central path", outcome=str(failure))
        run.note("central path", first_barrier=barrier, outcome="lost" if end is None else "followed")
        if end is not None:
            yield end, "followed the central path through its folds"


def marches(
    damped: Callable[[float], ContactProblem], start: Callable[[float], PrimalDualPoint]
) -> Iterator[tuple[PrimalDualPoint, str]]:
    """Where marches with a damped wall come to rest (P6), in the order of trial; all as in `slower_ways`."""
    for damping, barrier in MARCHES:
        rests = marched_to_rest(damped(damping), start(barrier))
        if rests is not None:
            yield rests, MARCHED


def marched_to_rest(damped: ContactProblem, start: PrimalDualPoint) -> PrimalDualPoint | None:
    """Where a march with a damped wall comes to rest; None if it does not."""
    run = current_run()
    try:
        watch = run.watch("damped wall", reached(GOALS[0]))
        point, found = interior_point(damped, start, run.film_solver, MARCH, watch)
    except SingularMatrixError as failure:
        run.note("damped wall", outcome=str(failure))
        return None
    return point if found else None


LIMIT_OF_LENGTH = (
    "the limit of a long bearing (2-D, continuous edges) need not have an equilibrium that this search reaches: "
    "`solve` also follows bearings that grow longer, at one position; or take the length into account, "
    'model.kind = "3d", or vent the petals\' edges, model.edges = "ambient"'
)
"""Advice of analyses under a load and along curves where the film has no ends: only `solve` lengthens (F6c)."""


def nothing_found(*, endless: bool = False) -> ConvergenceError:
    """The error of a search that came to nothing, with its history; `endless` where the film has no ends."""
    return ConvergenceError(
        "no equilibrium found: film, petals and contacts did not converge from any start",
        history=current_run().history,
        advice=LIMIT_OF_LENGTH
        if endless
        else "refine the grid, lower the eccentricity or approach it along a curve; extreme preload (thick or short "
        "petals, a clamped mount with a steep root) makes equilibria that switch from node to node",
    )


def attempt(problem: CoupledProblem, barrier: float) -> Solution | None:
    """Solve from the assembled pack at one barrier; None if that leads nowhere."""
    path = f"interior point from the assembled pack, barrier {barrier:g}"
    if not problem.layout.n_wall:
        return over_rigid_wall(problem)
    try:
        return finish(problem, assembled(problem, barrier), path)
    except SingularMatrixError as failure:
        current_run().note("film", outcome=str(failure))
        return None


def over_rigid_wall(problem: CoupledProblem) -> Solution | None:
    """The film alone, from ambient pressure: nothing moves and nothing touches."""
    run, start = current_run(), (problem.layout.ambient(np.zeros(0)), np.zeros(len(problem.weight), dtype=bool))
    contacts, outcome = solve_contacts(problem, start, run.film_solver, FILM_ALONE)
    run.note("film", outcome=outcome.value)
    return from_contacts(problem, contacts, "Newton from ambient pressure")


def finish(
    problem: CoupledProblem, start: PrimalDualPoint, path: str, options: InteriorOptions | None = None
) -> Solution | None:
    """Drive the barrier down from `start`; read the active contacts as soon as they show, and solve on them exactly."""
    point, numbers, run = start, options or InteriorOptions(), current_run()
    lengths: list[float] = []
    for goal in GOALS:
        numbers = replace(numbers, least_barrier=0.1 * goal)
        watch = run.watch("film", reached(goal, lengths))
        point, found = interior_point(problem, point, run.film_solver, numbers, watch)
        numbers = replace(numbers, march=False)
        if not found:
            return None
        x, touching = contact_set(problem, point, run.film_solver)
        contacts, outcome = solve_contacts(problem, (x, touching), run.film_solver)
        run.note("contacts", outcome=outcome.value, touching=int(touching.sum()))
        answer = from_contacts(problem, contacts, path) or without_pulls(problem, contacts, path)
        if answer is not None:
            break
    else:
        answer = from_point(problem, point, path)
    return None if answer is None else replace(answer, shortest_step=min(lengths), step_count=len(lengths))


def without_pulls(problem: CoupledProblem, contacts: ActiveContacts | None, path: str) -> Solution | None:
    """The solution without those contacts that pull; None if none does, or if that is no solution.

    Where rows lose digits, a small pull is told from rounding only once the deflections are refined.
    """
    if contacts is None:
        return None
    state, _ = refine(problem, contacts)
    pulls, run = state.lam < -RESIDUAL_TOLERANCE * problem.weight, current_run()
    if not pulls.any():
        return None
    released, outcome = solve_contacts(problem, (state.x, contacts.active & ~pulls), run.film_solver)
    run.note("contacts", outcome=outcome.value, released=int(pulls.sum()))
    return from_contacts(problem, released, path)


def reached(goal: float, lengths: list[float] | None = None) -> Callable[[InteriorStep], bool]:
    """A stopping criterion: the barrier `goal`, with residuals to match. Lengths of steps are added to `lengths`."""

    def look(step: InteriorStep) -> bool:
        if lengths is not None:
            lengths.append(step.length)
        residual = max(1e2 * goal, 0.5 * RESIDUAL_TOLERANCE)
        return step.barrier < goal and step.residual < residual and step.infeasibility < residual

    return look
