"""The assembled pack without a film: a convex program, so that another solver is an independent check."""

import numpy as np
import piqp
import pytest
import scipy.linalg
import scipy.sparse as sp
from numpy.testing import assert_allclose
from scipy.optimize import nnls

from petalfoil.case import Case, Mount
from petalfoil.equilibrium.pack_at_rest import at_rest
from petalfoil.system.build import build_problem
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.walls.petals import build_mesh, petals_of
from tests.cases import case
from tests.random_packs import random_case, wide_case
from tests.verification.shell_helpers import Array, Solved, solve

EXAMPLES = ("paper_n6", "paper_n8", "paper_n10", "rig")
SEED = 2901


def pack(of: Case) -> FoilPackProblem:
    problem = build_problem(of)
    return FoilPackProblem(problem, np.zeros(problem.layout.n_wall))


def example(name: str, cells: int, **changes: object) -> Case:
    return case(name, **{"model.kind": "2d", "model.cells_per_pitch": cells, **changes})


def answer_of(problem: FoilPackProblem) -> Solved:
    return solve(problem, problem.layout.n_wall)


# ------------------------------------------------------------------------------------------ optimality from geometry


def elastic_forces(of: Case, W: Array, phi: Array) -> Array:
    """Gradient of the bending energy, moment by moment, (petal, node) [N]."""
    petals, geometry = petals_of(of)
    r_m = geometry.metric_radius
    h = np.diff(phi)
    share = np.append(h, 0.0) / 2.0 + np.append(0.0, h) / 2.0
    rigidity = petals.bending_stiffness * r_m * of.bearing.length
    force = np.zeros_like(W)
    for i in range(1, len(phi) - 1):
        left, right = h[i - 1], h[i]
        a, c = 2.0 / (left * (left + right)) / r_m**2, 2.0 / (right * (left + right)) / r_m**2
        b = 1.0 / petals.bend_radius**2 - a - c
        moment = rigidity * share[i] * (a * W[:, i - 1] + b * W[:, i] + c * W[:, i + 1])
        force[:, i - 1] += a * moment
        force[:, i] += b * moment
        force[:, i + 1] += c * moment
    if petals.mount is Mount.CLAMPED:
        a = 2.0 / h[0] ** 2 / r_m**2
        moment = rigidity * share[0] * ((1.0 / petals.bend_radius**2 - a) * W[:, 0] + a * W[:, 1])
        force[:, 0] += (1.0 / petals.bend_radius**2 - a) * moment
        force[:, 1] += a * moment
    return force


def touching(of: Case, W: Array, phi: Array, roots: Array) -> list[tuple[float, list[tuple[int, int, float]]]]:
    """Every gap [m] with the nodes (petal, node, direction) that its reaction pushes, found by angle."""
    petals, geometry = petals_of(of)
    half, pitch = 0.5 * petals.total_thickness, 2.0 * np.pi / petals.count
    r = geometry.free_radius(phi) + W
    e_x, e_y = of.operation.eccentricity
    found = []
    for l in range(petals.count):
        for i, angle in enumerate(phi):
            theta = roots[l] + angle
            if angle > geometry.petal_angle - pitch - 1e-9:
                journal = of.bearing.journal_radius + e_x * np.cos(theta) + e_y * np.sin(theta)
                gap = r[l, i] - half - journal - of.surface.contact_film_thickness
                found.append((gap, [(l, i, 1.0)]))
            if 1e-9 < angle < pitch - 1e-9:
                found.append((of.bearing.bushing_radius - half - r[l, i], [(l, i, -1.0)]))
            if angle > pitch - 1e-9:
                following = (l + 1) % petals.count
                k = int(np.argmin(np.abs(phi - (angle - pitch))))
                gap = r[following, k] - r[l, i] - 2.0 * half
                found.append((gap, [(l, i, -1.0), (following, k, 1.0)]))
    return found


