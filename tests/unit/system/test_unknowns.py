"""Named blocks: their places, the matrix over them, and a field that is added without touching another file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import follow
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE, BlockEntries, BlockPattern, FieldRows, Unknowns
from tests.cases import case
from tests.contract.taylor import assert_tangent

Array = NDArray[np.float64]
Index = NDArray[np.intp]


def test_blocks_follow_each_other() -> None:
    unknowns = Unknowns({"a": 2, "none": 0, "b": 3})
    assert unknowns.n == 5
    assert (unknowns["a"], unknowns["none"], unknowns["b"]) == (slice(0, 2), slice(2, 2), slice(2, 5))
    joined = unknowns.join({"b": 7.0, "a": np.array([1.0, 2.0]), "none": 0.0})
    assert joined.tolist() == [1.0, 2.0, 7.0, 7.0, 7.0]
    assert unknowns.extended(c=1)["c"] == slice(5, 6)
    with pytest.raises(KeyError):
        unknowns.join({"a": 0.0, "b": 0.0})


def test_a_matrix_over_blocks_is_the_sum_of_its_entries() -> None:
    unknowns, rng = Unknowns({"a": 4, "b": 3}), np.random.default_rng(3)
    dense, entries, values = np.zeros((7, 7)), [], []
    for row_block, column_block in (("a", "a"), ("a", "b"), ("b", "a"), ("b", "b"), ("a", "b")):
        count = 6
        rows = rng.integers(unknowns.sizes[row_block], size=count)
        cols = rng.integers(unknowns.sizes[column_block], size=count)
        entries.append(BlockEntries(row_block, column_block, rows, cols))
        values.append(rng.normal(size=count))
        first = unknowns[row_block].start, unknowns[column_block].start
        np.add.at(dense, (first[0] + rows, first[1] + cols), values[-1])
    pattern = BlockPattern(unknowns, entries)
    assert_allclose(pattern.assemble(values).toarray(), dense, atol=1e-15)
    part = pattern.assemble_part(slice(1, 2), values[1:2]).toarray()
    assert_allclose(part[:4, 4:].sum(), values[1].sum(), rtol=1e-12)
    assert not part[4:].any()


# ---------------------------------------------------------------------------------------------- a field of its own


@dataclass(frozen=True)
class Warmth:
    """A temperature `T = 1 + beta h^2` at every pressure unknown, which adds `epsilon (T - 1)` to its balance."""

    layout: BearingLayout
    beta: float = 0.2
    epsilon: float = 1e-3
    name: str = "temperature"
    initial: float = 1.0

    @property
    def size(self) -> int:
        """As many as pressures."""
        return self.layout.wall.film.n_unknown

    @cached_property
    def nodes(self) -> Index:
        """A film node of each pressure unknown."""
        numbers, first = np.unique(self.layout.wall.film.unknown.ravel(), return_index=True)
        return first[numbers >= 0]

    @cached_property
    def under(self) -> Index:
        """The deflection under it, -1 where the wall does not move."""
        return self.layout.wall.film_unknown.ravel()[self.nodes]

    @property
    def entries(self) -> Sequence[BlockEntries]:
        """Its own rows by itself and by deflection; the balances by it."""
        every, moving = np.arange(self.size), np.flatnonzero(self.under >= 0)
        return (
            BlockEntries(self.name, self.name, every, every),
            BlockEntries(self.name, DEFLECTION, moving, self.under[moving]),
            BlockEntries(PRESSURE, self.name, every, every),
        )

    def at(self, blocks: Mapping[str, Array], film: Array) -> FieldRows:
        """Rows at a state."""
        h, T, one = film.ravel()[self.nodes], blocks[self.name], np.ones(self.size)
        by_h = -2.0 * self.beta * h
        by_film = sp.csr_array((by_h, (np.arange(self.size), self.nodes)), shape=(self.size, film.size))
        return FieldRows(
            residual={self.name: T - 1.0 - self.beta * h**2, PRESSURE: self.epsilon * (T - 1.0)},
            row_scale=one,
            values=(one, by_h[self.under >= 0], self.epsilon * one),
            by_film=by_film,
        )


def warm(name: str, **changes: object) -> CoupledProblem:
    """An example with a temperature."""
    cold = build_problem(case(name, **{"model.cells_per_pitch": 16}, **changes))
    return replace(cold, layout=replace(cold.layout, fields=(Warmth(cold.layout),)))


EXAMPLES = [pytest.param("paper_n8", {}, id="petals"), pytest.param("plain_journal", {"model.kind": "2d"}, id="plain")]


@pytest.mark.parametrize(("name", "changes"), EXAMPLES)
def test_the_tangent_of_a_field(name: str, changes: dict[str, object]) -> None:
    """All rows, by all unknowns and by the slacks that the film reads."""
    problem, rng = warm(name, **changes), np.random.default_rng(5)
    layout = problem.layout
    x = layout.ambient(np.zeros(layout.n_wall))
    x[layout.unknowns[PRESSURE]] += rng.uniform(0.0, 0.5, layout.wall.film.n_unknown)
    shift, direction = np.abs(np.minimum(problem.gaps(x), 0.0)) + 1.0, rng.uniform(-1.0, 1.0, layout.n)
    push = rng.uniform(-1.0, 1.0, len(shift))
    change = problem.linearize(x, shift).matrix(np.zeros(len(shift))) @ direction
    rows = slice(layout.n_wall, layout.n)  # those of the wall are linear
    assert_tangent(lambda t: problem.linearize(x + t * direction, shift).residual[rows], change[rows], 2.0**-6)
    by_slack = problem.linearize(x, shift).slack_derivative(push)
    assert_tangent(lambda t: problem.linearize(x, shift + t * push).residual[rows], by_slack[rows], 2.0**-6)


@pytest.mark.parametrize(("name", "changes"), EXAMPLES)
def test_every_solver_carries_a_field_along(name: str, changes: dict[str, object]) -> None:
    """Cold, to a neighbour, under a load, in a small motion, and its stability: nothing but `fields` knows of it."""
    problem = warm(name, **changes)
    solution = solve_cold(problem)
    unknowns, field = problem.layout.unknowns, problem.layout.fields[0]
    assert isinstance(field, Warmth)

    def temperature_error(x: Array, at: CoupledProblem) -> float:
        h = at.film(x).ravel()[field.nodes]
        return float(np.max(np.abs(x[unknowns["temperature"]] - 1.0 - field.beta * h**2)))

    assert temperature_error(solution.x, problem) < 1e-8
    without = solve_cold(replace(problem, layout=replace(problem.layout, fields=())))
    assert not np.allclose(without.x[problem.positive], solution.x[problem.positive], rtol=0.0, atol=1e-6)

    near = follow(solution, problem.at(displacement=problem.displacement + np.array([0.0, 1e-3])))
    assert near is not None
    assert temperature_error(near.x, near.problem) < 1e-8
    slope = (near.problem.journal_force(near.x, near.lam) - problem.journal_force(solution.x, solution.lam)) / 1e-3
    gradient = SmallMotion.at_nodes(solution).respond(0.0, LinearSolver()).force_gradient
    assert_allclose(gradient[:, 1], slope, rtol=0.0, atol=1e-2 * np.max(np.abs(gradient)))

    loaded = balance_cold(problem.at(displacement=np.zeros(2)), np.array([0.0, -5.0]))
    assert loaded.force_residual < 1e-9
    assert temperature_error(loaded.x, loaded.problem) < 1e-8
    assert np.isfinite(leading_eigenvalue(solution).real)
