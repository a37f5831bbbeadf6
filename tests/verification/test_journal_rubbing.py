"""A journal whose dry friction drags petals along and is held back (D6), (D7): by hand, and beside differences."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil import Case, DefinitionError, UsageError, balance, coefficients, curve, orbit, sensitivity, solve, static
from petalfoil.analysis.operating_point import operating_point
from petalfoil.equilibrium.element_contacts import near_nodes
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import running
from petalfoil.system.build import build_problem
from petalfoil.walls.petals import build_mesh, petal_faces
from petalfoil.walls.sliding import dragged_faces
from tests.cases import case
from tests.contract.taylor import assert_tangent
from tests.random_packs import random_case
from tests.verification.test_contact_points import shifted
from tests.verification.test_contact_slopes import apart

Array = NDArray[np.float64]

MU = 0.3
SLOW = {
    "surface.journal_rubbing": "force",
    "surface.friction_coefficient": MU,
    "operation.speed": 300.0,
    "operation.eccentricity": (0.0, -250e-6),
    "model.cells_per_pitch": 16,
}
"""A journal that presses on petals nearly without a film."""


def rubbed(**changes: object) -> Case:
    """The paper's bearing with a journal that rubs."""
    return case("paper_n8", **{**SLOW, **{key.replace("__", "."): value for key, value in changes.items()}})


def turned(phi: Array, metric: float, bend: float) -> tuple[Array, Array]:
    """Motions of an arc that turns about its root by one radian, radial and along itself [m]."""
    angle = metric * phi / bend
    return bend * np.sin(angle), -bend * (1.0 - np.cos(angle))


@pytest.mark.parametrize("theory", ["shell", "inextensible"])
def test_a_petal_that_turns_about_its_root_moves_as_a_rigid_arc_does(theory: str) -> None:
    """Its inner face moves along itself by `-R (1 - cos) + delta / 2`, to the second order of the cells."""
    errors = []
    for cells in (12, 24):
        bearing = rubbed(petals__theory=theory, model__cells_per_pitch=cells)
        problem, mesh, faces = build_problem(bearing), build_mesh(bearing), petal_faces(bearing)
        r, R, half = float(faces.metric_radius[0]), float(faces.bend_radius[0]), float(faces.half_thickness[0])
        W, V = turned(mesh.phi[1:], r, R)
        motion = np.tile(W, mesh.count)
        if theory == "shell":
            motion = np.concatenate([motion, np.tile(V, mesh.count)])
        wall = problem.layout.wall
        along = (dragged_faces(wall, mesh, faces) @ motion)[wall.contacts.journal].reshape(mesh.count, -1)
        expected = turned(mesh.phi[mesh.exposed], r, R)[1] + half
        errors.append(float(np.median(np.abs(along - expected))))  # slopes err more where cells differ in size
        assert np.max(np.abs(along - expected)) < 0.2 * half
        assert np.max(np.abs(expected - half)) > 10.0 * half
    assert errors[0] < 2e-4 * R
    assert errors[1] < 0.3 * errors[0] if theory == "inextensible" else errors[1] < 1e-3 * half


def hinge_moments(result: xr.Dataset, bearing: Case, mu: float) -> tuple[Array, Array]:
    """Moments of all loads of each petal about its root by hand, and the sum of their magnitudes, (petal,) [N m]."""
    problem, mesh, faces = build_problem(bearing), build_mesh(bearing), petal_faces(bearing)
    r, R, half = float(faces.metric_radius[0]), float(faces.bend_radius[0]), float(faces.half_thickness[0])
    W, V = turned(mesh.phi, r, R)
    contacts, count, inner = problem.layout.wall.contacts, mesh.count, mesh.n_node - mesh.cells

    def forces(name: str, rows: slice, nodes: slice) -> Array:
        return result[name].to_numpy()[:, nodes, 0] * contacts.area[rows].reshape(count, -1)

    journal = result["journal_contact_pressure"].to_numpy()[..., 0] * contacts.area[contacts.journal].reshape(count, -1)
    bushing = forces("bushing_contact_pressure", contacts.bushing, mesh.on_bushing)
    outer = forces("petal_contact_pressure", contacts.petals, mesh.on_neighbour)
    gauge = result["pressure"].to_numpy()[..., 0] - bearing.gas.ambient_pressure
    film = gauge * problem.layout.wall.load_area[..., 0]
    parts = [
        ((film + journal) * W[mesh.exposed]).sum(axis=1),
        mu * (journal * (V + half)[mesh.exposed]).sum(axis=1),
        -(bushing * W[mesh.on_bushing]).sum(axis=1),
        -(outer * W[mesh.on_neighbour]).sum(axis=1),
        (np.roll(outer, 1, axis=0) * W[:inner]).sum(axis=1),
    ]
    return np.sum(parts, axis=0), np.sum(np.abs(parts), axis=0)


