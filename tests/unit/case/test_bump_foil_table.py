"""The table of a bump foil: stiffness given once, as such or by the strip."""

from __future__ import annotations

import math

import pytest

from petalfoil.case import BumpFoil, Case, warnings_of
from petalfoil.errors import DefinitionError
from petalfoil.walls.bump_foil import foundation_stiffness
from tests.cases import case

STRIP = {
    "bump_pitch": "4.572 mm",
    "bump_half_length": "1.778 mm",
    "thickness": "0.1016 mm",
    "youngs_modulus": "213 GPa",
    "poisson_ratio": 0.29,
}


def with_foil(**table: object) -> Case:
    """The example with another foil."""
    return case("bump_foil", bump_foil=table)


def test_a_shallow_strip_has_the_stiffness_of_walowit_and_anno() -> None:
    shallow = BumpFoil(**STRIP)
    classic = 213e9 / (2.0 * (1.0 - 0.29**2)) * (0.1016e-3 / 1.778e-3) ** 3 / 4.572e-3
    assert foundation_stiffness(shallow) == pytest.approx(classic, rel=1e-12)
    assert shallow.travel == math.inf


def test_an_arc_is_softer_on_free_feet_and_stiffer_on_held_ones() -> None:
    free, held = (BumpFoil(**STRIP, bump_half_angle=0.4, feet=feet) for feet in ("free", "held"))
    shallow = foundation_stiffness(BumpFoil(**STRIP))
    assert foundation_stiffness(free) / shallow == pytest.approx(0.9922183771, rel=1e-9)
    assert foundation_stiffness(held) / shallow == pytest.approx(25.99511576, rel=1e-8)
    assert free.travel == pytest.approx(1.778e-3 / math.sin(0.4) * (1.0 - math.cos(0.4)))


@pytest.mark.parametrize(
    ("table", "key", "words"),
    [
        ({}, "bump_foil.bump_pitch", "is missing; expected foundation_stiffness alone, or the strip"),
        ({**STRIP, "bump_pitch": "3 mm"}, "bump_foil.bump_pitch", "less than the chord of a bump, 0.003556 m"),
        (
            {**STRIP, "foundation_stiffness": "4 GPa/m"},
            "bump_foil.foundation_stiffness",
            "is given beside bump_pitch, bump_half_length",
        ),
        ({**STRIP, "feet": "held"}, "bump_foil.feet", "need a strip with bump_half_angle"),
        ({"foundation_stiffness": 4e9, "feet": "held"}, "bump_foil.feet", "'held' has no stiffness here"),
        (
            {"foundation_stiffness": 4e9, "top_foil_thickness": "0.1 mm"},
            "bump_foil.poisson_ratio",
            "is missing; expected a top foil bends by it",
        ),
        ({"foundation_stiffness": "4 GPa"}, "bump_foil.foundation_stiffness", "Pa/m"),
        ({"foundation_stiffness": 4e9, "loss_factr": 0.1}, "bump_foil.loss_factr", "Did you mean 'loss_factor'"),
    ],
)
def test_what_does_not_make_a_foil_is_refused(table: dict[str, object], key: str, words: str) -> None:
    with pytest.raises(DefinitionError) as refusal:
        with_foil(**table)
    assert key in str(refusal.value)
    assert words in str(refusal.value)


def test_a_material_gives_modulus_and_poisson_ratio() -> None:
    metal = {"youngs_modulus", "poisson_ratio"}
    shape = {key: value for key, value in STRIP.items() if key not in metal}
    named = with_foil(**shape, material="X-750", metal_temperature="279.5 degC")
    typed = BumpFoil(**shape, youngs_modulus="199 GPa", poisson_ratio=0.29)
    assert foundation_stiffness(named.bump_foil) == pytest.approx(foundation_stiffness(typed), rel=1e-12)
    assert Case.from_toml(named.to_toml()) == named
    with pytest.raises(DefinitionError, match=r"is given beside bump_foil\.material = 'inconel x-750'"):
        with_foil(**STRIP, material="X-750")
    with pytest.raises(DefinitionError, match=r"Did you mean 'inconel x-750'"):
        with_foil(**shape, material="inconel x-75")
    (told,) = warnings_of(named.replace(**{"bump_foil.metal_temperature": "600 degC"}), {})
    assert told.startswith("bump_foil.metal_temperature: ")


