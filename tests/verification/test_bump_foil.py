"""A bump foil: the spring of one bump, static load, stiffness and damping against tables, limits, its loss in time.

The tables solve `H = 1 + eps cos(theta) + alpha (P - 1)`, in a whirl with `alpha / (1 + i gamma)`, spectrally.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import petalfoil
from petalfoil.case import Case
from petalfoil.physics.bump_strip import BumpStrip
from petalfoil.system.build import build_problem
from petalfoil.system.time_step import StepProblem
from tests.cases import case
from tests.contract.taylor import assert_tangent, open_state
from tests.verification.film_helpers import table

Row = dict[str, float]

WITHIN = 3e-3
"""Stated error of load, attitude, stiffness and damping on the default grid."""

STATIC = [{name: float(value) for name, value in row.items()} for row in table("r3_bump_static_LD1.csv")]
DYNAMIC = [{name: float(value) for name, value in row.items()} for row in table("r3_bump_KC_LD1.csv")]
LINK_SPRINGS = [{name: float(value) for name, value in row.items()} for row in table("r3_link_spring.csv")]

QUICK = [(5.0, 0.8)]
"""Bearing number and relative eccentricity of the row of the fast suite, the one that is missed by most."""
SLOW = [pair for pair in product((1.0, 5.0), (0.2, 0.4, 0.6, 0.8)) if pair not in QUICK]


def bumps(row: Row, **changes: object) -> Case:
    """The example at a row of the tables, without contact."""
    base = case("bump_foil", **{"surface.contact_film_thickness": "10 nm"})
    c, R_j, p_a = base.bearing.clearance, base.bearing.journal_radius, base.gas.ambient_pressure
    speed = row["Lam"] * p_a * c**2 / (6.0 * base.gas.viscosity * R_j**2)
    operation = {"operation.speed": speed, "operation.eccentricity": (0.0, -row["eps"] * c)}
    foil = {"bump_foil.foundation_stiffness": p_a / (row["alpha"] * c), "bump_foil.loss_factor": row.get("gamma", 0.0)}
    return base.replace(**operation, **foil, **changes)


def unit_force(of: Case) -> float:
    """`p_a L D` [N]."""
    return of.gas.ambient_pressure * of.bearing.length * 2.0 * of.bearing.journal_radius


# ---------------------------------------------------------------------------------------------- one bump


@pytest.mark.parametrize("row", LINK_SPRINGS, ids=lambda row: f"{row['t_m']}-{row['t0_rad']}")
def test_the_spring_of_a_bump(row: Row) -> None:
    bump = BumpStrip(row["half_chord_m"], row["t0_rad"], row["t_m"], row["D_N_m"])
    unit, free = 6.0 * bump.rigidity / bump.half_length**3, bump.free_stiffness  # of a shallow bump, and of this one
    assert_allclose(bump.integrals, [row["A"], row["B"], row["C"]], rtol=1e-8)
    assert free / unit == pytest.approx(row["K_free/(6D/l^3)"], rel=1e-8)
    assert bump.held_stiffness(membrane=False) / unit == pytest.approx(row["K_held/(6D/l^3)"], rel=1e-8)
    assert bump.held_stiffness() / unit == pytest.approx(row["K_held with membrane/(6D/l^3)"], rel=1e-8)
    assert bump.sticking_friction == pytest.approx(row["B/C (sticks above)"], rel=1e-8)
    for friction, loading, name in ((0.1, True, "load_mu0.1"), (0.1, False, "unload_mu0.1"), (0.3, True, "load_mu0.3")):
        sliding = bump.sliding_stiffness(friction, loading=loading) / free
        assert sliding == pytest.approx(row[f"K_{name}/K_free"], rel=1e-8)
    held = 1.0 / bump.held_stiffness(membrane=False)
    out, back = (1.0 / bump.sliding_stiffness(0.1, loading=loading) for loading in (True, False))
    loop = 0.5 * (back - out) * (out - held) / (back - held)  # feet slide out, stick, and slide back
    assert loop == pytest.approx(row["loop area mu0.1 P 0..1 N/m (J/m)"], rel=1e-6)


def test_feet_that_stick_do_not_slide() -> None:
    bump = BumpStrip(1.778e-3, 0.9, 0.1016e-3, 0.0204)
    with pytest.raises(ValueError, match=r"they slide below 1\.54"):
        bump.sliding_stiffness(1.6, loading=True)


# ---------------------------------------------------------------------------------------------- static


def assert_static(pair: tuple[float, float]) -> None:
    """Load and attitude of a row."""
    (row,) = (row for row in STATIC if row["alpha"] == 1.0 and (row["Lam"], row["eps"]) == pair)
    bearing = bumps(row)
    point = petalfoil.solve(bearing)
    assert float(point["residual"]) <= 1e-8
    assert float(point["bearing_force"]) / unit_force(bearing) == pytest.approx(row["W/(pa L D)"], rel=WITHIN)
    assert math.degrees(float(point["attitude_angle"])) == pytest.approx(row["attitude_deg"], rel=WITHIN)


@pytest.mark.parametrize("pair", QUICK)
def test_static_load_and_attitude(pair: tuple[float, float]) -> None:
    assert_static(pair)


@pytest.mark.slow
@pytest.mark.parametrize("pair", SLOW)
def test_static_load_and_attitude_of_all_rows(pair: tuple[float, float]) -> None:
    assert_static(pair)


def test_the_foil_gives_way_by_the_excess_pressure_and_follows_suction() -> None:
    bearing = bumps(STATIC[8], **{"model.cells_per_pitch": 24, "model.axial_cells": 8})
    point = petalfoil.solve(bearing)
    excess = point["pressure"].to_numpy() - bearing.gas.ambient_pressure
    assert excess.min() < -1e3
    assert point["deflection"].to_numpy() == pytest.approx(excess / 4e9, rel=1e-9, abs=1e-15)
    assert float(point["max_deflection"]) == pytest.approx(excess.max() / 4e9, rel=1e-9)


def test_a_stiff_foil_is_a_plain_bearing() -> None:
    grid = {"model.cells_per_pitch": 32, "model.axial_cells": 16}
    bearing = bumps(STATIC[8], **grid)
    plain = float(petalfoil.solve(bearing.replace(bump_foil=None, **{"model.axial_grading": 0.6}))["bearing_force"])
    missing = [
        float(petalfoil.solve(bearing.replace(**{"bump_foil.foundation_stiffness": k}))["bearing_force"]) / plain - 1.0
        for k in (4e13, 4e15)
    ]
    assert abs(missing[1]) < 2e-6
    assert missing[0] / missing[1] == pytest.approx(100.0, rel=1e-2)


# ---------------------------------------------------------------------------------------------- small motions


def impedances_of(Lam: float, eps: float, gamma: float) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """`Z c / (p_a L D)` over the whirl ratios of the table, in the frame of the load: ours and the table's."""
    rows = [row for row in DYNAMIC if row["alpha"] == 1.0 and row["nu"] > 0.0]
    rows = [row for row in rows if (row["Lam"], row["eps"], row["gamma"]) == (Lam, eps, gamma)]
    bearing = bumps(rows[0])
    frequencies = np.array([row["nu"] for row in rows]) * bearing.operation.speed
    found = petalfoil.coefficients(bearing, frequencies=list(frequencies))
    Z = found["stiffness"].to_numpy() + 1j * frequencies[:, None, None] * found["damping"].to_numpy()
    point = petalfoil.solve(bearing)
    load = -np.array([float(point["force_x"]), float(point["force_y"])])
    along = load / np.linalg.norm(load)
    frame = np.array([along, [-along[1], along[0]]])
    entries = [[[row[f"K{i}{j}"] + 1j * row[f"nuC{i}{j}"] for j in "xy"] for i in "xy"] for row in rows]
    return frame @ Z @ frame.T * bearing.bearing.clearance / unit_force(bearing), np.array(entries)


