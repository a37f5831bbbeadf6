"""Newton's method on active contacts: the loop, its variants, and what it refuses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_equations import (
    ContactEquations,
    ContactOptions,
    ContactOutcome,
    ContactState,
    StepVerdict,
    evaluate,
)
from petalfoil.solvers.contact_newton import ActiveContacts, contact_newton, corrected, factorise, solve_contacts
from petalfoil.solvers.problem import POSITIVE_FRACTION, Border, ContactProblem, Linearized
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.sparsity import SparseRows
from tests.unit.solvers.problems import CELLS, OBSTACLE, Spring, string, string_answer
from tests.verification.shell_helpers import ElasticProblem, rows_of

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
OPEN = np.zeros(CELLS - 1, dtype=bool)


def solve(
    problem: ContactProblem, x: Array, active: Mask, tangents: int = 12
) -> tuple[ActiveContacts | None, ContactOutcome, int]:
    solver = LinearSolver()
    found, outcome = solve_contacts(problem, (x, active), solver, ContactOptions(tangents=tangents))
    return found, outcome, solver.counter.factorizations


# ---------------------------------------------------------------------------------------------- the plain variant


def test_string_on_its_own_contacts() -> None:
    w, lam = string_answer()
    found, outcome, count = solve(string(), np.zeros(CELLS - 1), lam > 0.0)
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    assert count == 1
    assert_allclose(found.x, w, atol=1e-14)
    assert_allclose(found.lam, lam, atol=1e-11)


@pytest.mark.parametrize("start", ["all", "shifted", "ends"])
def test_string_from_other_contacts(start: str) -> None:
    w, lam = string_answer()
    active = {"all": np.ones(CELLS - 1, dtype=bool), "shifted": np.roll(lam > 0.0, 3), "ends": lam == 0.5}[start]
    found, outcome, _ = solve(string(), np.zeros(CELLS - 1), active, tangents=30)
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    assert_allclose(found.x, w, atol=1e-14)
    assert np.array_equal(found.active, lam > 0.0)


def test_a_solution_already_there_takes_the_one_tangent_that_refinement_needs() -> None:
    w, lam = string_answer()
    found, _, count = solve(string(), w, lam > 0.0)
    assert found is not None
    assert count == 1
    reduced = found.constraints.reduce(string().linearize(w).matrix(np.zeros(CELLS - 1)))
    ones = np.ones(found.constraints.n_free)
    assert_allclose(reduced @ found.tangent.tangent.factor.solve(ones), ones, rtol=1e-10)


def test_the_tangent_of_a_neighbour_shows_where_its_contacts_are_wrong() -> None:
    known, _, _ = solve(string(), np.zeros(CELLS - 1), string_answer()[1] > 0.0)
    assert known is not None
    nearer = string(distance=0.5 * OBSTACLE)
    counts, found = [], []
    for before in (None, known.tangent):
        solver = LinearSolver()
        contacts, outcome = solve_contacts(nearer, (known.x, known.active), solver, ContactOptions(), before)
        assert outcome is ContactOutcome.CONVERGED
        assert contacts is not None
        counts.append(solver.counter.factorizations)
        found.append(contacts)
    assert counts[1] == counts[0] - 1
    assert np.array_equal(found[0].active, found[1].active)
    assert not np.array_equal(found[1].active, known.active)
    assert_allclose(found[1].x, found[0].x, rtol=1e-12)


def test_sets_that_return() -> None:
    """The circulant of Ben Gharbia and Gilbert (2012): a P-matrix on which changed sets cycle for ever."""
    alpha = 1.2
    K = sp.csr_array([[1.0, 0.0, alpha], [alpha, 1.0, 0.0], [0.0, alpha, 1.0]])
    problem = ElasticProblem(K, np.ones(3), rows_of(3, ([0, 1, 2], 1.0)), np.zeros(3), np.ones(3))
    found, outcome, count = solve(problem, np.zeros(3), np.array([False, True, True]))
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    assert count <= 6
    assert_allclose(found.x, 1.0 / (1.0 + alpha), rtol=1e-12)


def test_steps_run_out() -> None:
    found, outcome, count = solve(string(), np.zeros(CELLS - 1), np.arange(CELLS - 1) == 5, tangents=1)
    assert found is None
    assert outcome is ContactOutcome.STEPS
    assert count == 1


def test_a_chain_held_at_both_ends() -> None:
    found, outcome, _ = solve(pressed(), np.zeros(2), np.ones(3, dtype=bool))
    assert found is None
    assert outcome is ContactOutcome.OVERDETERMINED


def test_far_below_zero() -> None:
    _, outcome, _ = solve(string(), np.full(CELLS - 1, 0.6), OPEN)
    assert outcome is ContactOutcome.PENETRATED


def test_a_matrix_without_inverse() -> None:
    loose = ElasticProblem(sp.csr_array((1, 1)), np.ones(1), rows_of(1, ([0], -1.0)), np.ones(1), np.ones(1))
    _, outcome, _ = solve(loose, np.zeros(1), np.array([False]))
    assert outcome is ContactOutcome.SINGULAR


def test_film_that_reads_its_gap() -> None:
    """`x = c / (1 - x)`: the smaller root of `x (1 - x) = c`."""
    found, outcome, count = solve(Spring(0.1), np.array([0.3]), np.array([False]))
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    assert_allclose(found.x, 0.5 - np.sqrt(0.25 - 0.1), rtol=1e-8)
    assert count < 4  # steps that share a tangent save one


def test_positive_unknowns_stay_positive() -> None:
    """Newton from 0.6 points below zero; it goes a fraction of the way there."""
    equations, x = ContactEquations(Spring(0.1)), np.array([0.6])
    state = state_of(equations, x, np.array([False]))
    tangent = factorise(equations, state, (state.x, state.b), LinearSolver())
    correction = corrected(equations, state, tangent)
    assert float((x + correction.x)[0]) < 0.0
    length = equations.step_length(state, correction)
    assert_allclose(x + length * correction.x, (1.0 - POSITIVE_FRACTION) * x, rtol=1e-12)


def state_of(equations: ContactEquations, x: Array, active: Mask) -> ContactState:
    """The iterate at `x` with contacts `active`."""
    constraints = constrain(equations.problem.G, active, equations.stops)
    return evaluate(equations, (x, np.zeros(equations.border.size)), ContactOptions(), constraints)


# ---------------------------------------------------------------------------------------------- bordered unknowns


@dataclass(frozen=True)
class Level:
    """A problem whose gaps are all wider by `b`."""

    base: ElasticProblem
    b: float

    @property
    def G(self) -> SparseRows:
        """As before."""
        return self.base.G

    @property
    def acting(self) -> SparseRows:
        """As before."""
        return self.base.acting

    @property
    def weight(self) -> Array:
        """As before."""
        return self.base.weight

    @property
    def elimination_key(self) -> None:
        """None."""

    @property
    def positive(self) -> slice:
        """None."""
        return slice(0, 0)

    def gaps(self, x: Array) -> Array:
        """Wider by `b`."""
        return self.base.gaps(x) + self.b

    def admits(self, x: Array) -> bool:
        """Always."""
        return True

    def linearize(self, x: Array, shift: Array | None = None) -> Linearized:
        """As before."""
        return self.base.linearize(x, shift)


@dataclass(frozen=True)
class Floating(ContactEquations):
    """A string against an obstacle that floats at the level where the contacts carry a given load."""

    problem: ElasticProblem
    load: float
    spring: float = 0.0
    """Stiffness that holds the obstacle at level zero besides."""
    stop: bool = False

    @property
    def border(self) -> Border:
        """Gaps by the level, and the contacts' force on the obstacle."""
        return Border(np.ones((len(self.problem.rest), 1)), np.zeros((1, 0)), slice(0, 0))

    @property
    def border_stiffness(self) -> Array:
        """The spring's."""
        return np.full((1, 1), self.spring)

    @property
    def stops(self) -> slice | None:
        """Anything may be a stop, if stops are allowed."""
        return slice(0, None) if self.stop else None

    def at(self, b: Array) -> ContactProblem:
        """The string with its obstacle at a level."""
        return Level(self.problem, float(b[0]))

    def imbalance(self, x: Array, lam: Array, b: Array) -> Array:
        """Force of the contacts on the obstacle, its load and its spring."""
        return np.array([lam.sum() - self.load - self.spring * b[0]])

    def verdict(self, step: object, options: ContactOptions) -> StepVerdict:
        """The obstacle must be in balance too."""
        verdict = super().verdict(step, options)
        left = self.imbalance(step.after.x, step.after.lam, step.after.b) if step.after is not None else np.ones(1)
        return verdict if verdict is not StepVerdict.CONVERGED or abs(left[0]) < 1e-10 else StepVerdict.RENEW