def test_moments_about_the_hinges_balance_with_friction_on_the_inner_face() -> None:
    """Without friction in the sum they are out of balance by 4 %."""
    bearing = rubbed(model__cells_per_pitch=32)
    result = solve(bearing)
    assert float(result.contact_normal_force) > 30.0
    left, size = hinge_moments(result, bearing, MU)
    assert np.max(np.abs(left) / size) < 2e-4
    without, _ = hinge_moments(result, bearing, 0.0)
    assert np.max(np.abs(without) / size) > 0.03
    assert float(result.reaction_balance_error) < 1e-10


@pytest.mark.slow
def test_the_rotor_is_held_back_and_its_torque_is_that_of_the_same_force() -> None:
    bearing = rubbed(model__cells_per_pitch=32)
    result, mesh = solve(bearing), build_mesh(bearing)
    on_journal = result["contact_facing"].to_numpy() == 0.0
    petal = result["contact_petal"].to_numpy()[on_journal].astype(int)
    theta = mesh.roots[petal] + result["contact_angle"].to_numpy()[on_journal]
    force = result["contact_force"].to_numpy()[on_journal]
    normal, along = (np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)]))
    expected = -(normal + MU * along) @ force
    # directions within an element are those of a cubic
    assert_allclose([result.contact_force_x, result.contact_force_y], expected, rtol=1e-7)
    plain = solve(bearing.replace(**{"surface.journal_rubbing": "torque"}))
    assert float(result.contact_force_x) < float(plain.contact_force_x) - 0.15 * MU * float(force.sum())
    assert float(result.contact_normal_force) > 1.05 * float(plain.contact_normal_force)  # petals wrap round the shaft


@pytest.mark.slow
def test_both_theories_agree_as_petals_hardly_stretch() -> None:
    first, second = (solve(rubbed(petals__theory=theory)) for theory in ("shell", "inextensible"))
    for name in ("force_x", "force_y", "friction_torque", "max_bending_stress"):
        assert_allclose(float(first[name]), float(second[name]), rtol=1e-9)


@pytest.mark.slow
def test_without_friction_nothing_is_dragged_to_the_last_bit() -> None:
    """As the rubbing that is torque alone."""
    force = rubbed(surface__friction_coefficient=0.0, petals__theory="inextensible")
    torque = force.replace(**{"surface.journal_rubbing": "torque"})
    first, second = solve(force), solve(torque)
    for name in ("force_x", "force_y", "min_film_thickness", "friction_torque", "max_bending_stress"):
        assert float(first[name]) == float(second[name]), name


