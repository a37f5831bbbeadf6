"""The coupled system and the solvers' linear systems are told their derivatives: Taylor's test, and gaps beside it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.equilibrium.sinking import Medium, PetalsInMedium, SinkingEquations
from petalfoil.solvers.central_path import Change, PathPoint
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.interior_point import NewtonSystem
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.damped import DampedBalance, DampedWall
from petalfoil.system.leaking_film import LeakingFilm
from petalfoil.system.loaded import LoadedProblem
from tests.contract.taylor import BEARINGS, assert_tangent, bearing, open_state

Array = NDArray[np.float64]

PETALS = [name for name in BEARINGS if "petals" in name]


def stepped_residual(problem: CoupledProblem, x: Array, shift: Array, start: tuple[Array, float]) -> Array:
    """`F(x)` plus `rate` times the mass stored since the start: an implicit step of `1 / rate` in time."""
    stored, rate = start
    residual = problem.linearize(x, shift).residual.copy()
    residual[problem.layout.n_wall :] += rate * (storage(problem, x, shift) - stored)
    return residual


def storage(problem: CoupledProblem, x: Array, shift: Array) -> Array:
    """Mass in the cells of the film; a film without ends counts all of its gas in the row of its inventory."""
    layout = problem.layout
    stored = layout.balance.storage(problem.pressure(x), problem.film(x, shift), problem.bearing_number)
    if layout.film_rows.inventory is not None:
        slenderness = layout.wall.film.axial.length / layout.balance.radius
        stored[0] = slenderness**2 / 6.0 * stored.sum()
    return stored


def random_shift(problem: CoupledProblem, rng: np.random.Generator) -> Array:
    """A shift of the gaps that opens the film by up to a tenth."""
    return rng.uniform(0.0, 0.1, len(problem.layout.wall.contacts.rest))


@pytest.mark.parametrize("rate", [0.0, 0.3])
@pytest.mark.parametrize("name", BEARINGS)
def test_coupled_tangent(name: str, rate: float) -> None:
    """The film's rows to slope 2; the wall's rows are linear, and exact."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(11)
    x, shift = open_state(problem, rng), random_shift(problem, rng)
    direction = rng.uniform(-1.0, 1.0, len(x))
    start = (storage(problem, x, shift), rate)
    line, wall = problem.linearize(x, shift), problem.layout.n_wall
    change = line.matrix(np.zeros(len(shift)), rate) @ direction
    assert_tangent(
        lambda t: stepped_residual(problem, x + t * direction, shift, start)[wall:], change[wall:], largest=2.0**-8
    )
    moved = problem.linearize(x + direction, shift).residual[:wall]
    assert_allclose(
        moved, line.residual[:wall] + change[:wall], rtol=0.0, atol=1e-12 * np.max(np.abs(moved), initial=1.0)
    )


@pytest.mark.parametrize("rate", [0.0, 0.3])
@pytest.mark.parametrize("name", PETALS)
def test_derivative_by_the_gaps_shift(name: str, rate: float) -> None:
    problem, rng = build_problem(bearing(name)), np.random.default_rng(12)
    x, shift = open_state(problem, rng), random_shift(problem, rng)
    direction = rng.uniform(-1.0, 1.0, len(shift))
    start = (storage(problem, x, shift), rate)
    change = problem.linearize(x, shift).slack_derivative(direction, rate)
    assert_tangent(lambda t: stepped_residual(problem, x, shift + t * direction, start), change, largest=2.0**-8)