def test_an_obstacle_that_floats_on_its_contacts() -> None:
    """Held at the level that the string at rest has, it carries what it carried there."""
    w, lam = string_answer()
    equations = Floating(string(distance=0.7 * OBSTACLE), load=float(lam.sum()))
    start = np.zeros(CELLS - 1), np.zeros(1), lam > 0.0
    found, outcome = contact_newton(equations, start, LinearSolver(), ContactOptions(tangents=30))
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    assert_allclose(found.state.b, 0.3 * OBSTACLE, rtol=1e-10)
    assert_allclose(found.x, w, atol=1e-13)
    assert np.array_equal(found.active, lam > 0.0)


def test_the_bordered_tangent_is_the_derivative_of_a_solution() -> None:
    """`units` and `gradient` against two solutions at levels apart."""
    _, lam = string_answer()
    ends = []
    for level in (0.0, 1e-6):
        problem = Level(string(), level)
        found, _ = solve_contacts(problem, (np.zeros(CELLS - 1), lam > 0.0), LinearSolver())
        assert found is not None
        ends.append(found)
    equations = Floating(string(), load=0.0)
    state = state_of(equations, ends[0].x, ends[0].active)
    tangent = factorise(equations, state, (state.x, state.b), LinearSolver())
    assert_allclose(tangent.units[:, 0], (ends[1].x - ends[0].x) / 1e-6, rtol=1e-6)
    assert_allclose(tangent.gradient[0, 0], (ends[1].lam - ends[0].lam).sum() / 1e-6, rtol=1e-6)


