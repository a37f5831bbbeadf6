"""Reduced models of moved systems against dense algebra, and the modes of a mass on them."""

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers import reduced_model
from petalfoil.solvers.reduced_model import KrylovSpace, MovedSystem, ReducedModel, reduce_system

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

N, D = 90, 2
POINTS = 1j * np.linspace(0.01, 3.0, 12)


def dense(seed: int = 0, stored: int = N // 2) -> tuple[Array, MovedSystem]:
    """A system whose first unknowns store nothing, with decay rates from 1 to 100."""
    rng = np.random.default_rng(seed)
    J = rng.normal(size=(N, N)) / np.sqrt(N) + np.diag(np.geomspace(1.0, 100.0, N))
    S = np.diag(np.where(np.arange(N) >= N - stored, rng.uniform(0.5, 1.0, N), 0.0))
    parts = [rng.normal(size=(N, D)) for _ in range(4)]
    direct = rng.normal(size=(D, D)), rng.normal(size=(D, D))
    inverse = np.linalg.inv(J)
    return J, MovedSystem(lambda b: inverse @ b, sp.csc_array(S), (parts[0], parts[1]), (parts[2], parts[3]), direct)


def exact(J: Array, system: MovedSystem, s: complex) -> Complex:
    (f0, f1), (l0, l1), (d0, d1) = system.forcing, system.force, system.direct
    y = -np.linalg.solve(J + s * system.S.toarray(), f0 + s * f1)
    return np.asarray((l0 + s * l1).T @ y + d0 + s * d1)


@pytest.mark.parametrize("seed", range(4))
def test_a_model_far_smaller_than_the_system_moves_alike(seed: int) -> None:
    J, system = dense(seed)
    model = reduce_system(system, POINTS.tolist())
    assert model.size < 0.6 * N
    for s in [*POINTS, 0.7 + 1.1j, -0.3 + 0.5j]:
        wanted = exact(J, system, s)
        assert_allclose(model.at(s), wanted, rtol=0.0, atol=1e-9 * float(np.max(np.abs(wanted))))


def test_derivative_is_that_of_the_force() -> None:
    _, system = dense()
    model, s, step = reduce_system(system, POINTS.tolist()), 0.2 + 0.6j, 1e-5
    differences = (model.at(s + step) - model.at(s - step)) / (2.0 * step)
    assert_allclose(model.derivative(s), differences, rtol=1e-7)


@pytest.mark.parametrize("polar", [0.0, 30.0])
def test_modes_of_a_body_are_the_eigenvalues_of_the_whole_system(polar: float) -> None:
    """`det(mass s^2 + gyroscopic s - F(s)) = 0`, against the whole system's eigenvalues within reach of the points."""
    J, system = dense()
    mass, (f0, f1), (l0, l1), (d0, d1) = 40.0, system.forcing, system.force, system.direct
    none, one, turning = np.zeros((D, D)), np.eye(D), np.zeros((D, D))
    turning[0, 1], turning[1, 0] = polar, -polar
    A = np.block([[J, f0, np.zeros((N, D))], [-l0.T, -d0, turning], [np.zeros((D, N)), none, -one]])
    B = np.block([[system.S.toarray(), f1, np.zeros((N, D))], [-l1.T, -d1, mass * one], [np.zeros((D, N)), one, none]])
    whole = la.eigvals(-A, B)
    whole = whole[np.isfinite(whole) & (np.abs(whole) < 0.8)]
    assert len(whole) >= 2
    modes = reduce_system(system, POINTS.tolist()).modes(mass * one, turning)
    for s in whole:
        assert np.min(np.abs(modes - s)) <= 1e-7 * abs(s)


def test_a_space_that_is_complete_is_exact() -> None:
    """Three unknowns store: the space ends with them."""
    J, system = dense(1, stored=3)
    model = reduce_system(system, POINTS.tolist())
    assert model.size <= 2 * D + 3
    wanted = exact(J, system, 50.0j)
    assert_allclose(model.at(50.0j), wanted, rtol=0.0, atol=1e-11 * float(np.max(np.abs(wanted))))


def test_forcing_that_repeats_itself_adds_no_vectors() -> None:
    _, system = dense(2)
    (f0, _), rest = system.forcing, (system.force, system.direct)
    repeated = MovedSystem(system.solve, system.S, (f0, 2.0 * f0), *rest)
    once = MovedSystem(system.solve, system.S, (f0, 0.0 * f0), *rest)
    sizes = [reduce_system(one, POINTS.tolist()).size for one in (repeated, once)]
    assert sizes[0] <= sizes[1] + 2 * D
    for s in POINTS:
        assert np.all(np.isfinite(reduce_system(once, POINTS.tolist()).at(s)))


def test_no_more_vectors_than_may_be_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """A model that is too small is told by its error, not by an exception."""
    monkeypatch.setattr(reduced_model, "MOST", 8)
    J, system = dense()
    model: ReducedModel = reduce_system(system, POINTS.tolist())
    wanted = exact(J, system, 3.0j)
    assert model.size == 8
    assert np.max(np.abs(model.at(3.0j) - wanted)) > 1e-8 * np.max(np.abs(wanted))


@pytest.mark.parametrize("apart", [1.0, 1e-3, 1e-7, 0.0], ids=["apart", "near", "nearer", "the same"])
@pytest.mark.parametrize("imaginary", [0.0, 1.0], ids=["real", "complex"])
def test_a_krylov_space_grows_by_blocks_of_vectors_however_near_they_are(apart: float, imaginary: float) -> None:
    """Its basis is orthonormal, and holds the images of those of its vectors that were asked for."""
    rng = np.random.default_rng(2)
    K = rng.standard_normal((N, N)) + imaginary * 1j * rng.standard_normal((N, N))
    start = rng.standard_normal((3, N)).astype(K.dtype)
    start[2] = start[0] + apart * start[2]
    space = KrylovSpace(N, K.dtype)
    space.extend(start)
    for _ in range(4):
        space.extend(space.next(3) @ K.T)
    V = space.vectors
    assert space.applied == (12 if apart else 8)
    assert_allclose(V.conj() @ V.T, np.eye(len(V)), atol=1e-13)
    assert_allclose(V[: space.applied] @ K.T, space.H[:, : space.applied].T @ V, atol=1e-12 * float(np.linalg.norm(K)))
