"""Metals by name: the table, its ranges, and a case with a material against one with the same numbers typed."""

from __future__ import annotations

import re

import pytest

import petalfoil
from petalfoil.case import Case, warnings_of
from petalfoil.case.metals import METALS, SHORT, metal_of
from petalfoil.errors import DefinitionError
from tests.cases import case, tables
from tests.docs.texts import DOCS, text


def made_of(material: str | None, **petals: object) -> Case:
    """The paper's eight petals of a material."""
    data = tables("paper_n8")
    for name in ("youngs_modulus", "poisson_ratio"):
        data["petals"].pop(name)
    data["petals"] |= {"material": material} if material else {}
    data["petals"] |= petals
    data["model"]["cells_per_pitch"] = 16
    return Case(**data)


@pytest.mark.parametrize("name", METALS)
def test_a_metal_is_plausible_and_has_a_source(name: str) -> None:
    metal = METALS[name]
    assert 1e11 <= metal.youngs_modulus(293.15) <= 2.2e11
    assert 0.28 <= metal.poisson_ratio <= 0.35
    assert 4000.0 <= metal.density <= 9000.0
    assert 8e-6 <= metal.expansion <= 18e-6
    assert metal.yield_strength is None or 4e8 <= metal.yield_strength <= 1.6e9
    named = {"modulus", "poisson_ratio", "density", "expansion"}
    assert set(metal.sources) == named | ({"yield_strength"} if metal.yield_strength else set())
    for value, source in metal.sources.items():  # who says so, and at which temperatures
        assert len(source) > 20, value
        assert re.search(r"\d °[CF]|room temperature", source), value
    assert metal.range[0] < 293.15 < metal.range[1]
    moduli = [E for _, E in metal.modulus]
    assert moduli == sorted(moduli, reverse=True)


def test_other_names_are_names() -> None:
    assert {metal_of(short).name for short in SHORT} <= set(METALS)
    assert metal_of("  Inconel  X-750 ") is METALS["inconel x-750"]


def test_the_modulus_is_linear_between_temperatures_and_ends_with_them() -> None:
    metal = METALS["inconel x-750"]
    assert metal.youngs_modulus(273.15 + 279.5) == pytest.approx(199e9)
    assert metal.youngs_modulus(273.15 + 900.0) == 184e9


def test_a_material_equals_the_same_numbers_typed() -> None:
    named = made_of("stainless steel 302", metal_temperature="260 degC")
    typed = made_of(None, youngs_modulus="177.9 GPa", poisson_ratio=0.30, yield_strength="517 MPa")
    assert (named.petals.youngs_modulus, named.petals.yield_strength) == (177.9e9, 517e6)
    one, other = (petalfoil.solve(of) for of in (named, typed))
    for result in ("bearing_force", "min_film_thickness", "max_bending_stress"):
        assert float(one[result]) == float(other[result])


def test_a_case_with_a_material_writes_itself_and_follows_its_changes() -> None:
    named = made_of("x-750", metal_temperature="300 degC")
    assert "youngs_modulus" not in named.to_toml()
    assert Case.from_toml(named.to_toml()) == named
    assert named.replace(**{"petals.metal_temperature": "21 degC"}).petals.youngs_modulus == 214e9
    assert named.replace(**{"petals.material": "titanium"}).petals.yield_strength == 828e6
    harder = made_of("titanium", yield_strength="1 GPa")
    assert Case.from_toml(harder.to_toml()).petals.yield_strength == 1e9


def test_stress_over_the_yield_strength_of_the_material_is_warned_of() -> None:
    bronze = made_of("phosphor bronze")
    (told,) = warnings_of(bronze, {"max_bending_stress": 691e6})
    assert "exceeds 690 MPa, the yield strength" in told
    assert warnings_of(bronze, {"max_bending_stress": 689e6}) == []


def test_a_temperature_beyond_the_data_is_warned_of() -> None:
    hot, warm = (made_of("inconel x-750", metal_temperature=at) for at in ("540 degC", "535 degC"))
    (told,) = warnings_of(hot, {})
    assert told.startswith("petals.metal_temperature: the modulus of inconel x-750 is known from -9 to 538 °C")
    assert warnings_of(warm, {}) == []


@pytest.mark.parametrize(
    ("material", "at", "E"),
    [("titanium", 300.0, 98.9e9), ("phosphor bronze", 200.0, 101.4e9), ("beryllium copper", 50.0, 125.7e9)],
)
def test_springs_of_titanium_and_copper_alloys_get_softer_with_temperature(material: str, at: float, E: float) -> None:
    assert made_of(material, metal_temperature=f"{at} degC").petals.youngs_modulus == pytest.approx(E, rel=1e-3)


@pytest.mark.parametrize(
    ("material", "warm", "near"),
    [("phosphor bronze", 205.0, 195.0), ("x-750", 540.0, 530.0), ("beryllium copper", 52.0, 48.0)],
)
def test_a_gas_at_which_the_modulus_is_not_known_is_warned_of(material: str, warm: float, near: float) -> None:
    petals = made_of(material)
    (told,) = warnings_of(petals.replace(**{"gas.temperature": 273.15 + warm}), {})
    assert told.startswith(f"petals.metal_temperature: the gas is at {warm:.0f} °C, where the modulus of")
    assert "and that at 20 °C is taken; give petals.youngs_modulus" in told
    assert warnings_of(petals.replace(**{"gas.temperature": 273.15 + near}), {}) == []


@pytest.mark.parametrize(
    ("material", "petals", "words"),
    [
        ("inconnel 718", {}, "Did you mean 'inconel 718'"),
        ("x-750", {"youngs_modulus": "200 GPa"}, "is given beside petals.material = 'inconel x-750'"),
        (None, {"poisson_ratio": 0.3}, "or petals.material, such as 'inconel x-750'"),
    ],
)
def test_what_is_no_metal_is_refused(material: str | None, petals: dict[str, object], words: str) -> None:
    with pytest.raises(DefinitionError, match=words):
        made_of(material, **petals)


def test_the_page_lists_the_table() -> None:
    page = text(DOCS / "how-to" / "metals.md")
    for metal in METALS.values():
        E = metal.youngs_modulus(293.15)
        sigma = "–" if metal.yield_strength is None else f"{1e-6 * metal.yield_strength:.0f}"
        row = (
            f"| `{metal.name}` | {1e-9 * E:.1f} | {metal.known_at} | {metal.poisson_ratio:.2f} | {metal.density:.0f} | "
        )
        assert all(source in " ".join(page.split()) for source in metal.sources.values())
        assert f"{row}{1e6 * metal.expansion:.1f} | {sigma} | {metal.temper} |" in page


def test_a_case_by_numbers_is_as_before() -> None:
    assert case("paper_n8").petals.metal is None
