"""Implausible answers carry warnings: in the dataset, and through every kind of analysis."""

from __future__ import annotations

import pytest

import petalfoil
from petalfoil.analysis.runup import runup
from petalfoil.case import Case
from tests.cases import FAULTS, case


@pytest.mark.slow
def test_a_stress_of_14_GPa_is_told() -> None:
    ds = petalfoil.static(Case.load(FAULTS / "stress_14GPa.toml"))
    (warning,) = [line for line in ds.attrs["warnings"].splitlines() if line.startswith("max_bending_stress: ")]
    assert "GPa" in warning


@pytest.mark.slow
def test_contact_is_told_at_the_speed_of_the_case_and_not_on_the_way_there() -> None:
    loaded = case("paper_n8", **{"model.cells_per_pitch": 16})
    records = list(runup.records(loaded, 50.0, to=0.1 * loaded.operation.speed, points=3))
    assert max(float(record.scalars["contact_fraction"]) for record in records) > 0.5
    told_of_contact = [any(text.startswith("contact_fraction") for text in record.warnings) for record in records]
    assert not any(told_of_contact)
    record = petalfoil.balance(loaded, 50.0, speed=loaded.operation.speed)
    told = record.attrs.get("warnings", "")
    assert ("contact_fraction: " in told) is (float(record["contact_fraction"]) > 1e-3)
