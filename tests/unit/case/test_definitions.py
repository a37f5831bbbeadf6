import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from petalfoil.case import Bearing, Case, Edges, Gas, Method, Model, ModelKind, Mount, Operation, Petals, Surface
from petalfoil.errors import DefinitionError, PackError, UnitError
from tests.cases import EXAMPLES, case, put, tables

NAMES = sorted(path.stem for path in EXAMPLES.glob("*.toml"))


def python_made(**petals: Any) -> Case:
    """The paper's case, made in Python from numbers and texts."""
    return Case(
        title="Paper, 2-D study, 8 petals",
        bearing=Bearing(journal_radius="25 mm", bushing_radius=0.026, length="5 cm"),
        petals=Petals(
            **{
                "count": 8,
                "arc_length": 0.045,
                "thickness": "176 um",
                "bend_radius": "40 mm",
                "mount": Mount.HINGED,
                "youngs_modulus": 200e9,
                "poisson_ratio": 0.3,
                **petals,
            }
        ),
        gas=Gas(viscosity=1.85e-5, ambient_pressure="100 kPa"),
        surface=Surface(contact_film_thickness=1e-6),
        operation=Operation(speed=8000, eccentricity=(0.0, "-100 um")),
        model=Model(kind="2d"),
    )


def test_every_example_is_read() -> None:
    assert {"paper_n6", "paper_n8", "paper_n10", "paper_n8_spatial", "plain_journal", "rig"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_examples_round_trip(name: str) -> None:
    one = case(name)
    assert Case.from_toml(one.to_toml()) == one
    assert hash(Case.from_toml(one.to_toml())) == hash(one)


def test_python_and_toml_make_the_same_case() -> None:
    assert python_made() == case("paper_n8")


def test_numbers_are_floats_in_si() -> None:
    paper = case("paper_n8")
    assert paper.bearing.journal_radius == 0.025
    assert paper.petals is not None
    assert paper.petals.thickness == 1.76e-4
    assert paper.petals.youngs_modulus == 2e11
    assert paper.operation.eccentricity == (0.0, -1e-4)
    assert paper.gas.temperature == 293.15
    assert type(python_made().operation.speed) is float
    assert type(case("paper_n8", **{"bearing.length": np.float64(0.05)}).bearing.length) is float


def test_defaults() -> None:
    data = put(tables("paper_n8"), "surface", {})
    for path in ("coating", "root_tilt", "first_root"):
        data["petals"].pop(path)
    del data["operation"]["eccentricity"]
    one = Case(**data)
    assert one.petals is not None
    assert (one.petals.coating, one.petals.root_tilt, one.petals.first_root) == (0.0, "chordal", 0.0)
    assert one.petals.free_shape is None
    assert (one.surface.contact_film_thickness, one.surface.friction_coefficient) == (1e-6, 0.3)
    assert one.operation.eccentricity == (0.0, 0.0)
    assert one.operation.load is None
    assert one.model.edges is Edges.AMBIENT
    assert one.model.method is Method.NEWTON
    assert one.model.symmetry is True
    del data["surface"]
    assert Case(**data) == one


def test_grids_have_defaults_that_a_case_overrides() -> None:
    assert case("paper_n8").model.cells_per_pitch is None
    assert case("paper_n8").cells_per_pitch >= 16
    assert case("paper_n8_spatial").cells_per_pitch < case("paper_n8").cells_per_pitch
    assert case("plain_journal").axial_cells > case("paper_n8_spatial").axial_cells
    chosen = case("paper_n8_spatial", **{"model.cells_per_pitch": 24, "model.axial_cells": 10})
    assert (chosen.cells_per_pitch, chosen.axial_cells) == (24, 10)


def test_an_odd_grid_only_without_symmetry() -> None:
    odd = {"model.axial_cells": 9}
    with pytest.raises(DefinitionError, match="cannot be halved"):
        case("paper_n8_spatial", **odd)
    assert case("paper_n8_spatial", **odd, **{"model.symmetry": False}).axial_cells == 9
    assert case("paper_n8", **odd).axial_cells == 9


@pytest.mark.parametrize("load", ["10 N", 10, 10.0, [0, "-10 N"], ("0 N", -10), np.array([0.0, -10.0])])
def test_a_load_of_one_quantity_acts_downward(load: object) -> None:
    assert case("paper_n8", **{"operation.load": load}).operation.load == (0.0, -10.0)


def test_the_gas_has_a_density() -> None:
    assert case("paper_n8").gas.ambient_density == pytest.approx(1e5 / (287.05 * 293.15), rel=1e-14)


def test_replace_takes_texts_sections_and_none() -> None:
    paper = case("paper_n8")
    changed = paper.replace(**{"operation.speed": "60000 rpm", "petals.count": 10, "title": "changed"})
    assert changed.operation.speed == pytest.approx(2000 * math.pi, rel=1e-15)
    assert changed.operation.eccentricity == paper.operation.eccentricity
    assert changed.petals is not None
    assert (changed.petals.count, changed.title) == (10, "changed")
    assert paper.replace(model=Model(kind=ModelKind.THREE_D)).model.kind is ModelKind.THREE_D
    assert paper.replace(petals=None).petals is None
    assert paper.replace() == paper


@pytest.mark.parametrize("path", ["operation.sped", "operatoin.speed", "speed", "petals.free_shape.0", "title.x"])
def test_replace_refuses_unknown_paths(path: str) -> None:
    with pytest.raises(DefinitionError):
        case("paper_n8").replace(**{path: 1.0})


def test_a_case_is_frozen() -> None:
    with pytest.raises(ValueError, match="frozen"):
        case("paper_n8").bearing.length = 1.0  # type: ignore[misc]


def test_all_problems_of_all_sections_in_one_message() -> None:
    data = put(put(put(tables(), "bearing.length", -1.0), "petals.count", 1), "gas.viscosity", "1 kg")
    with pytest.raises(DefinitionError) as caught:
        Case(**data)
    message = str(caught.value)
    assert "3 problems" in message
    for key in ("bearing.length", "petals.count", "gas.viscosity"):
        assert key in message
    assert caught.value.key == "bearing.length"
    assert caught.value.given == -1.0
    assert "greater than 0 m" in caught.value.allowed


def test_a_section_made_alone_names_its_table() -> None:
    with pytest.raises(DefinitionError, match=r"^bearing\.length: -1\.0 \(a bare number is read in m\) is outside"):
        Bearing(journal_radius=1.0, bushing_radius=1.1, length=-1.0)


def test_wrong_units_are_unit_errors() -> None:
    with pytest.raises(UnitError, match=r"bearing\.length: '5 kg' measures something else"):
        Case(**put(tables(), "bearing.length", "5 kg"))


def test_a_file_is_named_in_the_message(tmp_path: Path) -> None:
    path = tmp_path / "thick.toml"
    path.write_text(
        (EXAMPLES / "paper_n8.toml").read_text(encoding="utf-8").replace("0.176 mm", "0.8 mm"), encoding="utf-8"
    )
    with pytest.raises(PackError, match="too much") as caught:
        Case.load(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert caught.value.key == "petals"


def test_a_byte_order_mark_is_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + (EXAMPLES / "rig.toml").read_bytes().replace(b"\n", b"\r\n"))
    assert Case.load(str(path)) == case("rig")


def near(value: float) -> st.SearchStrategy[float]:
    return st.floats(0.97 * value, 1.03 * value)


CASES = st.fixed_dictionaries(
    {
        "title": st.text(st.characters(codec="utf-8"), max_size=30),
        "bearing.journal_radius": near(24.5e-3),
        "bearing.length": st.floats(1e-6, 20.0),
        "petals.arc_length": near(45e-3),
        "petals.thickness": near(0.15e-3),
        "petals.poisson_ratio": st.floats(-0.99, 0.49),
        "petals.youngs_modulus": st.floats(1.0, 1e13),
        "petals.root_tilt": st.one_of(st.just("chordal"), st.floats(-0.5, 0.8)),
        "petals.mount": st.sampled_from(Mount),
        "gas.viscosity": st.floats(1e-9, 10.0),
        "operation.speed": st.one_of(st.floats(0.0, 1e6), st.integers(0, 10**6)),
        "operation.eccentricity": st.tuples(st.floats(-1e-5, 1e-5), st.floats(-1e-5, 1e-5)),
        "operation.load": st.one_of(st.none(), st.tuples(st.floats(-1e9, 1e9), st.floats(-1e9, 1e9))),
        "model.kind": st.sampled_from(ModelKind),
        "model.edges": st.sampled_from(Edges),
        "model.cells_per_pitch": st.one_of(st.none(), st.integers(4, 4096)),
        "model.symmetry": st.booleans(),
    }
)


@settings(max_examples=60)
@given(CASES)
def test_the_round_trip_is_exact(changes: dict[str, Any]) -> None:
    one = case("paper_n8", **changes)
    back = Case.from_toml(one.to_toml())
    assert back == one
    assert back.to_toml() == one.to_toml()


def test_a_measured_shape_round_trips() -> None:
    rows = [(0.1 * i, 0.0259 - 1e-4 * math.sin(0.1 * i)) for i in range(20)]
    one = python_made(free_shape=rows, bend_radius=None)
    assert one.petals is not None
    assert one.petals.free_shape == tuple(rows)
    assert Case.from_toml(one.to_toml()) == one
    assert python_made(free_shape=np.array(rows), bend_radius=None) == one
