"""Stiffness and damping: the plain journal in closed form, petals against differences of equilibria, what they cost."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.stability import stability
from petalfoil.case import Case
from petalfoil.equilibrium.continuation import follow
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from tests.cases import case

Array = NDArray[np.float64]

# ---------------------------------------------------------------------------------------------- plain journal

RATIOS = (0.0, 0.5, 1.0, 2.0)
GRIDS = ((64, 32), (128, 64), (256, 128))
"""Cells round the circle and over the whole length."""

TOLERANCE = 2e-3
"""On the middle grid, of the size of the impedance at that whirl ratio; 1.2e-3 when this was written."""


def plain(grid: tuple[int, int], e: tuple[float, float] = (0.0, 0.0)) -> Case:
    sizes = {"model.cells_per_pitch": grid[0], "model.axial_cells": grid[1]}
    return case("plain_journal", **sizes, **{"operation.eccentricity": e})


def closed_form(plain_case: Case, nu: float) -> NDArray[np.complex128]:
    """`Z = K + i Omega C` of the centred journal (reference/README): a whirl each way, `b = Lam (2 nu +- 1)`."""
    bearing, gas = plain_case.bearing, plain_case.gas
    c, L, D = bearing.bushing_radius - bearing.journal_radius, bearing.length, 2.0 * bearing.journal_radius
    omega, p_a = plain_case.operation.speed, gas.ambient_pressure
    Lam = 6.0 * gas.viscosity * omega * bearing.journal_radius**2 / (p_a * c**2)

    def G(b: float) -> complex:
        g = np.sqrt(1.0 + 1j * b)
        return complex(1j * b / (1.0 + 1j * b) * (1.0 - np.tanh(g * L / D) / (g * L / D)))

    with_it, against = G(Lam * (2.0 * nu + 1.0)), G(Lam * (2.0 * nu - 1.0))
    direct, cross = 0.25 * math.pi * (with_it + against), 0.25j * math.pi * (with_it - against)
    return np.array([[direct, -cross], [cross, direct]]) * p_a * L * D / c


def impedances(record: Record) -> NDArray[np.complex128]:
    """`K + i Omega C`, (frequency, row, column)."""
    Omega = record.coords["whirl_frequency"].astype(float)[:, None, None]
    return record.fields["stiffness"].astype(complex) + 1j * Omega * record.fields["damping"].astype(complex)


def centred_errors(grid: tuple[int, int]) -> Array:
    bearing = plain(grid)
    found = impedances(coefficients.record(bearing, [nu * bearing.operation.speed for nu in RATIOS]))
    wanted = [closed_form(bearing, nu) for nu in RATIOS]
    return np.array([np.max(np.abs(Z - Y)) / np.max(np.abs(Y)) for Z, Y in zip(found, wanted, strict=True)])


def test_centred_plain_journal_has_its_closed_form() -> None:
    """Second order, and within 0.2 % on 128 × 64 cells, at whirl ratios 0, 0.5, 1 and 2."""
    errors = np.array([centred_errors(grid) for grid in GRIDS])
    assert np.all(errors[1] <= TOLERANCE)
    assert np.all(np.log2(errors[:-1] / errors[1:]) >= 1.9)


def test_damping_at_rest_is_the_limit_of_slow_whirl() -> None:
    bearing = plain((64, 32), (3e-6, -8e-6))
    Omega = bearing.operation.speed
    C = coefficients.record(bearing, [0.0, 1e-3 * Omega, 2e-3 * Omega]).fields["damping"]
    limit = C[1] - (C[2] - C[1]) / 3.0  # C depends on the square of the frequency
    assert_allclose(C[0], limit, rtol=1e-8, atol=0.0)


def test_a_displacement_across_the_line_of_centres_turns_the_force() -> None:
    """Exactly, but for the grid, which does not turn with it: 2e-4 of the force on 128 cells round the circle."""
    e = 10e-6
    bearing = plain((128, 16), (0.0, -e))
    problem = build_problem(bearing)
    record = coefficients.record(bearing, [0.0])
    K = record.fields["stiffness"][0]
    answer = operating(bearing)
    F = problem.journal_force(answer.x, answer.lam) * problem.layout.scales.force
    turned = np.array([-F[1], F[0]]) / e
    assert_allclose(-K[:, 0], turned, rtol=0.0, atol=3e-4 * float(np.hypot(*turned)))


def operating(bearing: Case) -> Solution:
    answer = operating_point(bearing, None).answer
    return answer


def test_centred_plain_journal_whirls_at_half_its_speed_however_light() -> None:
    """Neutral for no mass at all; a nanometre off, ratio and mass go to 1/2 and 0 with the square of the cell."""
    centred = stability.record(plain((64, 32))).scalars
    assert (centred["whirl_ratio"], centred["critical_mass"]) == (0.5, 0.0)
    coarse, fine = (stability.record(plain(grid, (0.0, -1e-9))).scalars for grid in ((64, 32), (128, 64)))
    ratio, mass = np.array([[run["whirl_ratio"], run["critical_mass"]] for run in (coarse, fine)], dtype=float).T
    assert_allclose(ratio[1], 0.5, rtol=0.0, atol=3e-4)
    assert np.log2((0.5 - ratio[0]) / (0.5 - ratio[1])) >= 1.9
    assert np.log2(mass[0] / mass[1]) >= 1.9


# ---------------------------------------------------------------------------------------------- petals

PETALS = {"model.cells_per_pitch": 32}


def balanced(speed: float, load: float) -> Solution:
    bearing = case("paper_n8", **PETALS, **{"operation.speed": speed, "operation.eccentricity": (0.0, 0.0)})
    problem = build_problem(bearing)
    return balance_cold(problem, np.array([0.0, -load]) / problem.layout.scales.force)


def differences(answer: Solution, step: float) -> Array:
    """`-dF/de` from equilibria on either side, which keep the contacts of `answer` [unit of force over length]."""
    columns = []
    for k in (0, 1):
        forces = []
        for side in (-step, step):
            moved = answer.problem.displacement.copy()
            moved[k] += side
            near = follow(answer, answer.problem.at(displacement=moved))
            assert near is not None
            assert np.array_equal(near.active, answer.active)
            forces.append(near.problem.journal_force(near.x, near.lam))
        columns.append(-(forces[1] - forces[0]) / (2.0 * step))
    return np.column_stack(columns)


@pytest.mark.parametrize(("speed", "load", "touching"), [(8000.0, 20.0, False), (800.0, 20.0, True)])
def test_stiffness_of_petals_is_the_slope_of_equilibria(speed: float, load: float, touching: bool) -> None:
    """With contacts at nodes within 1e-5 of its size, contacts of the journal closed or not; 4e-9 when written."""
    answer = balanced(speed, load)
    journal = answer.problem.layout.wall.contacts.journal
    assert bool(answer.active[journal].any()) == touching
    scales = answer.problem.layout.scales
    K, _ = impedance(SmallMotion.at_nodes(answer), 0.0, speed)
    slope = differences(answer, 1e-4) * scales.force / scales.length
    assert_allclose(K, slope, rtol=0.0, atol=1e-5 * float(np.max(np.abs(slope))))


@pytest.mark.slow
def test_impedance_of_petals_solves_the_equations_linearised_by_differences() -> None:
    """`dF` of a whirl, from finite differences of the residual and of the stored mass alone.

    Independent of tangents and ties: `(J + i nu M) dx = -(F_e + i nu M_e) de` is put together column by column from the
    values at `x + d`, in the motions that keep closed gaps closed.
    """
    bearing = case("paper_n8", **{"model.cells_per_pitch": 16, "operation.speed": 8000.0})
    bearing = bearing.replace(**{"operation.eccentricity": (0.0, -30e-6)})
    answer = operating(bearing)
    assert not answer.active[answer.problem.layout.wall.contacts.journal].any()
    nu = 0.7
    K, C = impedance(SmallMotion.at_nodes(answer), nu * 8000.0, 8000.0)
    Z = by_differences(answer, nu) * answer.problem.layout.scales.force / answer.problem.layout.scales.length
    assert_allclose(K + 1j * nu * 8000.0 * C, Z, rtol=0.0, atol=1e-5 * float(np.max(np.abs(Z))))


def by_differences(answer: Solution, nu: float, step: float = 1e-5) -> NDArray[np.complex128]:
    problem, closed = answer.problem, answer.active
    G = problem.G.toarray()[closed]
    _, sizes, rows = np.linalg.svd(G)
    free = rows[int((sizes > 1e-10).sum()) :].T  # motions that keep closed gaps closed

    def both(x: Array, e: Array) -> NDArray[np.complex128]:
        at = problem.at(displacement=e)
        steady = at.linearize(x).residual.astype(complex)
        layout = at.layout
        PH = at.pressure(x) * at.film(x)
        held = np.bincount(
            np.where(
                layout.balance.mesh.unknown >= 0, layout.balance.mesh.unknown, layout.balance.mesh.n_unknown
            ).ravel(),
            weights=(2.0 * at.bearing_number * PH * layout.balance.area).ravel(),
            minlength=layout.balance.mesh.n_unknown + 1,
        )[:-1]
        steady[layout.n_wall :] += 1j * nu * held
        return steady

    def slope(dx: Array, de: Array) -> NDArray[np.complex128]:
        ahead = both(answer.x + step * dx, problem.displacement + step * de)
        behind = both(answer.x - step * dx, problem.displacement - step * de)
        return (ahead - behind) / (2.0 * step)

    still = np.zeros(2)
    matrix = free.T @ np.column_stack([slope(free[:, k], still) for k in range(free.shape[1])])
    forces = []
    for de in np.eye(2):
        dx = free @ np.linalg.solve(matrix, -(free.T @ slope(np.zeros(len(answer.x)), de)))
        dP = dx[problem.positive]
        forces.append(problem.border.row_derivative @ dP)
    return -np.column_stack(forces)


# ---------------------------------------------------------------------------------------------- cost, refusals


def test_twenty_frequencies_cost_one_factorisation_more_than_one() -> None:
    """A real one for the reduced model and a complex one that checks it, for the complex one of a single frequency."""
    bearing = case("paper_n8", **PETALS)
    few, many = (coefficients.record(bearing, np.linspace(0.0, 9e3, n).tolist(), load=(0.0, -20.0)) for n in (1, 20))
    counts = [int(run.scalars["probe_factorizations"]) for run in (few, many)]
    assert counts[1] - counts[0] == 1
    assert counts[1] <= 4


@pytest.mark.slow
def test_the_reduced_model_gives_what_the_equations_give() -> None:
    """Within 1e-9 of the largest entry at every frequency, the checked ones and those between."""
    bearing = case("paper_n8", **PETALS)
    frequencies = np.linspace(0.0, 24e3, 13)
    many = coefficients.record(bearing, frequencies.tolist(), load=(0.0, -20.0))
    one_by_one = [coefficients.record(bearing, [frequency], load=(0.0, -20.0)) for frequency in frequencies]
    for Z, single in zip(impedances(many), one_by_one, strict=True):
        (exact,) = impedances(single)
        assert_allclose(Z, exact, rtol=0.0, atol=1e-9 * float(np.max(np.abs(exact))))
    row = next(row for row in many.history if row["phase"] == "reduced model")
    assert float(row["error"]) <= 1e-9


def test_over_speeds_each_point_is_that_of_a_run() -> None:
    bearing = plain((32, 8), (0.0, -5e-6))
    records = list(coefficients.records(bearing, [500.0], speeds=[1000.0, 2000.0]))
    alone = [coefficients.record(bearing, [500.0], speed=speed) for speed in (1000.0, 2000.0)]
    for together, single in zip(records, alone, strict=True):
        assert_allclose(together.fields["stiffness"], single.fields["stiffness"], rtol=1e-12, atol=0.0)


def test_what_cannot_be_asked() -> None:
    bearing = plain((32, 8))
    with pytest.raises(UsageError, match="turning shaft"):
        coefficients.record(bearing, [100.0], speed=0.0)
    with pytest.raises(UsageError, match="slopes of the axis need the length"):
        coefficients.record(case("paper_n8"), [100.0], tilt=True)
    with pytest.raises(UsageError, match=r"frequencies: .* at least 0 rad/s"):
        coefficients.record(bearing, [-1.0])
    with pytest.raises(UsageError, match=r"mass: .* greater than 0 kg"):
        stability.record(bearing, mass=0.0)
    with pytest.raises(UsageError, match="no load"):
        stability.records(bearing, speeds=[1000.0])


def test_petals_pressed_solid_have_no_coefficients() -> None:
    with pytest.raises(ConvergenceError, match="bottomed-out pack"):
        coefficients.record(case("paper_n8", **PETALS), load=(0.0, -600.0))


# ---------------------------------------------------------------------------------------------- stability


@pytest.mark.slow
def test_threshold_speed_is_where_the_critical_mass_is_the_rotor_s() -> None:
    bearing, load = plain((24, 8)), (0.0, -30.0)
    found = stability.record(bearing, load=load, mass=0.5, speed=1800.0)
    threshold = float(found.scalars["threshold_speed"])
    there = stability.record(bearing, load=load, speed=threshold)
    assert_allclose(float(there.scalars["critical_mass"]), 0.5, rtol=5e-3, atol=0.0)


def test_without_a_load_the_status_says_why_there_is_no_threshold() -> None:
    found = stability.record(plain((32, 8), (0.0, -10e-6))).scalars
    assert math.isnan(float(found["threshold_speed"]))
    assert "give a mass or a load" in str(found["status"])


@pytest.mark.slow
def test_a_chart_agrees_with_single_points() -> None:
    bearing = plain((24, 6))
    records = list(stability.records(bearing, speeds=[1000.0, 2000.0], loads=[5.0, 20.0]))
    assert [(r.scalars["load_y"], r.scalars["speed"]) for r in records] == [
        (-5.0, 1000.0),
        (-5.0, 2000.0),
        (-20.0, 1000.0),
        (-20.0, 2000.0),
    ]
    single = stability.record(bearing, load=(0.0, -20.0), speed=2000.0).scalars
    for name in ("critical_mass", "whirl_ratio"):
        assert_allclose(float(records[3].scalars[name]), float(single[name]), rtol=1e-6, atol=0.0)
