"""A journal whose axis tilts: forces, moments, 4 by 4 stiffness and damping, and one convention in every verb.

The references are spectral solutions on `H = 1 - (ex + ax z) cos - (ey + ay z) sin` with `z` over R and
slopes over c/R.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil import Case, balance, check, coefficients, curve, orbit, runup, solve, stability, static
from petalfoil.equilibrium.small_motion import ON_LINES
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.results.record import Record
from petalfoil.solvers import sparse_lu
from tests.cases import case
from tests.verification.film_helpers import REFERENCE

R, C, P_A, MU = 25e-3, 25e-6, 1e5, 18.5e-6
NAMES = [f"{row}{column}" for row in "xyab" for column in "xyab"]
GRID = (256, 96)
"""Cells on which the references are met within 0.2 %."""


@cache
def rows(name: str) -> list[dict[str, str]]:
    with (REFERENCE / name).open(newline="") as file:
        return list(csv.DictReader(file))


def journal(row: dict[str, str], cells: tuple[int, int]) -> Case:
    """A plain journal with the numbers of a row of the references."""
    ex, ey, ax, ay = (float(row.get(name, 0.0)) for name in ("ex", "ey", "ax", "ay"))
    return Case(
        bearing={"journal_radius": R, "bushing_radius": R + C, "length": 2.0 * R * float(row["L/D"])},
        gas={"viscosity": MU, "ambient_pressure": P_A},
        surface={"contact_film_thickness": 1e-7},
        operation={
            "speed": float(row["Lam"]) * P_A * C**2 / (6.0 * MU * R**2),
            "eccentricity": (ex * C, ey * C),
            "tilt": (ax * C / R, ay * C / R),
        },
        model={"kind": "3d", "cells_per_pitch": cells[0], "axial_cells": cells[1]},
    )


def force_unit(row: dict[str, str]) -> float:
    return P_A * 4.0 * R**2 * float(row["L/D"])


def matrix(record: Record, name: str) -> np.ndarray:
    """The 4 by 4 matrix in SI units."""
    parts = (name, f"{name}_force_tilt", f"{name}_moment_displacement", f"{name}_moment_tilt")
    a, b, c, d = (record.fields[part][0].astype(float) for part in parts)
    return np.block([[a, b], [c, d]])


# ---------------------------------------------------------------------------------------------- references


FORCES = rows("r2_tilt_forces_LD1.csv")


@pytest.mark.parametrize(
    "number", [1, 3, *(pytest.param(k, marks=pytest.mark.slow) for k in range(len(FORCES)) if k not in (1, 3))]
)
def test_forces_and_moments_of_a_tilted_journal(number: int) -> None:
    row = FORCES[number]
    found = solve.record(journal(row, GRID)).scalars
    force = np.array([found["force_x"], found["force_y"]]) / force_unit(row)
    moment = np.array([found["moment_x"], found["moment_y"]]) / (force_unit(row) * R)
    assert_allclose(force, [float(row["Fx/(pa L D)"]), float(row["Fy"])], rtol=2e-3, atol=1e-9)
    assert_allclose(moment, [float(row["Mx/(pa L D R)"]), float(row["My"])], rtol=2e-3)


COEFFICIENTS = rows("r2_tilt_4x4_LD1.csv")


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(COEFFICIENTS)))
def test_stiffness_and_damping_of_a_tilted_journal(number: int) -> None:
    """Within 0.2 % of the largest entry of each block of force or moment by displacement or tilt."""
    row = COEFFICIENTS[number]
    bearing = journal(row, GRID)
    found, sizes = coefficients.record(bearing, tilt=True), np.array([1.0, 1.0, R, R])
    unit = C / force_unit(row) / np.outer(sizes, sizes)
    for letter, name, factor in (("K", "stiffness", 1.0), ("C", "damping", bearing.operation.speed)):
        expected = np.array([float(row[letter + entry]) for entry in NAMES]).reshape(4, 4)
        actual = matrix(found, name) * unit * factor
        for rows_, columns in ((slice(0, 2), slice(0, 2)), (slice(2, 4), slice(2, 4))):
            block = expected[rows_, columns]
            assert_allclose(actual[rows_, columns], block, rtol=0.0, atol=2e-3 * np.abs(block).max())
        assert_allclose(actual, expected, rtol=0.0, atol=2e-3 * np.abs(expected[:2, :2]).max())


@pytest.mark.parametrize("number", [3, 25, 67])
def test_stiffness_and_damping_of_a_centred_journal(number: int) -> None:
    """Closed form: displacement and tilt do not couple."""
    row = rows("r2_centred_4x4.csv")[2 * (number // 2)]
    tilted = rows("r2_centred_4x4.csv")[2 * (number // 2) + 1]
    bearing = journal(row, (128, 64))
    speed, unit = bearing.operation.speed, C / force_unit(row)
    found = coefficients.record(bearing, [max(float(row["nu"]), 1e-6) * speed], tilt=True)
    K, damping = matrix(found, "stiffness") * unit, matrix(found, "damping") * unit * float(row["nu"]) * speed
    for of, here, size in ((row, slice(0, 2), 1.0), (tilted, slice(2, 4), R**2)):
        pairs = ((K[here, here] / size, "Kxx", "Kyx"), (damping[here, here] / size, "nuCxx", "nuCyx"))
        largest = max(abs(float(of[key])) for key in ("Kxx", "Kyx", "nuCxx", "nuCyx"))
        for actual, direct, cross in pairs:
            expected = [[float(of[direct]), -float(of[cross])], [float(of[cross]), float(of[direct])]]
            assert_allclose(actual, expected, rtol=0.0, atol=2e-3 * largest)
    assert np.abs(K[:2, 2:]).max() < 1e-9 * np.abs(K[:2, :2]).max() * R


def test_stiffness_of_tilt_is_the_derivative_of_the_moments() -> None:
    bearing, step = journal(FORCES[3], (32, 16)), 1e-3 * C / R
    K = matrix(coefficients.record(bearing, [0.0], tilt=True), "stiffness")
    sides = []
    for sign in (1.0, -1.0):
        a_x, a_y = bearing.operation.tilt or (0.0, 0.0)
        found = solve.record(bearing.replace(**{"operation.tilt": (a_x, a_y + sign * step)})).scalars
        sides.append(np.array([float(found[name]) for name in ("force_x", "force_y", "moment_x", "moment_y")]))
    assert_allclose(K[:, 3], -(sides[0] - sides[1]) / (2.0 * step), rtol=1e-5, atol=1e-6 * np.abs(K[:, 3]).max())


# ---------------------------------------------------------------------------------------------- petals


def petals(**changes: object) -> Case:
    grid = {"model.kind": "3d", "model.cells_per_pitch": 8, "model.axial_cells": 4, "petals.theory": "inextensible"}
    return case("paper_n8", **{**grid, "operation.eccentricity": (0.0, -1e-4), **changes})


TILTED = petals(**{"operation.tilt": (5e-4, -2e-4), "operation.load": (0.0, -10.0)})
"""The ends of the journal move by 18 µm."""


@pytest.mark.slow
def test_symmetry_gives_no_moment() -> None:
    """And the whole length of a parallel journal is twice its half."""
    half, whole = (solve.record(of).scalars for of in (petals(), petals(**{"operation.tilt": (0.0, 0.0)})))
    size = abs(float(whole["force_y"])) * petals().bearing.length
    assert abs(float(whole["moment_x"])) < 1e-9 * size
    assert abs(float(whole["moment_y"])) < 1e-9 * size
    assert_allclose(whole["force_y"], half["force_y"], rtol=1e-9)
    assert whole["factorizations"] <= half["factorizations"] + 1


def count(of: Case, *load: float, moment: tuple[float, float] | None = None) -> int:
    """Factorisations of a position, or of the balance with a load."""
    at_rest = of.replace(**{"operation.eccentricity": (0.0, 0.0)})
    found = balance.record(at_rest, (0.0, *load), moment=moment) if load else solve.record(of)
    return int(found.scalars["factorizations"])


@pytest.mark.slow
def test_a_tilt_costs_three_factorisations_at_most() -> None:
    """More than the aligned journal on the same grid, at a position, under a load and under a moment."""
    aligned, tilted = petals(**{"operation.tilt": (0.0, 0.0)}), petals(**{"operation.tilt": (5e-4, -2e-4)})
    assert count(tilted) <= count(aligned) + 3
    most = count(aligned, -10.0) + 3
    assert count(tilted, -10.0) <= most
    assert count(petals(), -10.0, moment=(0.0, 0.02)) <= most  # 23 µm at the ends


def factor_entries(monkeypatch: pytest.MonkeyPatch, question: Callable[[], object]) -> int:
    """Entries of all factors that a question takes, which its time is proportional to."""
    found, factorise = 0, sparse_lu.spla.splu

    def counted(*matrix: object, **options: object) -> object:
        nonlocal found
        lu = factorise(*matrix, **options)
        found += lu.nnz
        return lu

    with monkeypatch.context() as patch:
        patch.setattr(sparse_lu.spla, "splu", counted)
        question()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("load", [(), (-10.0,)], ids=["at a position", "under a load"])
def test_a_whole_length_costs_two_and_a_half_times_its_half_at_most(
    monkeypatch: pytest.MonkeyPatch, load: tuple[float, ...]
) -> None:
    """By counted entries of factors; half of the length is solved first, all but a few factorisations are of that."""
    grid = {"model.cells_per_pitch": 16, "model.axial_cells": 12}
    half, whole = petals(**grid), petals(**grid, **{"operation.tilt": (5e-5, 0.0)})
    counted = [factor_entries(monkeypatch, lambda of=of: count(of, *load)) for of in (half, whole)]
    assert counted[1] <= 2.5 * counted[0]


@pytest.mark.slow
def test_the_moment_that_holds_a_tilt_balances_it() -> None:
    held = balance.record(TILTED).scalars
    moment = (-float(held["moment_x"]), -float(held["moment_y"]))
    free = balance.record(petals(**{"operation.load": (0.0, -10.0)}), moment=moment).scalars
    for name in ("eccentricity_x", "eccentricity_y", "min_film_thickness", "friction_torque"):
        assert_allclose(free[name], held[name], rtol=1e-6)
    assert_allclose([free["tilt_x"], free["tilt_y"]], [5e-4, -2e-4], rtol=1e-6)
    assert_allclose([free["load_moment_x"], free["load_moment_y"]], moment, rtol=1e-12)
    assert float(free["force_residual"]) < 1e-9


@pytest.mark.slow
def test_coefficients_under_a_moment_are_those_of_the_slopes_that_it_makes() -> None:
    held = balance.record(TILTED).scalars
    moment = (-float(held["moment_x"]), -float(held["moment_y"]))
    free = TILTED.replace(**{"operation.tilt": None, "operation.moment": moment, "operation.eccentricity": (0.0, 0.0)})
    at_rest = TILTED.replace(**{"operation.eccentricity": (0.0, 0.0)})
    one, other = (coefficients.record(of, [3000.0]) for of in (at_rest, free))
    assert_allclose(one.fields["stiffness"], other.fields["stiffness"], rtol=1e-6)
    both = coefficients.record(free, [3000.0], tilt=True)
    assert_allclose(both.fields["stiffness"], one.fields["stiffness"], rtol=1e-6)


@pytest.mark.slow
def test_coefficients_with_tilt_are_those_of_the_contact_lines_under_a_load() -> None:
    # 6 cells over the length: lines and contacts at nodes balance the load at positions 10 um apart
    grid = {"model.cells_per_pitch": 12, "model.axial_cells": 6}
    loaded = case("paper_n8_spatial", **grid, **{"operation.load": (0.0, -5.0)})
    half, whole = coefficients.record(loaded), coefficients.record(loaded, tilt=True)
    assert half.scalars["contact_model"] == whole.scalars["contact_model"] == ON_LINES
    for name in ("stiffness", "damping"):
        assert_allclose(whole.fields[name], half.fields[name], rtol=0.0, atol=1e-8 * np.max(np.abs(half.fields[name])))


@pytest.mark.slow
def test_coefficients_with_contact_lines_under_a_moment_are_those_of_its_slopes() -> None:
    grid = {"model.cells_per_pitch": 12, "model.axial_cells": 6}
    free = case("paper_n8_spatial", **grid, **{"operation.load": (0.0, -5.0), "operation.moment": (0.02, 0.01)})
    found = balance.record(free).scalars
    slopes = (found["tilt_x"], found["tilt_y"])
    one = coefficients.record(free)
    other = coefficients.record(free.replace(**{"operation.moment": None, "operation.tilt": slopes}))
    assert one.scalars["contact_model"] == other.scalars["contact_model"] == ON_LINES
    assert_allclose(one.fields["stiffness"], other.fields["stiffness"], rtol=1e-6, atol=0.1)


@pytest.mark.slow
def test_every_verb_knows_the_tilt() -> None:
    placed = TILTED.replace(**{"operation.load": None})
    alone = solve.record(placed).scalars
    assert_allclose(curve(placed, [0.5e-4, 1e-4])["moment_x"].values[-1], alone["moment_x"], rtol=1e-6)
    assert_allclose(static(placed, [1e-4])["moment_x"].values[0], alone["moment_x"], rtol=0.5)
    way = runup(TILTED.replace(**{"operation.eccentricity": (0.0, 0.0)}), to=500.0, points=3)
    assert_allclose(way["tilt_x"], 5e-4, rtol=1e-12)
    assert np.all(way["moment_x"].values < 0.0)
    assert_allclose(float(check(placed)["radial_clearance"]), placed.radial_clearance, rtol=1e-12)
    moved = orbit(placed.replace(rotor={"mass": 1.0}), revolutions=0.02)
    assert float(moved["mass_balance_error"]) < 1e-6
    assert "tilt_x" in stability.record(placed).scalars


# ---------------------------------------------------------------------------------------------- refusals


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"model.kind": "2d"}, 'operation.tilt: needs the length of the bearing; allowed: model.kind = "3d"'),
        ({"model.method": "classic"}, "operation.tilt: is not in the paper"),
        ({"operation.moment": (0.0, 1.0)}, "operation.moment: is given beside operation.tilt"),
        ({"operation.tilt": (1.0, 0.0)}, "operation.tilt"),
        ({"operation.tilt": (0.05, 0.0)}, "operation.eccentricity: the journal displaced by"),
    ],
)
def test_a_tilt_that_has_no_meaning_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(DefinitionError) as refused:
        TILTED.replace(**changes)
    assert words in str(refused.value)


def test_a_moment_without_a_load_is_refused() -> None:
    under = petals(**{"operation.moment": (0.0, 0.1)})
    with pytest.raises(UsageError, match="balanced together with a load"):
        solve(under)
    with pytest.raises(UsageError, match=r"operation\.tilt"):
        curve(under, [1e-4])
    with pytest.raises(UsageError, match="stays parallel"):
        orbit(under.replace(rotor={"mass": 1.0}))
