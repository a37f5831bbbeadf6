"""Closed gaps whose reactions act along other rows: against the full system with multipliers."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose

from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.problem import Border
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.sparsity import SparseRows
from tests.verification.shell_helpers import rows_of

N = 9


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def gaps(rng: np.random.Generator) -> tuple[SparseRows, SparseRows]:
    """Gaps of single unknowns and of differences; reactions of the first two drag others along."""
    G = SparseRows(sp.vstack([rows_of(N, ([0, 3, 6], 1.0)), rows_of(N, ([3, 4], 1.0), ([4, 8], -1.0))], format="csr"))
    more = np.zeros(G.shape)
    more[:2] = 0.4 * rng.normal(size=(2, N))
    return G, SparseRows(sp.csr_array(G.toarray() + more))


def test_response_and_its_adjoint_are_those_of_the_full_system(rng: np.random.Generator) -> None:
    """`M dx = -r + H^T lam` with `G dx = -g`, and a border that reads `lam` by rows of its own."""
    (G, H), held = gaps(rng), np.array([True, True, False, True, False])
    M, residual, moved = rng.normal(size=(N, N)), rng.normal(size=N), rng.normal(size=len(held))
    constraints = constrain(G, held, acting=H)
    matrix = sp.csc_array(M)
    tangent = Tangent(matrix, constraints, LinearSolver().factor(constraints.reduce(matrix)))
    k = int(held.sum())
    full = np.block([[M, -H.toarray()[held].T], [G.toarray()[held], np.zeros((k, k))]])
    expected = np.linalg.solve(full, -np.concatenate([residual, moved[held]]))
    change, reactions = tangent.respond(residual, moved[held])
    assert_allclose(change, expected[:N], atol=1e-11)
    assert_allclose(reactions, expected[N:], atol=1e-11)
    both = tangent.respond(np.stack([residual, 2.0 * residual], axis=1), np.stack([moved[held], moved[held]], axis=1))
    assert_allclose(both[0][:, 0], expected[:N], atol=1e-11)
    assert_allclose(both[1][:, 0], expected[N:], atol=1e-11)
    opened = tangent.respond(residual, -np.eye(k)[1])
    for each, one in zip(tangent.respond_each(residual[:, None], np.array([1])), opened, strict=True):
        assert_allclose(each[:, 0], one, atol=1e-11)

    by_change, by_reactions = rng.normal(size=N), rng.normal(size=k)
    by_all = np.linalg.solve(full.T, np.concatenate([by_change, by_reactions]))
    by_residual, by_gaps = tangent.adjoint(by_change, by_reactions)
    assert_allclose(by_residual, -by_all[:N], atol=1e-11)
    assert_allclose(by_gaps, -by_all[N:], atol=1e-11)


def test_contacts_change_under_one_factor(rng: np.random.Generator) -> None:
    """One contact that drags opens and another closes: as with a factor of their own."""
    G, H = gaps(rng)
    before, after = np.array([True, False, True, True, False]), np.array([False, True, True, True, False])
    matrix, none = sp.csc_array(rng.normal(size=(N, N))), np.zeros((N, 2))
    border = Border(rng.normal(size=(5, 2)), rng.normal(size=(2, N)), slice(0, N), rng.normal(size=(2, 5)))

    def bordered(active: np.typing.NDArray[np.bool_]) -> BorderedTangent:
        constraints = constrain(G, active, acting=H)
        factor = LinearSolver().factor(constraints.reduce(matrix))
        return BorderedTangent.of(Tangent(matrix, constraints, factor), border, none)

    exchanged, own = bordered(before).exchanged((G, H), after), bordered(after)
    assert exchanged is not None
    assert_allclose(exchanged.gradient, own.gradient, atol=1e-10)
    residual = rng.normal(size=N)
    for one, other in zip(exchanged.respond(residual), own.respond(residual), strict=True):
        assert_allclose(one, other, atol=1e-10)


def test_reactions_along_the_gaps_are_those_without_rows_of_their_own(rng: np.random.Generator) -> None:
    G, _ = gaps(rng)
    held = np.array([True, True, False, True, False])
    plain, same = constrain(G, held), constrain(G, held, acting=SparseRows(G.copy()))
    residual, matrix = rng.normal(size=N), sp.csc_array(rng.normal(size=(N, N)))
    assert_allclose(same.balanced(residual), plain.balanced(residual), rtol=0.0, atol=0.0)
    assert_allclose(same.reactions(residual), plain.reactions(residual), atol=1e-14)
    assert_allclose(same.reduce(matrix).toarray(), plain.reduce(matrix).toarray(), atol=0.0)