@pytest.mark.slow
def test_a_journal_that_touches_nothing_drags_nothing() -> None:
    """Lifted off, with contact points: the balance is that of a journal whose rubbing is torque alone."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": 16})
    free, rubbing = (
        balance(bearing.replace(**{"surface.journal_rubbing": rub}), "10 N") for rub in ("torque", "force")
    )
    assert "contact points" in str(rubbing["contact_model"].item())
    assert float(rubbing["contact_fraction"]) == 0.0
    for name in ("eccentricity_x", "eccentricity_y", "min_film_thickness", "friction_torque"):
        assert float(rubbing[name]) == pytest.approx(float(free[name]), rel=1e-9)


def test_a_journal_at_zero_speed_is_about_to_turn() -> None:
    """Its starting torque is the limit of the torque at low speeds, larger than that of a journal that only rests."""
    slowly, at_rest = solve(rubbed(operation__speed=1e-3)), static(rubbed(), "250 um")
    assert_allclose(at_rest["starting_torque"].item(), float(slowly.friction_torque), rtol=1e-5)
    resting = static(rubbed(surface__journal_rubbing="torque"), "250 um")
    assert at_rest["starting_torque"].item() > 1.05 * resting["starting_torque"].item()


@pytest.mark.slow
def test_a_motion_does_the_work_of_the_dry_friction_too() -> None:
    """A rotor that falls on its petals and rubs: nothing is missing in the balance of energy (O6)."""
    moving = rubbed(rotor={"mass": 3.0}, operation__speed=300.0, operation__eccentricity=(0.0, -240e-6))
    errors = [float(orbit(moving, revolutions=0.1, tolerance=tol).energy_balance_error) for tol in (1e-3, 1e-5)]
    assert errors[1] < 1e-3
    assert errors[1] < 0.5 * errors[0]


def with_rubbed_points(cells: int) -> PointContacts:
    """The equilibrium with contact points on the journal."""
    with running():
        found = near_nodes(operating_point(rubbed(model__cells_per_pitch=cells), None).answer)
    assert isinstance(found, PointContacts)
    assert np.any(found.points.every_curve < found.pack.mesh.count)
    return found


def test_tangent_with_contact_points_on_a_journal_that_drags() -> None:
    """Remainders of second order away from the solution, of the rows and of the force on the journal."""
    equations, rng = with_rubbed_points(16).equations, np.random.default_rng(1)
    points, free = equations.state.points, equations.travels
    direction = np.concatenate([
        rng.uniform(-0.02, 0.02, equations.whole.n_wall),
        rng.uniform(-0.1, 0.1, equations.whole.n_film),
        rng.uniform(-1.0, 1.0, len(points.reaction)) * points.reaction,
        rng.uniform(-0.3, 0.3, len(points.position)) * np.minimum(points.position % 1.0, 1.0 - points.position % 1.0),
    ]) * np.concatenate([np.ones(equations.n - len(free)), free])  # fmt: skip
    away = shifted(equations, 0.01 * direction)
    assert_tangent(lambda t: np.concatenate(shifted(away, t * direction).residual), away.steady @ direction)
    assert_tangent(lambda t: shifted(away, t * direction).force, away.force_rows @ direction)


@pytest.mark.slow
def test_slopes_converge_with_contact_points_on_a_journal_that_drags() -> None:
    """From 96 and from 128 cells per pitch to 256: stiffness within 0.05 %, damping within 0.15 %.

    With contacts at nodes they differ by 5 and 150 % between the last two.
    """
    first, second, fine = (coefficients(rubbed(model__cells_per_pitch=cells)) for cells in (96, 128, 256))
    for name, within in (("stiffness", 5e-4), ("damping", 1.5e-3)):
        limit = fine[name].to_numpy().reshape(2, 2)
        assert all(apart(one[name].to_numpy().reshape(2, 2), limit) <= within for one in (first, second))


@pytest.mark.slow
def test_forces_with_contact_points_are_the_limit_of_those_with_contacts_at_nodes() -> None:
    fine = solve(rubbed(model__cells_per_pitch=256, model__contacts="nodes"))
    points = solve(rubbed(model__cells_per_pitch=64))
    for name, within in (("force_y", 4e-3), ("contact_normal_force", 8e-3), ("friction_torque", 8e-3)):
        assert_allclose(points[name].item(), fine[name].item(), rtol=within)


@pytest.mark.slow
def test_stiffness_is_the_slope_of_the_force_and_not_symmetric() -> None:
    bearing, step = rubbed(), 2e-9

    def force(x: float, y: float) -> Array:
        result = solve(bearing.replace(**{"operation.eccentricity": (x, y)}))
        return np.array([float(result.force_x), float(result.force_y)])

    K = coefficients(bearing, frequencies=[1e-4])["stiffness"].to_numpy().reshape(2, 2)
    x, y = bearing.operation.eccentricity
    by_x = (force(x + step, y) - force(x - step, y)) / (2.0 * step)
    by_y = (force(x, y + step) - force(x, y - step)) / (2.0 * step)
    assert_allclose(K, -np.column_stack([by_x, by_y]), atol=2e-6 * np.max(np.abs(K)))
    torque = bearing.replace(**{"surface.journal_rubbing": "torque"})
    plain = coefficients(torque, frequencies=[1e-4])["stiffness"].to_numpy().reshape(2, 2)
    assert abs((K[0, 1] - K[1, 0]) - (plain[0, 1] - plain[1, 0])) > 0.01 * np.max(np.abs(K))


@pytest.mark.slow
def test_a_balance_is_on_the_curve_of_forces() -> None:
    """The load that it carries is the force at its position; a curve goes on from point to point."""
    bearing = rubbed()
    held = balance(bearing, load=(0.0, -28.0))
    e = float(held.eccentricity_x), float(held.eccentricity_y)
    at = solve(bearing.replace(**{"operation.eccentricity": e}))
    assert at.contact_model.item() == held.contact_model.item()
    assert_allclose([float(at.force_x), float(at.force_y)], [0.0, 28.0], atol=1e-6)
    assert float(held.eccentricity_x) < -1e-6  # it runs up against the rotation
    points, last = curve(bearing, "240 um : 250 um : 2"), solve(bearing)
    assert_allclose(points["force_x"].to_numpy()[-1], float(last.force_x), rtol=1e-7)


@pytest.mark.slow
def test_derivatives_follow_the_friction_coefficient() -> None:
    """Of the force by the coefficient: by tangent and by adjoint as by differences."""
    bearing, step = rubbed(), 1e-5
    names = ["surface.friction_coefficient"]
    forward, backward = (float(solve(bearing.replace(**{names[0]: MU + sign * step})).force_x) for sign in (1.0, -1.0))
    slope = (forward - backward) / (2.0 * step)
    for method in ("tangent", "adjoint"):
        table = sensitivity(bearing, names[0], of="force_x", method=method)
        assert_allclose(table["derivative"].item(), slope, rtol=1e-5)


@pytest.mark.slow
def test_a_pack_that_has_bottomed_out_is_balanced() -> None:
    """By the interior point, as reactions there are not determined by contacts; its growth rate is that of the film."""
    held = balance(rubbed(model__cells_per_pitch=8), load=(0.0, -2000.0))
    assert "bottomed out" in str(held.solution_path.item())
    assert float(held.residual) < 1e-8
    assert_allclose(float(held.force_y), 2000.0, rtol=1e-8)
    assert np.isfinite(float(held.growth_rate))


@pytest.mark.slow
def test_random_packs_are_dragged() -> None:
    """Three at a twentieth of their speed: residual and support of the petals; the journal is pressed harder."""
    for number in range(3):
        drawn = random_case(np.random.default_rng(number), **{"model.cells_per_pitch": 16, "model.contacts": "nodes"})
        slow = {"operation.speed": 0.05 * drawn.operation.speed, "surface.friction_coefficient": MU}
        force = solve(drawn.replace(**slow, **{"surface.journal_rubbing": "force"}))
        torque = solve(drawn.replace(**slow))
        assert float(force.residual) < 1e-8
        assert float(force.reaction_balance_error) < 1e-9
        assert float(force.contact_normal_force) > 1.01 * float(torque.contact_normal_force) > 0.0


@pytest.mark.parametrize(
    ("changes", "lacks"),
    [
        ({"model.method": "classic"}, "newton"),
        ({"model.kind": "3d", "petals.theory": "inextensible"}, "shell"),
    ],
)
def test_what_cannot_be_dragged_is_refused_in_words(changes: dict[str, object], lacks: str) -> None:
    with pytest.raises(DefinitionError, match=f"journal_rubbing.*{lacks}"):
        rubbed().replace(**changes)


def test_a_pack_with_friction_is_not_pressed_by_a_journal_that_turns() -> None:
    with pytest.raises(UsageError, match="round a journal that does not turn"):
        static(rubbed(surface__petal_friction=0.1), "0 um : 100 um : 2")


@pytest.mark.slow
def test_a_shaft_that_hardly_turns_rolls_up_a_dry_bore_to_the_angle_of_friction() -> None:
    """`arctan mu` against the rotation, to the spacing of the nodes."""
    dry = {"surface.journal_rubbing": "force", "surface.friction_coefficient": MU, "operation.speed": 1.0}
    bearing = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 120, **dry})
    held = balance(bearing, load=(0.0, -50.0))
    assert float(held.contact_fraction) > 0.95
    angle = np.degrees(np.arctan2(-float(held.eccentricity_x), -float(held.eccentricity_y)))
    assert angle == pytest.approx(np.degrees(np.arctan(MU)), abs=360.0 / 120.0)
    assert abs(angle) > 10.0
