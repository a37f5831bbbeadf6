"""The journal's position under a load: film, petals, contacts and journal in one Newton.

From nothing through the interior point, with the position among its unknowns. From a neighbour, and to finish, on the
active contacts with the position bordered: one factorisation a step serves the state and every displacement.

A foil pack that the load has bottomed out has three active contacts at one angle, between journal, petals and bushing,
where two determine the third: no contact set determines the reactions. The interior point solves it all the same, and
packs too where it is undecided which of many contacts without force are active.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.cold_start import GOALS, nothing_found, reached, slower_ways
from petalfoil.equilibrium.continuation import predicted, widened
from petalfoil.equilibrium.other_grids import carried, grids, points_from
from petalfoil.equilibrium.pack_at_rest import assembled
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts, unrefined
from petalfoil.solvers.contact_equations import (
    ContactEquations,
    ContactOptions,
    Correction,
    Step,
    StepVerdict,
)
from petalfoil.solvers.contact_newton import ActiveContacts, contact_newton
from petalfoil.solvers.interior_point import InteriorOptions, InteriorStep, contact_set, interior_point
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, Border, ContactProblem, PrimalDualPoint
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.damped import DampedBalance
from petalfoil.system.loaded import LoadedProblem, load_scale

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BARRIERS = (3.0, 30.0, 0.3)
"""Barriers at which film and load join the assembled foil pack."""

FORCE_TOLERANCE = 1e-9
"""Largest unbalanced force over the load."""

SHARES = (0.25, 0.0625, 0.015625)
"""Fractions of a load from which all of it is reached: for loads tens of times the bearing force of the film."""

BALANCING = ContactOptions(steps=1, rounded=1e-6)
"""A residual of gaps closed over slivers of cells stagnates below 1e-6."""

WARM = replace(BALANCING, tangents=8)
"""Active contacts that lead on from a neighbour do so in a few steps."""

RELOADED = replace(WARM, borrow=True, steps=8)
"""The tangent of a neighbour at the same speed serves as long as its steps contract."""

MOST_FILMS = 10.0
"""Longest move of the journal in a step, in reference films (100 um for petals, ten clearances for a plain bore)."""

CORRECTIONS = 3
"""Refinements of a balance: the second is for loads much smaller than the forces that cancel around the journal."""

# ---------------------------------------------------------------------------------------------- from nothing


def balance_cold(problem: CoupledProblem, load: Array) -> Solution:
    """Solve from nothing at the load `load` (n_position,) over the unit of force.

    Raises
    ------
    ConvergenceError
        No position was found.
    """
    ways = (from_nothing, loaded_gradually, by_slower_ways, by_other_grids)
    found = next(filter(None, (way(problem, load) for way in ways)), None)
    if found is None:
        raise nothing_found(endless=problem.endless)
    return found


def from_nothing(problem: CoupledProblem, load: Array) -> Solution | None:
    """Cold starts, each barrier in turn; None if none leads to a balance."""
    for barrier in BARRIERS:
        try:
            found = through_interior(problem, assembled(problem, barrier), load)
        except SingularMatrixError as failure:
            current_run().note("balance", outcome=str(failure))
            continue
        if found is not None:
            return found
    return None


def loaded_gradually(problem: CoupledProblem, load: Array) -> Solution | None:
    """Balance a fraction of the load, then more and more of it; None if that leads nowhere, or there is no load."""
    if not np.any(load):
        return None
    for share in SHARES:
        known = from_nothing(problem, share * load)
        while known is not None and share < 1.0:
            share = min(1.0, 2.0 * share)
            known = from_neighbour(known, problem, share * load)
        if known is not None:
            return known
    return None


def by_slower_ways(problem: CoupledProblem, load: Array) -> Solution | None:
    """The balance of a march with a damped wall and journal, or along the central path; None if they lead nowhere."""
    if not problem.layout.n_wall:
        return None
    whole = LoadedProblem(problem, load)

    def start(barrier: float) -> PrimalDualPoint:
        pack = assembled(problem, barrier)
        return replace(pack, x=np.append(pack.x, problem.displacement))

    points = slower_ways(whole, lambda damping: DampedBalance.of(problem, load, damping), start)
    return first_balance(whole, (point for point, _ in points))


def by_other_grids(problem: CoupledProblem, load: Array) -> Solution | None:
    """The balance to which that on another grid leads (a film without ends); None if none does."""
    for other in grids(problem):
        known = from_nothing(other, load * problem.layout.scales.force / other.layout.scales.force)
        if known is None:
            continue
        moved = problem.at(displacement=known.problem.displacement)
        z = np.append(carried(known, moved), moved.displacement)
        whole, damped = LoadedProblem(moved, load), partial(DampedBalance.of, moved, load)
        found = first_balance(whole, points_from(whole, damped, z))
        if found is not None:
            return found
    return None


def first_balance(whole: LoadedProblem, points: Iterator[PrimalDualPoint]) -> Solution | None:
    """The balance of the first of some points whence the interior point leads to one; None if none does."""
    for point in points:
        moved, x = whole.split(point.x)
        try:
            found = through_interior(moved, replace(point, x=x), whole.load)
        except SingularMatrixError as failure:
            current_run().note("balance", outcome=str(failure))
            continue
        if found is not None:
            return found
    return None


def through_interior(problem: CoupledProblem, start: PrimalDualPoint, load: Array) -> Solution | None:
    """The interior point with the position among its unknowns, then Newton on the active contacts; None if it fails."""
    whole, run = LoadedProblem(problem, load), current_run()
    point = replace(start, x=np.append(start.x, problem.displacement))
    for goal in GOALS:
        options = InteriorOptions(least_barrier=0.1 * goal)
        point, found = interior_point(whole, point, run.film_solver, options, run.watch("balance", reached(goal)))
        if not found:
            return None
        z, active = contact_set(whole, point, run.film_solver)
        moved, x = whole.split(z)
        balance = newton(moved, (x, active), load)
        if balance is not None:
            return balance
    return of_interior(whole, point)


# ---------------------------------------------------------------------------------------------- from a neighbour


def rebalance(known: Solution, problem: CoupledProblem, load: Array) -> Solution:
    """The balance of `problem` (at another speed) or of another load, from a neighbour that is known.

    Raises
    ------
    ConvergenceError
        Nothing was found, not even from nothing.
    """
    centred = problem.at(displacement=np.zeros(problem.layout.n_position))
    return from_neighbour(known, problem, load) or balance_cold(centred, load)


def from_neighbour(known: Solution, problem: CoupledProblem, load: Array) -> Solution | None:
    """By tangent and active contacts of `known`, else by the interior point from there; None if neither leads on."""
    here = problem.at(displacement=known.problem.displacement)
    x = predicted(known, here)
    found = newton(here, (x, known.active), load, WARM)
    if found is not None:
        return found
    try:
        return through_interior(here, widened(here, x, known.lam), load)
    except SingularMatrixError as failure:
        current_run().note("balance", outcome=str(failure))
        return None


def reloaded(known: Solution, load: Array) -> Solution | None:
    """The balance of a load near that of `known`, at its speed: the last tangent foretells the state and serves on.

    None where it does not lead there.
    """
    if known.contacts is None or known.load is None:
        return None
    tangent = known.contacts.tangent
    de = np.linalg.solve(tangent.gradient, known.load - load)
    moved = known.problem.at(displacement=known.problem.displacement + de)
    x = predicted(known, moved, tangent.units @ de)
    return newton(moved, (x, known.active), load, RELOADED, tangent)


# ---------------------------------------------------------------------------------------------- Newton


@dataclass(frozen=True)
class LoadedEquations(ContactEquations):
    """The variant under a load: the journal's position is bordered, forces on the journal balance (C5)."""

    problem: CoupledProblem
    load: Array

    @property
    def border(self) -> Border:
        """How the journal's position enters."""
        return self.problem.border

    @property
    def border_stiffness(self) -> Array:
        """Nothing but film and contacts resists the journal."""
        return np.zeros((len(self.load), len(self.load)))

    def at(self, b: Array) -> ContactProblem:
        """The coupled system at a displacement."""
        return self.problem.at(displacement=b)

    def imbalance(self, x: Array, lam: Array, b: Array) -> Array:
        """Force of film, contacts and load on the journal."""
        return self.problem.journal_force(x, lam) + self.load

    def longest_step(self, at: tuple[Array, Array], correction: Correction) -> float:
        """Pressures stay positive, and the journal moves by a few films only."""
        farthest = MOST_FILMS / max(float(np.linalg.norm(correction.b)), 1e-300)
        return min(super().longest_step(at, correction), farthest)

    def verdict(self, step: Step, options: ContactOptions) -> StepVerdict:
        """By the residual; and the forces must balance."""
        verdict = super().verdict(step, options)
        if verdict is not StepVerdict.CONVERGED or step.after is None:
            return verdict
        unbalanced = np.linalg.norm(self.imbalance(step.after.x, step.after.lam, step.after.b))
        return verdict if unbalanced <= FORCE_TOLERANCE * load_scale(self.load) else StepVerdict.RENEW