def assert_impedances(Lam: float, eps: float, gamma: float) -> None:
    """All entries within the stated error of the largest."""
    found, known = impedances_of(Lam, eps, gamma)
    assert np.max(np.abs(found - known), axis=(1, 2)) == pytest.approx(0.0, abs=WITHIN * np.max(np.abs(known)))


def test_stiffness_and_damping_with_structural_loss() -> None:
    assert_impedances(1.0, 0.6, 0.6)


@pytest.mark.slow
@pytest.mark.parametrize(("Lam", "eps", "gamma"), list(product((1.0, 5.0), (0.2, 0.6), (0.0, 0.6))))
def test_stiffness_and_damping_of_all_rows(Lam: float, eps: float, gamma: float) -> None:
    assert_impedances(Lam, eps, gamma)


def test_one_reduced_model_serves_all_frequencies_of_a_foil_with_loss() -> None:
    bearing = case("bump_foil", **{"model.cells_per_pitch": 24, "model.axial_cells": 8})
    each = [300.0, 700.0, 1200.0, 2500.0]
    together = petalfoil.coefficients(bearing, frequencies=each)
    for k, frequency in enumerate(each):
        alone = petalfoil.coefficients(bearing, frequencies=[frequency])
        for name in ("stiffness", "damping"):
            assert_allclose(together[name][k], alone[name][0], rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_a_synchronous_whirl_in_time_is_the_linear_one(loss: float) -> None:
    mass, unbalance, load = 0.2, 2e-7, (0.0, -30.0)
    changes = {"model.cells_per_pitch": 24, "model.axial_cells": 8, "bump_foil.loss_factor": loss}
    bearing = case("bump_foil", **changes, rotor={"mass": mass, "unbalance": unbalance})
    speed = bearing.operation.speed
    linear, modes = petalfoil.coefficients(bearing, load=load), petalfoil.stability(bearing, load=load, mass=mass)
    Z = linear["stiffness"].to_numpy()[0] + 1j * speed * linear["damping"].to_numpy()[0]
    whirl = np.linalg.solve(Z - mass * speed**2 * np.eye(2), mass * unbalance * speed**2 * np.array([1.0, -1.0j]))
    motion = petalfoil.orbit(bearing, revolutions=10, load=load, initial="balance", tolerance=1e-4)
    angle = motion["shaft_angle"].to_numpy()
    late = angle > 6.0 * np.pi
    slowest = complex(float(modes["mode_growth_rate"][0]), float(modes["natural_frequency"][0]))
    dying, turning = np.exp(slowest * motion["time"].to_numpy()[late]), np.exp(1j * angle[late])
    parts = np.column_stack([np.ones(late.sum()), turning.real, -turning.imag, dying.real, dying.imag])
    for name, expected in zip("xy", whirl, strict=True):
        found = np.linalg.lstsq(parts, motion[name].to_numpy()[late], rcond=None)[0]
        assert complex(found[1], found[2]) == pytest.approx(expected, rel=5e-3)
    assert float(motion["energy_balance_error"]) < 1e-4
    assert (float(motion["petal_friction_work"][-1]) > 0.0) == (loss > 0.0)


# ---------------------------------------------------------------------------------------------- top foil


def test_a_top_foil_bends_around_the_shaft() -> None:
    """`W = cos(2 theta)` needs `k_b + D_t 2^4 / R^4`, up to the second order of the cells."""
    changes = {"model.kind": "2d", "model.cells_per_pitch": 256}
    metal = {"bump_foil.youngs_modulus": 2.1e11, "bump_foil.poisson_ratio": 0.29}
    bearing = case("bump_foil", **changes, **metal, **{"bump_foil.top_foil_thickness": "2 mm"})
    layout = build_problem(bearing).layout
    theta, wall = layout.wall.film.theta[0], layout.wall
    force = wall.elasticity.force(np.cos(2.0 * theta)) / wall.load_area[0, :, 0]
    rigidity = 2.1e11 * 2e-3**3 / 12.0 / (1.0 - 0.29**2)
    stiffness = 4e9 + rigidity * 16.0 / bearing.bearing.bushing_radius**4
    inside = slice(3, -3)  # the ends of the foil are free
    assert_allclose(force[inside], stiffness * np.cos(2.0 * theta)[inside], atol=1e-3 * stiffness)
    assert_allclose(wall.elasticity.force(np.ones(len(theta))) / wall.load_area[0, :, 0], 4e9, rtol=1e-9)


def test_the_tangent_of_a_step_knows_the_loss() -> None:
    layout = build_problem(case("bump_foil", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})).layout
    rng = np.random.default_rng(7)
    step = StepProblem(layout, 1.0, np.zeros(2), 1.0, 30.0, np.zeros(layout.wall.film.n_unknown + layout.n_wall))
    x, direction = open_state(step, rng), rng.uniform(-1.0, 1.0, layout.n)
    tangent = step.linearize(x).matrix(np.zeros(len(layout.weight)))
    assert_tangent(lambda t: step.linearize(x + t * direction).residual, tangent @ direction)
    free = replace(step, rate=0.0).linearize(x).residual
    at_rate = step.linearize(x).residual - free
    assert_allclose(at_rate[: layout.n_wall], 30.0 * 0.2 * (layout.stiffness @ x[: layout.n_wall]), rtol=1e-9)


def test_check_tells_no_clearance_above_a_foil_without_a_solid_height() -> None:
    assert "pack_clearance" not in petalfoil.check(case("bump_foil"))
    assert "pack_clearance" in petalfoil.check(case("paper_n8"))