def check_optimality(of: Case) -> None:
    """Forces balance, gaps and reactions have their signs, and only what touches pushes."""
    problem, mesh = pack(of), build_mesh(of)
    answer = answer_of(problem)
    scales = problem.layout.scales
    W = np.zeros((mesh.count, mesh.n_node))
    W[:, 1:] = answer.x.reshape(mesh.count, -1) * scales.length
    lam = answer.lam * scales.force

    contacts = touching(of, W, mesh.phi, mesh.roots)
    gaps = np.array([gap for gap, _ in contacts])
    order = problem.coupled.layout.wall.contacts
    pieces = (order.journal, order.bushing, order.petals)
    kinds = np.concatenate([np.full(piece.stop - piece.start, k) for k, piece in enumerate(pieces)])
    mine = np.array([2 if len(nodes) == 2 else 0 if nodes[0][2] > 0.0 else 1 for _, nodes in contacts])
    assert gaps.min() > -1e-7 * scales.length
    assert lam.min() >= -1e-7 * scales.force
    for kind in range(3):  # both lists run petal by petal, node by node
        assert_allclose(gaps[mine == kind], problem.gaps(answer.x)[kinds == kind] * scales.length, atol=1e-15)
    reaction = np.zeros(len(contacts))
    for kind in range(3):
        reaction[mine == kind] = lam[kinds == kind]
    assert np.abs(reaction * gaps).max() < 1e-12 * lam.max() * scales.length

    balance = elastic_forces(of, W, mesh.phi)
    for push, (_, nodes) in zip(reaction, contacts, strict=True):
        for l, i, direction in nodes:
            balance[l, i] -= direction * push
    assert np.abs(balance[:, 1:]).max() < 1e-6 * scales.force


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_optimal(name: str) -> None:
    check_optimality(example(name, 32))


@pytest.mark.slow
def test_random_packs_are_optimal() -> None:
    rng = np.random.default_rng(SEED)
    for _ in range(12):
        check_optimality(random_case(rng))


# ------------------------------------------------------------------------------------------ other routes


def by_piqp(problem: FoilPackProblem) -> tuple[Array, Array]:
    """Deflections and reactions by PIQP."""
    solver = piqp.SparseSolver()
    for name in ("eps_abs", "eps_rel", "eps_duality_gap_abs", "eps_duality_gap_rel"):
        setattr(solver.settings, name, 1e-10)  # 1e-12 is out of its reach
    K, G = sp.csc_matrix(problem.layout.stiffness), sp.csc_matrix(problem.G)
    rest = problem.gaps(np.zeros(len(problem.load)))
    solver.setup(K, -problem.load, None, None, G, -rest, None)
    assert solver.solve() == piqp.PIQP_SOLVED
    return solver.result.x, solver.result.z_l


def agree(problem: FoilPackProblem) -> None:
    """Deflections, reactions and active contacts are those of PIQP."""
    answer, (x, lam) = answer_of(problem), by_piqp(problem)
    assert_allclose(answer.x, x, rtol=0.0, atol=1e-8 * np.abs(x).max())
    assert_allclose(answer.lam, lam, rtol=0.0, atol=1e-5 * lam.max())
    assert np.array_equal(answer.active, lam / problem.weight > problem.gaps(x))


# The rig with a larger clearance. PIQP's reactions of the example itself, close to bottoming out, have errors of 1e-5.
WIDE: dict[str, object] = {
    "bearing.journal_radius": 28.2e-3,
    "petals.count": 8,
    "petals.arc_length": 42e-3,
    "petals.coating": 16e-6,
    "petals.first_root": 0.0,
    "surface.contact_film_thickness": 1e-6,
}


@pytest.mark.parametrize("name", EXAMPLES)
@pytest.mark.parametrize("cells", [16, 48])
def test_piqp_agrees(name: str, cells: int) -> None:
    wider = WIDE if name == "rig" else {}
    problem = pack(example(name, cells, **{**wider, "operation.eccentricity": (30e-6, -80e-6)}))
    agree(problem)


def test_piqp_agrees_under_film_pressure() -> None:
    coupled = build_problem(example("paper_n8", 32))
    P = 1.0 + np.random.default_rng(SEED).uniform(0.0, 1.0, coupled.layout.wall.film.n_unknown)
    problem = FoilPackProblem(coupled, coupled.layout.push @ (P - 1.0))
    agree(problem)


def by_least_distance(problem: FoilPackProblem) -> tuple[Array, Array]:
    """Lawson and Hanson's least-distance programming over SciPy's NNLS; K must be definite.

    With `K = R^T R` and `y = R x` the pack is the point nearest to the origin over `G R^-1 y >= -rest`.
    """
    R = scipy.linalg.cholesky(problem.layout.stiffness.toarray())
    E = scipy.linalg.solve_triangular(R, problem.G.toarray().T, trans="T")
    h = -problem.gaps(np.zeros(len(problem.load)))
    size = np.abs(h).max()
    u, _ = nnls(np.vstack([E, h / size]), np.append(np.zeros(len(E)), 1.0), maxiter=20 * len(h))
    r = np.append(E @ u, h @ u / size - 1.0)
    return scipy.linalg.solve_triangular(R, -r[:-1] / r[-1] * size), u / -r[-1] * size