def test_stops_carry_what_moves_the_chain_as_a_whole() -> None:
    """Two nodes between two walls, every gap active; the second wall is pushed by 3 against a spring of 2."""
    equations = Floating(pressed(), load=3.0, spring=2.0, stop=True)
    options = ContactOptions(tangents=30, revise_early=False, borrow=True, deepest=-np.inf)
    start = np.zeros(2), np.zeros(1), np.ones(3, dtype=bool)
    found, outcome = contact_newton(equations, start, LinearSolver(), options)
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    problem = Level(equations.problem, float(found.state.b[0]))
    gaps = problem.gaps(found.x)
    assert gaps.min() >= -1e-8
    assert found.lam.min() >= -1e-8
    assert_allclose(gaps * found.lam, 0.0, atol=1e-8)
    assert_allclose(problem.linearize(found.x).residual, problem.G.T @ found.lam, atol=1e-10)


def pressed() -> ElasticProblem:
    """Two nodes on unit springs between two walls, each a little way from the next."""
    G, rest = sp.csr_array([[1.0, 0.0], [-1.0, 1.0], [0.0, -1.0]]), np.array([0.1, 0.2, 0.3])
    return ElasticProblem(sp.csr_array(np.eye(2)), np.zeros(2), G, rest, np.ones(3))


# ---------------------------------------------------------------------------------------------- lagged terms


