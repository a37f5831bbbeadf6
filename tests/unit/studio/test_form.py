"""The form of a case follows from its definitions: every key, its kind, its range; sliders stay inside the range."""

from __future__ import annotations

import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis import known_verbs
from petalfoil.case import Bearing, Case, Gas, Model, Operation, Petals, Rotor, Surface
from petalfoil.case.definition import Definition
from petalfoil.studio.form import Control, FormEntry, sections, sliders_of, with_labels
from petalfoil.units import parse_quantity

ENTRIES = {entry.path: entry for section in sections() for entry in section.entries}


@pytest.mark.parametrize("model", [Bearing, Petals, Gas, Surface, Operation, Rotor, Model])
def test_every_key_of_every_table_has_a_control(model: type[Definition]) -> None:
    (section,) = (section for section in sections() if section.name == model.section)
    assert [entry.path for entry in section.entries] == [f"{model.section}.{key}" for key in model.model_fields]


def test_every_key_of_a_case_is_a_table_or_has_a_control() -> None:
    named = {section.name for section in sections()} | {"title"}
    assert set(Case.model_fields) <= named
    assert {"petals", "rotor"} <= {section.name for section in sections() if section.is_optional}


def test_the_table_of_a_registered_wall_has_controls(foundation: Case) -> None:
    names = {section.name for section in sections(type(foundation))}
    assert foundation.wall is not None
    assert foundation.wall.section in names


@pytest.mark.parametrize(
    ("path", "control"),
    [
        ("petals.count", Control.COUNT),
        ("petals.thickness", Control.QUANTITY),
        ("petals.root_tilt", Control.QUANTITY),
        ("petals.free_shape", Control.ROWS),
        ("petals.mount", Control.CHOICE),
        ("operation.load", Control.PAIR),
        ("operation.eccentricity", Control.PAIR),
        ("model.symmetry", Control.FLAG),
        ("title", Control.TEXT),
    ],
)
def test_the_control_suits_the_definition(path: str, control: Control) -> None:
    assert ENTRIES[path].control is control


def test_bounds_words_and_defaults_are_those_of_the_model() -> None:
    assert ENTRIES["petals.poisson_ratio"].bounds.below == 0.5
    assert ENTRIES["petals.mount"].choices == ("hinged", "clamped")
    assert ENTRIES["surface.contact_film_thickness"].default == 1e-6
    assert ENTRIES["petals.thickness"].is_required
    assert not ENTRIES["petals.coating"].is_required


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ("petals.thickness", "176 um"),
        ("petals.poisson_ratio", "0.3"),
        ("petals.poisson_ratio", "0.45"),
        ("petals.count", "8"),
        ("petals.count", "60"),
        ("operation.speed", "76400 rpm"),
        ("gas.temperature", "20 degC"),
        ("petals.root_tilt", "20 deg"),
    ],
)
def test_every_place_of_a_slider_is_allowed(path: str, text: str) -> None:
    entry = ENTRIES[path]
    (slider,) = sliders_of(entry, text)
    assert slider.low < slider.value < slider.high
    for value in (slider.low, slider.low + slider.step, slider.high):
        read = parse_quantity(slider.text(value), entry.unit or "1")
        assert entry.bounds.holds(read), slider.text(value)


def test_the_text_of_a_slider_is_read_back_as_its_place() -> None:
    (slider,) = sliders_of(ENTRIES["petals.thickness"], "176 um")
    assert_allclose(parse_quantity(slider.text(180.0), "m"), 180e-6, rtol=1e-12)
    assert sliders_of(ENTRIES["petals.root_tilt"], "chordal") == []
    assert sliders_of(ENTRIES["petals.thickness"], "176 N") == []


def test_a_pair_has_two_sliders_to_both_sides() -> None:
    across, down = sliders_of(ENTRIES["operation.load"], "0 N, -15 N")
    assert (across.low, across.high, down.low, down.high) == (-30.0, 30.0, -30.0, 30.0)


@pytest.mark.parametrize(
    ("path", "text", "value"),
    [
        ("petals.count", "8", 8),
        ("petals.thickness", " 176 um ", "176 um"),
        ("petals.poisson_ratio", "0.3", 0.3),
        ("operation.load", "0 N, -15 N", ["0 N", "-15 N"]),
        ("operation.load", "15 N", "15 N"),
        ("title", "8", "8"),
        ("petals.coating", "", None),
        ("petals.thickness", "1_0 um", "1_0 um"),
    ],
)
def test_a_typed_text_becomes_a_value_of_the_case(path: str, text: str, value: object) -> None:
    given = ENTRIES[path].given(text)
    assert given == value
    assert type(given) is type(value)


def test_defaults_are_shown_in_units_that_are_read_back() -> None:
    for entry in ENTRIES.values():
        if entry.unit and isinstance(entry.default, float):
            assert_allclose(parse_quantity(entry.text(entry.default), entry.unit), entry.default, rtol=1e-11)


def test_a_value_without_a_control_of_its_own_is_still_text() -> None:
    assert FormEntry(path="a.b_c", control=Control.TEXT, meaning="").label == "b c"


def test_texts_of_the_program_call_arguments_as_their_fields() -> None:
    capacity = known_verbs.find("capacity")
    assert capacity is not None
    text = "give --min-film, --max-stress or --minor; max_stress: '3' is none, --min-film-like is not"
    said = "give 'min film thickness', 'max stress' or --minor; max stress: '3' is none, --min-film-like is not"
    assert with_labels(text, capacity.arguments) == said
    assert with_labels("a --b", {}) == "a --b"
