"""Every key of a bump foil, of backing springs and of a metal: what is refused, and what the refusal says."""

from __future__ import annotations

import typing

import pytest

from petalfoil.case import Backing, BumpFoil, Case
from petalfoil.case.number_fields import Quantity
from petalfoil.errors import DefinitionError
from tests.cases import case, tables

TABLES = {"bump_foil": BumpFoil, "backing": Backing}
EXAMPLES = {"bump_foil": "bump_foil", "backing": "backed_petals"}
METAL = ("petals.material", "petals.metal_temperature", "petals.yield_strength")


def quantity_of(annotation: object) -> Quantity | None:
    """The quantity that a field is, if it is one."""
    for part in (*getattr(annotation, "__metadata__", ()), *typing.get_args(annotation)):
        if isinstance(part, Quantity):
            return part
        if (found := quantity_of(part)) is not None:
            return found
    return None


def quantities() -> dict[str, Quantity]:
    """All keys with a unit, by their path."""
    found = {}
    for section, table in TABLES.items():
        for name, annotation in typing.get_type_hints(table, include_extras=True).items():
            if (quantity := quantity_of(annotation)) is not None:
                found[f"{section}.{name}"] = quantity
    return found


QUANTITIES = quantities()


def refusal(path: str, value: object) -> str:
    """What is said where a key has a value."""
    section, _, name = path.partition(".")
    data = tables(EXAMPLES.get(section, "paper_n8"))
    data[section] = {**data[section], name: value}
    with pytest.raises(DefinitionError) as told:
        Case(**data)
    return str(told.value)


def test_all_keys_are_here() -> None:
    keys = {f"{section}.{name}" for section, table in TABLES.items() for name in table.model_fields}
    assert keys - set(QUANTITIES) == {f"{section}.{name}" for section in TABLES for name in ("feet", "material")}


@pytest.mark.parametrize("path", QUANTITIES)
def test_a_number_outside_its_range_is_refused_with_the_range(path: str) -> None:
    quantity = QUANTITIES[path]
    upper = quantity.at_most if quantity.at_most is not None else quantity.below
    lower = quantity.above if quantity.above is not None else quantity.at_least
    assert upper is not None
    assert lower is not None
    for value, bound in ((2.0 * upper + 1.0, upper), (lower - 1.0, lower)):
        told = refusal(path, value)
        assert f"{path}: {value!r}" in told
        assert "outside its range" in told
        assert f"{bound:g}" in told


@pytest.mark.parametrize("path", QUANTITIES)
def test_a_unit_of_something_else_is_refused(path: str) -> None:
    told = refusal(path, "3 kg")
    assert path in told
    assert "'3 kg'" in told
    assert "mass" in told


@pytest.mark.parametrize("path", [*QUANTITIES, *METAL])
def test_a_misspelt_key_is_refused_with_the_nearest(path: str) -> None:
    section, _, name = path.partition(".")
    misspelt = name[:2] + name[3:]
    told = refusal(f"{section}.{misspelt}", 1.0)
    assert f"{section}.{misspelt}" in told
    assert f"Did you mean '{name}'?" in told


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("bump_foil.feet", "fixed", ("'fixed'", "'free'", "'held'")),
        ("backing.feet", "fixed", ("'fixed'", "'free'", "'held'")),
        ("bump_foil.material", "inconnel 718", ("Did you mean 'inconel 718'", "spring steel")),
        ("backing.material", "inconnel 718", ("Did you mean 'inconel 718'", "spring steel")),
        ("petals.material", "beryllium cooper", ("Did you mean 'beryllium copper", "spring steel")),
        ("petals.metal_temperature", "3 kg", ("'3 kg'", "a temperature")),
        ("petals.metal_temperature", -1.0, ("outside its range",)),
        ("petals.yield_strength", "3 kg", ("'3 kg'", "mass")),
        ("petals.yield_strength", 0.0, ("outside its range",)),
    ],
)
def test_a_name_or_number_of_a_metal_is_refused(path: str, value: object, words: tuple[str, ...]) -> None:
    told = refusal(path, value)
    assert path in told
    assert all(word in told for word in words), told


def test_every_example_of_these_tables_is_read() -> None:
    for section, name in EXAMPLES.items():
        assert getattr(case(name), section) is not None