def test_least_distance_programming_agrees() -> None:
    rng = np.random.default_rng(SEED)
    for _ in range(6):
        of = random_case(rng, **{"petals.mount": "clamped", "model.cells_per_pitch": 8})
        problem = pack(of)
        answer, (x, lam) = answer_of(problem), by_least_distance(problem)
        assert_allclose(answer.x, x, atol=1e-6 * np.abs(x).max())
        assert_allclose(answer.lam.sum(), lam.sum(), rtol=1e-5)


def test_as_the_product_assembles_it() -> None:
    for name in EXAMPLES:
        problem = pack(example(name, 32))
        assembled = at_rest(problem.coupled)
        assert assembled is not None
        answer = answer_of(problem)
        assert_allclose(assembled.x, answer.x, atol=1e-9 * np.abs(answer.x).max())
        assert np.array_equal(assembled.active, answer.active)


@pytest.mark.parametrize("cells", [12, 16])
def test_petals_that_overlap_by_a_third_of_a_cell(cells: int) -> None:
    """Sixteen hinged petals, overlap 1.027: a contact hardly carries, and without it a petal turns freely."""
    thin = wide_case(np.random.default_rng([447, 13]), **{"model.cells_per_pitch": cells})
    assert thin.pack is not None
    assert thin.pack.overlap < 1.03
    problem = pack(thin)
    assembled = at_rest(problem.coupled)
    assert assembled is not None
    gaps, reactions = problem.gaps(assembled.x), assembled.lam
    assert gaps.min() > -1e-8
    assert reactions.min() > -1e-8 * reactions.max()
    assert np.abs(gaps * reactions).max() <= 1e-8 * reactions.max()


# ------------------------------------------------------------------------------------------ counts


@pytest.mark.slow
@pytest.mark.parametrize("name", EXAMPLES)
def test_from_nothing_in_twenty_steps_on_the_finest_grid(name: str) -> None:
    wider = WIDE if name == "rig" else {}
    problem = pack(example(name, 256, **{**wider, "operation.eccentricity": (0.0, -100e-6)}))
    answer = answer_of(problem)
    assert answer.steps <= 20
    assert answer.polish <= 12


def test_steps_do_not_grow_with_the_grid() -> None:
    counts = [answer_of(pack(example("paper_n8", cells))).steps for cells in (32, 256)]
    assert counts[1] <= 1.5 * counts[0]


@pytest.mark.slow
@pytest.mark.parametrize("count", [50, pytest.param(200, marks=pytest.mark.long)])
def test_random_packs(count: int) -> None:
    """Both mounts, 5 to 12 petals, overlap to 3, preloads over six decades: every one is found."""
    rng = np.random.default_rng(SEED)
    counts = [answer_of(pack(random_case(rng))).steps for _ in range(count)]
    assert max(counts) <= 20
    assert np.median(counts) <= 15


# ------------------------------------------------------------------------------------------ symmetries


def test_petals_around_a_centred_journal_are_alike() -> None:
    of = example("paper_n8", 32, **{"operation.eccentricity": (0.0, 0.0)})
    W = answer_of(pack(of)).x.reshape(8, -1)
    assert_allclose(W, np.broadcast_to(W[0], W.shape), rtol=0.0, atol=1e-9 * np.abs(W).max())


def test_half_the_length_is_half_of_the_whole() -> None:
    answers = []
    for symmetry in (True, False):
        changes = {"model.kind": "3d", "model.axial_cells": 6, "model.symmetry": symmetry}
        problem = pack(example("paper_n8", 8, **changes, **{"petals.theory": "inextensible"}))
        axial, count = problem.layout.wall.film.axial, 8
        W = answer_of(problem).x.reshape(count, -1, len(axial.z))
        answers.append(axial.whole(W))
    assert_allclose(answers[0], answers[1], rtol=0.0, atol=1e-9 * np.abs(answers[0]).max())


def test_random_packs_are_reproducible_and_varied() -> None:
    first, again = ([random_case(np.random.default_rng(SEED)) for _ in range(3)] for _ in range(2))
    assert first == again
    rng = np.random.default_rng(SEED)
    drawn = [random_case(rng, **{"operation.speed": 0.0}) for _ in range(60)]
    assert {of.operation.speed for of in drawn} == {0.0}
    assert {petals_of(of)[0].mount for of in drawn} == set(Mount)
    assert {petals_of(of)[1].layers for of in drawn} == {2, 3}
    assert len({petals_of(of)[0].count for of in drawn}) >= 7