@dataclass(frozen=True)
class Lagging(ContactEquations):
    """A string whose load grows with the reactions, a correction late."""

    problem: ElasticProblem
    share: float
    normal: float = 0.0

    def renewed(self, state: ContactState, before: ContactState, count: int) -> Self:
        """The load by the reactions of `state`."""
        total = float(state.lam.sum())
        loaded = replace(self.problem, force=np.ones(CELLS - 1) * (1.0 + self.share * total / CELLS))
        return replace(self, problem=loaded, normal=total)

    def verdict(self, step: object, options: ContactOptions) -> StepVerdict:
        """The load must agree with the reactions."""
        verdict = super().verdict(step, options)
        if verdict is StepVerdict.CONVERGED and abs(step.after.lam.sum() - self.normal) > 1e-10:
            return StepVerdict.RENEW
        return verdict


def test_terms_that_follow_the_reactions_agree_with_them_in_the_end() -> None:
    equations = Lagging(string(), 0.3)
    start = np.zeros(CELLS - 1), np.zeros(0), string_answer()[1] > 0.0
    found, outcome = contact_newton(equations, start, LinearSolver(), ContactOptions(tangents=60, revise_early=False))
    assert outcome is ContactOutcome.CONVERGED
    assert found is not None
    total = found.lam.sum()
    again = replace(string(), force=np.ones(CELLS - 1) * (1.0 + 0.3 * total / CELLS))
    direct, _ = solve_contacts(again, (found.x, found.active), LinearSolver())
    assert direct is not None
    assert_allclose(direct.lam.sum(), total, rtol=1e-9)
    assert total > 1.05 * string_answer()[1].sum()


# ---------------------------------------------------------------------------------------------- exchanged contacts


@pytest.mark.parametrize("change", ["released", "added", "both"])
def test_exchanged_contacts_are_as_good_as_a_factorisation(change: str) -> None:
    """Settling against a residual, and the bordered unit, with the factor of other contacts."""
    problem, active = string(), string_answer()[1] > 0.0
    other = active.copy()
    if change != "added":
        other[np.flatnonzero(active)[[0, -1]]] = False
    if change != "released":
        other[np.flatnonzero(active)[0] - 3] = True
    residual, by_level = np.sin(np.arange(CELLS - 1.0)), np.ones(CELLS - 1)
    border, line = Border(by_level[:, None], np.zeros((1, 0)), slice(0, 0)), problem.linearize(np.zeros(CELLS - 1))
    both = [tangent(problem, border, line, one) for one in (active, other)]
    exchanged = both[0].exchanged((problem.G, problem.acting), other)
    assert exchanged is not None
    assert not both[0].serves(other)
    assert exchanged.serves(other)
    for one, two in zip(exchanged.respond(residual, by_level), both[1].respond(residual, by_level), strict=True):
        assert_allclose(one, two, atol=1e-9)
    assert_allclose(exchanged.units, both[1].units, atol=1e-9)
    assert_allclose(exchanged.gradient, both[1].gradient, rtol=1e-9)


def test_too_many_exchanged_contacts_ask_for_a_factorisation() -> None:
    problem, none = string(), OPEN
    border = Border(np.ones((CELLS - 1, 1)), np.zeros((1, 0)), slice(0, 0))
    known = tangent(problem, border, problem.linearize(np.zeros(CELLS - 1)), none)
    assert known.exchanged((problem.G, problem.acting), np.arange(CELLS - 1) < 17) is None
    assert known.exchanged((problem.G, problem.acting), np.arange(CELLS - 1) < 3) is not None


def tangent(problem: ElasticProblem, border: Border, line: Linearized, active: Mask) -> BorderedTangent:
    """The bordered tangent on some contacts."""
    constraints, matrix = constrain(problem.G, active), line.matrix(np.zeros(len(active)))
    return BorderedTangent.at(
        Tangent(matrix, constraints, constraints.factor(matrix, LinearSolver(), None)), border, line
    )