@pytest.mark.parametrize("name", BEARINGS)
def test_gaps_and_what_they_add_to_the_matrix(name: str) -> None:
    """`g` is linear with derivative `G`, and `theta` enters as `H^T diag(theta) G`."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(13)
    x = open_state(problem, rng)
    direction, theta = rng.uniform(-1.0, 1.0, len(x)), rng.uniform(0.0, 2.0, problem.G.shape[0])
    size = np.max(np.abs(problem.gaps(x)), initial=1.0)
    assert_allclose(problem.gaps(x + direction), problem.gaps(x) + problem.G @ direction, rtol=0.0, atol=1e-14 * size)
    line = problem.linearize(x)
    added = (line.matrix(theta) - line.matrix(0.0 * theta)) @ direction
    expected = problem.acting.T @ (theta * (problem.G @ direction))
    largest = np.max(np.abs(line.matrix(0.0 * theta)).data)  # the difference of the two matrices rounds by this
    assert_allclose(added, expected, rtol=0.0, atol=1e-14 * largest)


# ---------------------------------------------------------------------------------------------- the kink


SIDES_OF_THE_KINK = {
    "open": (0.0, -6.0),
    "closed": (-6.0, 0.0),
    "some open, some closed": (None, None),
    "at the corner": (-3.0, -3.0),
}
"""Powers of ten of slacks and reactions."""


def cone_point(problem: CoupledProblem, side: str, rng: np.random.Generator) -> PrimalDualPoint:
    """A point of the interior-point method on one side of the kink of the gaps; none of its equations holds."""
    m = problem.G.shape[0]
    s_power, lam_power = SIDES_OF_THE_KINK[side]
    is_open = rng.random(m) < 0.5
    s_powers = np.where(is_open, 0.0, -6.0) if s_power is None else np.full(m, s_power)
    lam_powers = np.where(is_open, -6.0, 0.0) if lam_power is None else np.full(m, lam_power)
    s, lam = rng.uniform(0.5, 2.0, m) * 10.0**s_powers, rng.uniform(0.5, 2.0, m) * 10.0**lam_powers
    x = open_state(problem, rng)
    x[: problem.layout.n_wall] *= 1e-3
    return PrimalDualPoint(x, s, lam)


@pytest.mark.slow
@pytest.mark.parametrize("rate", [0.0, 0.3])
@pytest.mark.parametrize("side", SIDES_OF_THE_KINK)
@pytest.mark.parametrize("name", PETALS)
def test_newton_direction_of_the_interior_point(name: str, side: str, rate: float) -> None:
    """Along Newton's direction `[F - H^T lam; s - g; lam s - target]` goes to zero as `1 - t`, up to `t^2`."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(14)
    point = cone_point(problem, side, rng)
    target = 0.1 * point.barrier(problem.weight) * problem.weight
    shift = point.s - problem.gaps(point.x)
    line, start = problem.linearize(point.x, shift), (storage(problem, point.x, shift), rate)
    factor = LinearSolver().factor(line.matrix(point.lam / point.s, rate))
    newton = NewtonSystem(problem, point, line, factor, rate)
    direction = newton.direction(target - point.lam * point.s)
    x, s, lam = direction.parts

    def equations(t: float) -> tuple[Array, Array, Array]:
        moved = point.s + t * s - problem.gaps(point.x + t * x)
        forces = stepped_residual(problem, point.x + t * x, moved, start) - problem.acting.T @ (point.lam + t * lam)
        return forces, moved, (point.lam + t * lam) * (point.s + t * s) - target

    forces, gaps, products = equations(0.0)
    wall, H = problem.layout.n_wall, problem.film(point.x, shift)
    widest = max(np.max(np.abs(s[: H.size]) / H.ravel()), np.max(np.abs(x[wall:] / point.x[wall:])))
    assert_tangent(lambda t: equations(t)[0][wall:], -forces[wall:], largest=2.0**-6 / widest)
    assert_tangent(lambda t: equations(t)[2], -products, largest=1.0)
    # the wall's rows and the gaps are linear: a full step closes them, up to rounding of their terms
    there = equations(1.0)
    acting = abs(problem.acting[:, :wall].T)
    terms = problem.layout.stiffness_size @ np.abs(x[:wall]) + acting @ np.abs(lam)
    moves, rounding = abs(problem.G) @ np.abs(x) + np.abs(s), 4.0 * np.finfo(float).eps
    eliminated = acting @ (point.lam / point.s * moves)
    blur = 1e-13 * np.max(terms) + rounding * np.max(eliminated)
    assert_allclose(there[0][:wall], 0.0, rtol=0.0, atol=blur)
    assert_allclose(there[1], 0.0, rtol=0.0, atol=1e-13 * np.max(np.abs(gaps)) + rounding * np.max(moves))
    # gap by gap, small ones beside large ones
    change, scale = point.lam * s + point.s * lam, np.abs(point.lam * s) + np.abs(products)
    assert_allclose((change + products) / scale, 0.0, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("share", [0.0, 0.1])
@pytest.mark.parametrize("name", PETALS)
def test_tangent_with_active_contacts(name: str, share: float) -> None:
    """Unknowns in active contact move together: the reduced matrix is the derivative of the merged equations."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(15)
    x = open_state(problem, rng)
    ties = constrain(problem.G, rng.random(problem.G.shape[0]) < share, acting=problem.acting)
    direction = rng.uniform(-1.0, 1.0, ties.n_free)
    free_of_wall = np.unique(ties.group[problem.layout.n_wall :])
    change = ties.reduce(problem.linearize(x).matrix(np.zeros(problem.G.shape[0]))) @ direction

    def merged(t: float) -> Array:
        return ties.balanced(problem.linearize(x + t * ties.spread(direction)).residual)[free_of_wall]

    assert_tangent(merged, change[free_of_wall], largest=2.0**-8)


def path_point(name: str) -> PathPoint:
    """A point near no path: random unknowns, open and closed contacts, a barrier of 0.5."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(16)
    x = open_state(problem, rng)
    return PathPoint(problem, LinearSolver(), x, rng.uniform(-2.0, 2.0, len(problem.weight)), float(np.log(0.5)))


def path_residual(point: PathPoint) -> Array:
    """Imbalance of the equations, then slacks over gaps."""
    imbalance = point.linearized.residual - point.problem.acting.T @ point.lam
    return np.concatenate([imbalance, point.open_by])


@pytest.mark.parametrize("name", PETALS)
def test_newton_on_the_central_path(name: str) -> None:
    """It takes the residual off in full, to first order."""
    point = path_point(name)
    newton = point.newton()
    share = 0.3 / max(float(np.max(np.abs(part))) for part in (newton.x, newton.z))
    assert_tangent(lambda t: path_residual(point.moved(newton.times(share * t))), -share * path_residual(point))


@pytest.mark.parametrize("name", PETALS)
def test_tangent_of_the_central_path(name: str) -> None:
    """Along it the residual stays, to first order, while the barrier changes."""
    point = path_point(name)
    tangent = point.tangent().times(1e-2)
    assert isinstance(tangent, Change)
    assert_tangent(lambda t: path_residual(point.moved(tangent.times(t))), np.zeros(len(point.x) + len(point.z)))
    assert point.moved(tangent).barrier == pytest.approx(0.5 * np.exp(1e-2))


@pytest.mark.parametrize("name", PETALS)
def test_a_damped_wall_resists_motion_and_its_gas_stores_nothing(name: str) -> None:
    problem, rng = build_problem(bearing(name)), np.random.default_rng(17)
    x, shift = open_state(problem, rng), random_shift(problem, rng)
    plain, damped = problem.linearize(x, shift), DampedWall.of(problem, 0.3).linearize(x, shift)
    assert_allclose(damped.residual, plain.residual, rtol=0.0, atol=0.0)
    none, change = np.zeros(len(shift)), rng.uniform(-1.0, 1.0, len(x))
    resisted = (damped.matrix(none, 2.0) - plain.matrix(none)) @ change
    assert_allclose(resisted[: problem.layout.n_wall], 0.6 * change[: problem.layout.n_wall], rtol=0.0, atol=1e-7)
    assert_allclose(resisted[problem.layout.n_wall :], 0.0, atol=1e-12)
    assert_allclose(damped.slack_derivative(shift, 2.0), plain.slack_derivative(shift), rtol=0.0, atol=0.0)


@pytest.mark.parametrize("name", PETALS)
def test_petals_in_a_medium_are_told_their_derivatives(name: str) -> None:
    """Film to slope 2; the wall's rows, held back from where they began (M7), are linear, and exact."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(21)
    x, shift, n_wall = open_state(problem, rng), random_shift(problem, rng), problem.layout.n_wall
    sinking = PetalsInMedium(problem, open_state(problem, rng), 0.3)
    along, gaps = rng.uniform(-1.0, 1.0, len(x)), rng.uniform(-1.0, 1.0, len(shift))
    line = sinking.linearize(x, shift)
    change = line.matrix(np.zeros(len(shift))) @ along
    film = slice(n_wall, None)
    assert_tangent(lambda t: sinking.linearize(x + t * along, shift).residual[film], change[film], largest=2.0**-8)
    moved = sinking.linearize(x + along, shift).residual[:n_wall] - line.residual[:n_wall]
    assert_allclose(moved, change[:n_wall], rtol=0.0, atol=1e-12 * np.max(np.abs(line.residual)))
    by_gaps = line.slack_derivative(gaps)
    assert_tangent(lambda t: sinking.linearize(x, shift + t * gaps).residual, by_gaps, largest=2.0**-8)
    held = problem.linearize(x, shift).residual[:n_wall] + 0.3 * (x - sinking.start)[:n_wall]
    assert_allclose(line.residual[:n_wall], held, rtol=0.0, atol=1e-12 * np.max(np.abs(held)))


@pytest.mark.parametrize("name", PETALS)
def test_a_journal_in_a_medium_is_told_its_derivatives(name: str) -> None:
    """The balance (M7) by unknowns, reactions and position: linear, and its border says so; gaps move as it says."""
    problem, rng = build_problem(bearing(name)), np.random.default_rng(22)
    d, x = problem.layout.n_position, open_state(problem, rng)
    sinking = SinkingEquations(problem, rng.uniform(-1.0, 1.0, d), x, Medium(0.7, 0.3))
    lam, e = rng.uniform(0.0, 1.0, problem.G.shape[0]), problem.displacement
    dx, dlam, de = (rng.uniform(-1.0, 1.0, len(one)) for one in (x, lam, e))
    before, after = sinking.imbalance(x, lam, e), sinking.imbalance(x + dx, lam + dlam, e + de)
    change = sinking.border.rows(dx, dlam) - sinking.border_stiffness @ de
    assert_allclose(after - before, change, rtol=0.0, atol=1e-11 * np.max(np.abs(after)))
    moved = sinking.at(e + de).gaps(x) - sinking.at(e).gaps(x)
    assert_allclose(moved, sinking.border.gap_derivative @ de, rtol=0.0, atol=1e-11 * np.max(np.abs(problem.gaps(x))))
    by_e = sinking.at(e).linearize(x).slack_derivative(problem.border.gap_derivative @ de)
    assert_tangent(lambda t: sinking.at(e + t * de).linearize(x).residual, by_e, largest=2.0**-8)


@pytest.mark.parametrize("name", ["stepped petals, 2d", "slipping stepped petals, 2d"])
def test_a_leaking_film_is_told_its_derivatives(name: str) -> None:
    problem, rng = build_problem(bearing(name)), np.random.default_rng(19)
    x, shift, leaking = open_state(problem, rng), random_shift(problem, rng), LeakingFilm.through_ends(problem, 0.7)
    along, gaps = rng.uniform(-1.0, 1.0, len(x)), rng.uniform(-1.0, 1.0, len(shift))
    line, film = leaking.linearize(x, shift), slice(problem.layout.n_wall, None)
    change = (line.matrix(np.zeros(len(shift))) @ along)[film]
    assert_tangent(lambda t: leaking.linearize(x + t * along, shift).residual[film], change, largest=2.0**-8)
    by_gaps = line.slack_derivative(gaps)
    assert_tangent(lambda t: leaking.linearize(x, shift + t * gaps).residual, by_gaps, largest=2.0**-8)


def test_what_leaks_adds_up_to_the_condition_of_a_film_without_ends() -> None:
    """Every balance, the first included, with its leakage: their sum is the leakage times (F6)."""
    problem = build_problem(bearing("stepped petals, 2d"))
    x = open_state(problem, np.random.default_rng(20))
    closed, leaking = (p.linearize(x) for p in (problem, LeakingFilm.through_ends(problem, 0.7)))
    film, inventory = slice(problem.layout.n_wall, None), problem.layout.film_rows.inventory
    assert inventory is not None
    leaks = leaking.residual[film] - closed.residual[film]
    P, H = problem.pressure(x), problem.film(x)
    first = np.sum(inventory.excess(P, H)[inventory.mesh.unknown == 0])
    assert leaks[0] == 0.0
    assert_allclose(leaks.sum() + 0.7 * first, 0.7 * closed.residual[film][0], rtol=1e-12)


@pytest.mark.parametrize("name", PETALS)
def test_a_damped_balance_resists_motion_of_wall_and_journal(name: str) -> None:
    problem, rng = build_problem(bearing(name)), np.random.default_rng(18)
    load, n_wall = np.resize([0.3, -2.0], problem.layout.n_position), problem.layout.n_wall
    z, shift = np.append(open_state(problem, rng), problem.displacement), random_shift(problem, rng)
    plain, damped = LoadedProblem(problem, load), DampedBalance.of(problem, load, 0.3)
    before, after = plain.linearize(z, shift), damped.linearize(z, shift)
    assert_allclose(after.residual, before.residual, rtol=0.0, atol=0.0)
    none, change = np.zeros(len(shift)), rng.uniform(-1.0, 1.0, len(z))
    resisted = (after.matrix(none, 2.0) - before.matrix(none)) @ change
    expected = np.zeros(len(z))
    expected[:n_wall] = 0.6 * change[:n_wall]
    expected[-len(load) :] = 0.6 * problem.layout.wall.film.unknown.size * change[-len(load) :]
    assert_allclose(resisted, expected, rtol=0.0, atol=1e-7)