def newton(
    problem: CoupledProblem,
    start: tuple[Array, Mask],
    load: Array,
    options: ContactOptions = BALANCING,
    tangent: BorderedTangent | None = None,
) -> Solution | None:
    """Newton from unknowns and active contacts, and from the position of `problem`; None if it fails."""
    (x, active), run = start, current_run()
    begin = x, problem.displacement, active
    contacts, outcome = contact_newton(LoadedEquations(problem, load), begin, run.film_solver, options, tangent)
    run.note("contacts", outcome=outcome.value)
    return None if contacts is None else polished(problem, contacts, load)


def polished(problem: CoupledProblem, contacts: ActiveContacts, load: Array) -> Solution | None:
    """The refined state; the position follows where the refined film pushes otherwise. No factorisation."""
    state, tangent = contacts.state, contacts.tangent
    here, best = problem.at(displacement=state.b), None
    for _ in range(CORRECTIONS):
        found = from_contacts(here, replace(contacts, state=state), "balanced with the load")
        if found is None:
            break
        found = replace(found, load=load)
        if best is None or found.force_residual < best.force_residual:
            best = found
        if found.force_residual <= FORCE_TOLERANCE:
            break
        de = np.linalg.solve(tangent.gradient, -found.unbalanced)
        here = here.at(displacement=here.displacement + de)
        state = replace(state, x=found.x + tangent.units @ de, lam=found.lam)
    return best


