"""Equilibria that are not alone: stability, branches, jumps."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import scipy.linalg as la
from numpy.testing import assert_allclose

from petalfoil.analysis import equilibrium, load_curve
from petalfoil.case import Case
from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.branches import fingerprint
from petalfoil.equilibria.cold import solve_cold
from petalfoil.equilibria.stability import leading_eigenvalue
from petalfoil.equilibria.warm import settle
from petalfoil.equilibria.work import Work
from petalfoil.problem.build import build_problem
from petalfoil.solvers.ties import tie
from tests.cases import case
from tests.random_packages import random_case

SEED = 2024


def drawn(number: int) -> Case:
    """The `number`-th random package of the seed."""
    rng = np.random.default_rng(SEED)
    return next(itertools.islice((random_case(rng) for _ in range(number + 1)), number, None))


def dense_leading(answer: Answer) -> complex:
    """Rightmost finite eigenvalue of `J u = -s M u` by the QZ algorithm on the reduced pencil."""
    problem = answer.problem
    line, none = problem.linearize(answer.x), np.zeros(len(problem.weight))
    ties = tie(problem.G, answer.in_contact)
    J = ties.reduce(line.matrix(none)).toarray()
    M = ties.reduce((line.matrix(none, 1.0) - line.matrix(none)).tocsc()).toarray()
    s = la.eigvals(-J, M)
    s = s[np.isfinite(s) & (np.abs(s) < 1e6)]
    return complex(s[np.argmax(s.real)])


@pytest.mark.parametrize("number", [4, 88])
def test_the_leading_eigenvalue_of_unstable_equilibria(number: int) -> None:
    """Case 4's cold start lands on an unstable equilibrium, case 88's too: the dense spectrum agrees."""
    coarse = drawn(number).replace(**{"model.cells_per_pitch": 24})
    answer = solve_cold(build_problem(coarse), Work())
    exact, found = dense_leading(answer), leading_eigenvalue(answer, Work())
    assert (exact.real > 0.0) == (found.real > 0.0)
    if exact.real > 0.0:
        assert_allclose(found.real, exact.real, rtol=2e-2)


def test_a_stable_equilibrium_is_called_so() -> None:
    answer = solve_cold(build_problem(case("paper_n8", **{"model.cells_per_pitch": 16})), Work())
    assert dense_leading(answer).real < 0.0
    assert leading_eigenvalue(answer, Work()).real < 0.0


def test_an_unstable_equilibrium_is_left_for_a_stable_one() -> None:
    problem = build_problem(drawn(88))
    unstable = solve_cold(problem, Work())
    assert leading_eigenvalue(unstable, Work()).real > 0.0
    rested = settle(unstable, Work())
    assert rested is not None
    assert leading_eigenvalue(rested, Work()).real < 0.0
    before, after = fingerprint(unstable), fingerprint(rested)
    assert np.max(np.abs(after - before)) > 1e-3 * before[0]


def test_solve_reports_the_stable_branch_and_that_there_are_more() -> None:
    record = equilibrium.run(drawn(88))
    assert record.scalars["stable"]
    assert record.scalars["branches_known"] >= 2  # type: ignore[operator]
    assert "rest" in str(record.scalars["branch"])


def test_a_curve_reports_its_jump() -> None:
    """The branch of case 4 folds between 114.3 and 114.9 um: its leading eigenvalue goes to zero there, and the next
    point lies on another branch, with 3.5 times the torque."""
    package = drawn(4)
    room = package.replace(**{"operation.eccentricity": (0.0, 0.0)}).room_left
    far = 0.6 * room
    start, end = far * 9.0 / 12.0, far * 10.0 / 12.0
    way = np.concatenate([np.linspace(0.0, start, 6), np.linspace(start, end, 25)[1:16]])
    records = list(load_curve.iterate(package, way))
    jumps = [number for number, record in enumerate(records) if record.scalars["jump"]]
    assert len(jumps) == 1
    fold = jumps[0]
    rates = np.array([float(record.scalars["growth_rate"]) for record in records])
    torque = np.array([float(record.scalars["friction_torque"]) for record in records])
    squares = np.diff(rates[fold - 8 : fold] ** 2)  # at a fold the eigenvalue goes as the root of the distance
    assert_allclose(squares, squares.mean(), rtol=0.06)
    assert rates[fold - 1] ** 2 < 0.6 * -squares.mean()  # and is less than a step from zero
    assert torque[fold] > 3.0 * torque[fold - 1]
    assert np.max(np.abs(np.diff(torque[fold - 8 : fold]))) < 0.02 * torque[fold - 1]
    assert all(record.scalars["residual"] <= 1e-8 for record in records)  # type: ignore[operator]


def test_the_paper_s_curves_do_not_jump() -> None:
    for name in ("paper_n6", "paper_n8", "paper_n10"):
        records = list(load_curve.iterate(case(name, **{"model.cells_per_pitch": 32}), np.linspace(0.0, 280e-6, 8)))
        assert not any(record.scalars["jump"] for record in records)
        assert all(record.scalars["stable"] for record in records)
