"""A bearing without a load, as on a vertical shaft: the equilibrium at zero force, and what whirls there."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.balance import balance
from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.orbit import orbit
from petalfoil.analysis.solve import solve
from petalfoil.analysis.stability import stability
from petalfoil.case import Case
from tests.cases import FAULTS, case

SMALL = {"model.cells_per_pitch": 32, "model.axial_cells": 8}
PLAIN = Case.load(FAULTS / "zero_load.toml").replace(**SMALL)
PETALS = case(
    "paper_n8",
    **{"model.cells_per_pitch": 16, "operation.eccentricity": (0.0, 0.0), "operation.load": (0.0, 0.0)},
)


@pytest.mark.parametrize("bearing", [PLAIN, PETALS], ids=["plain", "petals"])
def test_the_journal_is_where_no_force_is(bearing: Case) -> None:
    for verb in (balance, solve):
        record = verb.record(bearing)
        assert float(record.scalars["bearing_force"]) < 1e-9
        assert float(record.scalars["force_residual"]) < 1e-9
        assert math.hypot(*(float(record.scalars[f"eccentricity_{axis}"]) for axis in "xy")) < 1e-12
        assert record.scalars["load_y"] == 0.0


def test_stiffness_and_damping_are_those_of_the_centre() -> None:
    found = coefficients.record(PLAIN).fields["stiffness"]
    centred = coefficients.record(PLAIN.replace(**{"operation.load": None})).fields["stiffness"]
    assert_allclose(found, centred, rtol=1e-9, atol=1e-3)


@pytest.mark.parametrize("mass", [None, 0.003, 3.0])
def test_a_centred_plain_bearing_has_critical_mass_zero(mass: float | None) -> None:
    """The discrete equations gave 0.0032 kg."""
    found = stability.record(PLAIN, mass=mass).scalars
    assert (found["critical_mass"], found["whirl_ratio"]) == (0.0, 0.5)
    assert math.isnan(float(found["threshold_speed"]))
    assert "whirls at half the speed at any speed and rotor mass" in str(found["status"])


def test_a_displaced_journal_and_petals_have_another_critical_mass() -> None:
    displaced = PLAIN.replace(**{"operation.load": None, "operation.eccentricity": (0.0, -5e-6)})
    for bearing in (displaced, PETALS):
        found = stability.record(bearing).scalars
        assert float(found["critical_mass"]) > 0.0
        assert "at any speed and rotor mass" not in str(found["status"])


@pytest.mark.slow
@pytest.mark.parametrize("mass", [0.001, 2.0, 100.0])
def test_a_long_plain_bearing_under_a_light_load_is_unstable_for_any_mass(mass: float) -> None:
    """Its branch turns real at a negative stiffness: a rotor whose mode grows was called stable."""
    bearing = case("plain_journal", **{"model.kind": "2d", "model.cells_per_pitch": 24})
    found = stability.record(bearing, load=(0.0, -60.0), mass=mass)
    assert found.scalars["critical_mass"] == 0.0
    assert "unstable for any rotor mass" in str(found.scalars["status"])
    assert max(found.fields["mode_growth_rate"]) > 50.0
    assert float(found.scalars["threshold_speed"]) < 370.0


def test_the_exact_force_of_half_speed_whirl_is_none() -> None:
    """Stiffness and cross-coupled damping cancel at half the speed as the square of the cells: 0 is their limit."""
    left = []
    for cells in (32, 64):
        bearing = PLAIN.replace(**{"model.cells_per_pitch": cells, "model.axial_cells": cells // 4})
        speed = bearing.operation.speed
        fields = coefficients.record(bearing, [0.5 * speed]).fields
        K, C = (np.asarray(fields[name][0], dtype=float) for name in ("stiffness", "damping"))
        Z = K + 0.5j * speed * C
        left.append(float(np.min(np.abs(np.linalg.eigvals(Z))) / np.max(np.abs(Z))))
    assert left[1] < 0.02
    assert left[0] / left[1] > 3.5


def test_a_motion_begins_at_the_equilibrium_without_a_load() -> None:
    ds = orbit(PLAIN.replace(rotor={"mass": 1.0}), initial="balance", revolutions=0.05)
    assert float(np.hypot(ds["x"], ds["y"]).max()) < 1e-12