def test_a_journal_may_be_displaced_beyond_the_clearance_of_a_foil_that_gives_way() -> None:
    beyond = {"operation.eccentricity": ("0 um", "-30 um")}
    assert with_foil(foundation_stiffness="4 GPa/m").replace(**beyond).radial_clearance < 0.0
    low = {**STRIP, "bump_half_length": "0.04 mm", "bump_half_angle": 0.05}
    with pytest.raises(DefinitionError, match=r"allowed: less than the radial clearance"):
        with_foil(**low).replace(**beyond)


def test_a_foil_and_petals_exclude_each_other() -> None:
    with pytest.raises(DefinitionError, match=r"\[petals\] and \[bump_foil\] both describe the wall"):
        case("paper_n8", bump_foil={"foundation_stiffness": 4e9})


def test_a_case_with_a_foil_writes_itself() -> None:
    foil = with_foil(**STRIP, bump_half_angle=0.4, feet="held", loss_factor=0.1)
    assert Case.from_toml(foil.to_toml()) == foil


# ---------------------------------------------------------------------------------------------- backing springs


def test_backing_springs_are_a_strip_like_any_other() -> None:
    one = case("backed_petals", backing={**STRIP, "bump_half_angle": 0.4, "height": "60 um"})
    assert one.backing is not None
    assert foundation_stiffness(one.backing) == foundation_stiffness(BumpFoil(**STRIP, bump_half_angle=0.4))
    assert Case.from_toml(one.to_toml()) == one
    assert one.travel == 0.0


@pytest.mark.parametrize(
    ("table", "key", "words"),
    [
        ({}, "backing.bump_pitch", "is missing; expected foundation_stiffness alone, or the strip"),
        ({**STRIP, "feet": "held"}, "backing.feet", "need a strip with bump_half_angle"),
        ({"foundation_stiffness": 4e9, "height": "-1 um"}, "backing.height", "at least 0"),
        (
            {"foundation_stiffness": 4e9, "top_foil_thickness": "0.1 mm"},
            "backing.top_foil_thickness",
            "is not a known key",
        ),
        ({"foundation_stiffness": 4e9, "start": "21 mm"}, "backing.start", "behind the arc of a pitch, 0.0204204 m"),
        ({"foundation_stiffness": 4e9, "hight": "60 um"}, "backing.hight", "Did you mean 'height'"),
    ],
)
def test_springs_whose_force_is_not_known_are_refused(table: dict[str, object], key: str, words: str) -> None:
    with pytest.raises(DefinitionError) as refusal:
        case("backed_petals", backing=table)
    assert refusal.value.key == key
    assert words in str(refusal.value)


@pytest.mark.parametrize("name", ["plain_journal", "bump_foil"])
def test_springs_without_petals_are_refused(name: str) -> None:
    with pytest.raises(DefinitionError, match="backing springs stand behind petals, and there are none"):
        case(name, backing={"foundation_stiffness": 4e9})


def test_petals_that_stretch_have_no_springs() -> None:
    with pytest.raises(DefinitionError, match="petals that stretch are modelled on a rigid bushing alone"):
        case("backed_petals", **{"petals.theory": "shell"})
    assert case("backed_petals", **{"surface.petal_friction": 0.1}).petal_theory.value == "inextensible"


def test_the_paper_s_method_has_no_springs() -> None:
    with pytest.raises(DefinitionError, match="the paper has no backing springs"):
        case("backed_petals", **{"model.method": "classic"})
