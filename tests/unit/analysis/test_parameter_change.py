"""Changes of parameters: fractions, quantities, one for each; refusals, and doubts of effects that are too large."""

from __future__ import annotations

import math
from typing import Any

import pytest

from petalfoil.analysis.parameter_change import Changes, ParameterChanges
from petalfoil.analysis.sensitivity_table import FAR, SensitivityRow
from petalfoil.case import parameter_of
from petalfoil.errors import UnitError, UsageError
from tests.cases import case

RIG = case("rig")
STEP = ParameterChanges(help="")


def change(given: Any, path: str) -> tuple[float, str]:
    changes = Changes({} if given is None else STEP.read(given))
    changes.check([parameter_of(RIG, path)])
    return changes.of(RIG, parameter_of(RIG, path), 1.0)


@pytest.mark.parametrize(
    ("given", "path", "size", "words"),
    [
        (None, "petals.thickness", 1.5e-6, "1 %"),
        (None, "bearing.bushing_radius", 3.436e-6, "+3.436 µm (1 % of the clearance)"),
        ("1 %", "bearing.bushing_radius", 289.75e-6, "1 %"),
        (0.02, "petals.thickness", 3e-6, "2 %"),
        ("5 um", "petals.thickness", 5e-6, "+5 µm"),
        ("petals.thickness = 5 um, 2 %", "petals.thickness", 5e-6, "+5 µm"),
        ({"petals.thickness": "5 um"}, "petals.thickness", 5e-6, "+5 µm"),
    ],
)
def test_a_change_is_a_fraction_or_a_quantity(given: Any, path: str, size: float, words: str) -> None:
    found, told = change(given, path)
    assert found == pytest.approx(size, rel=1e-9)
    assert told == words


def test_the_rest_have_what_stands_without_a_path() -> None:
    changes = Changes(STEP.read("petals.thickness = 5 um, 2 %"))
    assert changes.of(RIG, parameter_of(RIG, "gas.viscosity"), 1.0)[1] == "2 %"
    lengths = Changes(STEP.read("5 um"))
    lengths.check([parameter_of(RIG, "gas.viscosity"), parameter_of(RIG, "petals.thickness")])
    assert lengths.of(RIG, parameter_of(RIG, "gas.viscosity"), 1.0)[1] == "1 %"


@pytest.mark.parametrize(
    ("given", "refusal", "words"),
    [
        ("petals.thicknes = 5 um", UsageError, "Did you mean 'petals.thickness'"),
        ("petals.thickness = 5 Pa", UnitError, "petals.thickness"),
        ("5 Pa", UnitError, "5 Pa"),
        ("petals.thickness = -5 um", UsageError, "above zero"),
        ("0 %", UsageError, "outside its range"),
        ("120 %", UsageError, "outside its range"),
        ("1 %, 2 %", UsageError, "two changes for one parameter"),
    ],
)
def test_what_fits_no_parameter_is_refused(given: str, refusal: type[Exception], words: str) -> None:
    with pytest.raises(refusal, match=words):
        change(given, "petals.thickness")


def row(**values: float) -> SensitivityRow:
    return SensitivityRow(
        **{
            "parameter": "p", "parameter_text": "", "parameter_value": 2.0, "parameter_unit": "m", "change_text": "1 %",
            "parameter_change": 0.02, "quantity": "q", "quantity_value": 1.0, "quantity_unit": "N",
            **values,
        }
    )  # fmt: skip


def test_effects_that_are_no_estimates_are_doubted() -> None:
    assert row(relative_effect=0.99, contacts_hold=0.01 / (0.99 * FAR)).doubts == []
    assert row().doubts == []
    assert "over 100 %" in row(relative_effect=-4.098).doubts[0]
    assert "change 20 times that for which contacts hold" in row(relative_effect=0.1, contacts_hold=5e-4).doubts[0]
    assert row(relative_effect=math.nan, contacts_hold=math.inf).doubts == []
