"""Parameters of a case: every number by its path, with unit and range, and variants by values."""

from __future__ import annotations

import math

import pytest

from petalfoil.case import Case, parameter_of, parameters_of, with_values
from petalfoil.errors import DefinitionError, PackError, UnitError
from tests.cases import EXAMPLES, case

RIG = Case.load(EXAMPLES / "rig.toml")
RPM = math.pi / 30.0


def test_every_number_of_every_table_is_a_parameter() -> None:
    known = parameters_of(RIG)
    assert {"bearing.length", "petals.count", "gas.viscosity", "surface.friction_coefficient"} <= known.keys()
    assert {"operation.eccentricity.x", "operation.load.y", "model.cells_per_pitch"} <= known.keys()
    assert not {"title", "petals.mount", "petals.free_shape", "model.kind", "rotor.mass"} & known.keys()


def test_a_parameter_has_unit_value_and_range() -> None:
    thickness = parameter_of(RIG, "petals.thickness")
    assert (thickness.unit, thickness.value, thickness.is_count) == ("m", 0.15e-3, False)
    assert (thickness.declared.above, thickness.declared.at_most) == (0.0, 0.1)
    assert (thickness.name, parameter_of(RIG, "operation.load.y").name) == ("thickness", "load_y")
    count = parameter_of(RIG, "petals.count")
    assert (count.unit, count.value, count.is_count) == ("1", 9, True)


def test_what_a_rule_gives_has_no_value() -> None:
    known = parameters_of(RIG)
    assert known["petals.root_tilt"].value is None
    assert known["operation.load.y"].value is None
    assert known["model.axial_cells"].value is None


def test_numbers_that_follow_from_the_name_of_a_gas_are_none() -> None:
    named = RIG.replace(gas={"name": "air", "ambient_pressure": "1 bar"})
    assert "gas.viscosity" not in parameters_of(named)
    assert "gas.temperature" in parameters_of(named)


def test_every_parameter_can_be_set_to_its_own_value() -> None:
    for bearing in (RIG, case("plain_journal"), case("orbit_n8")):
        for path, parameter in parameters_of(bearing).items():
            if parameter.value is not None:
                assert with_values(bearing, {path: parameter.value}) == bearing, path


def test_values_have_units_and_several_change_at_once() -> None:
    changed = with_values(
        RIG,
        {"petals.thickness": "0.11 mm", "petals.count": "8", "operation.speed": "10000 rpm", "operation.load.y": -20.0},
    )
    assert changed.petals is not None
    assert (changed.petals.thickness, changed.petals.count) == (0.11e-3, 8)
    assert changed.operation.speed == pytest.approx(10000.0 * RPM, rel=1e-15)
    assert changed.operation.load == (0.0, -20.0)
    both = with_values(RIG, {"operation.eccentricity.x": "1 um", "operation.eccentricity.y": "2 um"})
    assert both.operation.eccentricity == (1e-6, 2e-6)
    assert with_values(RIG, {}) is RIG


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("petals.thicknes", "Did you mean 'petals.thickness'?"),
        ("thickness", "Did you mean 'petals.thickness'?"),
        ("rpm", "Did you mean 'operation.speed'?"),
        ("operation.load", "It has entries: operation.load.x, operation.load.y."),
        ("petals.mount", "It is 'hinged' here"),
        ("rotor.mass", "The case has no table [rotor]."),
        ("petals.count[3]", "'petals.count' is one number for all."),
        ("title", "Known: bearing.journal_radius"),
    ],
)
def test_an_unknown_path_is_refused_with_what_was_meant(path: str, words: str) -> None:
    with pytest.raises(DefinitionError, match="is no parameter of this case") as refused:
        with_values(RIG, {path: 1.0})
    assert words in str(refused.value)
    assert refused.value.key == path


@pytest.mark.parametrize(
    ("values", "kind", "words"),
    [
        ({"petals.thickness": "3 N"}, UnitError, "petals.thickness: '3 N' measures something else"),
        ({"petals.thickness": "3 m"}, DefinitionError, "allowed: greater than 0 m and at most 0.1 m"),
        ({"petals.count": 8.5}, DefinitionError, "petals.count: 8.5 is not a whole number"),
        ({"petals.count": "1"}, DefinitionError, "allowed: a whole number, at least 2 and at most 64"),
        ({"petals.arc_length": "1 mm"}, PackError, "do not overlap"),
    ],
)
def test_values_that_cannot_be_are_refused(values: dict[str, object], kind: type[DefinitionError], words: str) -> None:
    with pytest.raises(kind) as refused:
        with_values(RIG, values)
    assert words in str(refused.value)