# ---------------------------------------------------------------------------------------------- without contact set

LAST_GOALS = (1e-13, 1e-14, 1e-15, 1e-16)
"""Barriers that the interior point's own solution is followed to: pairs off the path need decades more than that."""

LAST_STEPS = InteriorOptions(max_steps=4)
"""Newton's answer loses digits at such barriers: more steps gain nothing."""

BOTTOMED_OUT = "interior point; the pack is bottomed out between journal and bushing"
UNDECIDED = "interior point; undecided which contacts without force are active"
"""How such a solution was reached, by what it is."""


def of_interior(whole: LoadedProblem, point: PrimalDualPoint) -> Solution | None:
    """The interior point's own solution: it goes on from `point` until gap or reaction of every pair has vanished."""
    run = current_run()
    look = run.watch("without contact set", lambda step: False)

    def finished(at: PrimalDualPoint, step: InteriorStep) -> bool:
        return look(at, step) or without_slacks(whole, at).residual <= RESIDUAL_TOLERANCE

    for goal in LAST_GOALS:
        options = replace(LAST_STEPS, least_barrier=goal)
        point, found = interior_point(whole, point, run.film_solver, options, finished)
        if found:
            return without_slacks(whole, point)
    return None


def without_slacks(whole: LoadedProblem, point: PrimalDualPoint) -> Solution:
    """The state of `point`, its slacks dropped."""
    problem, x = whole.split(point.x)
    found = unrefined(problem, x, point.lam, UNDECIDED)
    return replace(found, load=whole.load, solution_path=BOTTOMED_OUT if found.bottomed_out else UNDECIDED)
