"""Results that pages state are computed anew: the sentence with the numbers of today is on its page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import petalfoil
from tests.docs.texts import DOCS, ROOT, text

EIGHT = "examples/paper_n8.toml"
MICROMETRE = 1e-6

Numbers = tuple[float, ...]


def case(name: str, **changed: Any) -> petalfoil.Case:
    """A case of the examples with some keys changed, dots of their paths written as two underscores."""
    return petalfoil.Case.load(str(ROOT / name)).replace(
        **{key.replace("__", "."): value for key, value in changed.items()}
    )


def of(result: Any, name: str) -> Any:
    """Values of a result without axes of length one."""
    return np.squeeze(result[name].values)


def edges() -> Numbers:
    """Bearing force and minimum film thickness with continuous over ambient edges, as changes [%]."""
    ambient, continuous = (
        petalfoil.solve(case(EIGHT, model__edges=kind), eccentricity="0 um, -200 um")
        for kind in ("ambient", "continuous")
    )
    names = ("bearing_force", "min_film_thickness")
    return tuple(100.0 * float(of(continuous, name) / of(ambient, name) - 1.0) for name in names)


def small_motions(amplitude: str | None = None, **changed: Any) -> Any:
    """Stiffness and damping of eight petals under 20 N, whirl at 8000 rad/s."""
    asked = {} if amplitude is None else {"amplitude": amplitude}
    return petalfoil.coefficients(case(EIGHT, **changed), load="20 N", frequency="8000 rad/s", **asked)


def stuck_stiffness() -> Numbers:
    """Horizontal stiffness with petals that stick, without friction, with the turning of faces alone [kN/m]."""
    stuck, free = {"surface__petal_friction": 0.3}, {"surface__petal_friction": 0.0}
    turning = stuck | {"petals__theory": "inextensible"}
    return tuple(float(of(small_motions(**changed), "stiffness")[0, 0]) / 1e3 for changed in (stuck, free, turning))


def damping_over_amplitude(**changed: Any) -> Numbers:
    """Horizontal damping with friction 0.3 at 1, 10 and 50 µm [N s/m]."""
    changed = {"surface__petal_friction": 0.3, **changed}
    return tuple(
        float(of(small_motions(amplitude, **changed), "damping")[0, 0]) for amplitude in ("1 um", "10 um", "50 um")
    )


def about_the_bore() -> Numbers:
    """Stiffness of petals that stick about the bore, and damping over amplitude [kN/m, N s/m]."""
    bore = {"surface__petal_friction": 0.3, "petals__linear_about": "bore"}
    return (
        float(of(small_motions(**bore), "stiffness")[0, 0]) / 1e3,
        *damping_over_amplitude(petals__linear_about="bore"),
    )


def thicker_petals(cells: int, contacts: str) -> Numbers:
    """Change of minimum film thickness and bending stress by 1 % thicker petals under 20 N [%]."""
    asked = {"load": "20 N", "of": "min_film_thickness, max_bending_stress", "contacts": contacts}
    table = petalfoil.sensitivity(case(EIGHT, model__cells_per_pitch=cells), "petals.thickness", **asked)
    return tuple(100.0 * table["relative_effect"].values)


def thicker_petals_stiffness() -> Numbers:
    """Change of vertical stiffness and of damping by 1 % thicker petals, the latter as a loss [%]."""
    asked = {"load": "20 N", "ask": "coefficients", "of": "stiffness_yy, damping_yy"}
    stiffness, damping = (
        100.0 * petalfoil.sensitivity(case(EIGHT), "petals.thickness", **asked)["relative_effect"].values
    )
    return stiffness, -damping


def without_springs() -> Numbers:
    """Minimum film thickness without springs behind the petals, 60 N, and how much lower the journal lies [µm]."""
    backed = petalfoil.Case.load(str(ROOT / "examples/backed_petals.toml"))
    springs, none = (petalfoil.balance(one, load="60 N") for one in (backed, backed.replace(backing=None)))
    sunk = float(of(springs, "eccentricity_y") - of(none, "eccentricity_y"))
    return float(of(none, "min_film_thickness")) / MICROMETRE, sunk / MICROMETRE


def held_feet() -> Numbers:
    """Stiffness of the strip of the page with held feet over that with free ones."""
    foil = {
        "bump_pitch": "4.572 mm",
        "bump_half_length": "1.778 mm",
        "bump_half_angle": 0.4,
        "thickness": "0.1016 mm",
        "material": "inconel x-750",
    }
    free, held = (
        petalfoil.check(case("examples/bump_foil.toml", bump_foil=foil | {"feet": feet})) for feet in ("free", "held")
    )
    return (float(of(held, "foundation_stiffness") / of(free, "foundation_stiffness")),)


def rig_at_rest(result: str, *loads: str, **changed: Any) -> Numbers:
    """A result of the rig at zero speed under each of some loads [SI]."""
    rig = case("examples/rig.toml", operation__speed="0 rpm", **changed)
    return tuple(float(of(petalfoil.balance(rig, load=load), result)) for load in loads)


STATED: list[tuple[str, str, Callable[[], Numbers]]] = [
    ("theory.md", "raises the bearing force by {:.0f} % and the minimum film thickness by {:.0f} %", edges),
    (
        "theory.md",
        "petals that stick is {:.0f} kN/m, without friction {:.0f} kN/m, with the turning of faces alone {:.0f} kN/m",
        stuck_stiffness,
    ),
    (
        "theory.md",
        "change the minimum film thickness by {:.2f} % and the bending stress by {:.2f} % in this way",
        lambda: thicker_petals(128, "points"),
    ),
    ("theory.md", "on 128 cells per pitch ({:.2f} and {:.2f} % on 32)", lambda: thicker_petals(32, "points")),
    (
        "theory.md",
        "With contacts at nodes they are {:.2f} and {:.2f} % on 128 cells",
        lambda: thicker_petals(128, "nodes"),
    ),
    ("theory.md", "% on 128 cells, {:.2f} and {:.2f} % on 32", lambda: thicker_petals(32, "nodes")),
    (
        "how-to/petal-friction.md",
        "{:.1f}, {:.1f} and {:.1f} N s/m in small motions and at 1, 10",
        damping_over_amplitude,
    ),
    (
        "how-to/petal-friction.md",
        "stick with {:.0f} instead of 1104 kN/m, and have {:.1f}, {:.1f} and {:.1f} N s/m at 1, 10 and 50 µm",
        about_the_bore,
    ),
    (
        "how-to/sensitivity.md",
        "1 % thicker have {:.1f} % more vertical stiffness and {:.1f} % less damping",
        thicker_petals_stiffness,
    ),
    ("how-to/backing-springs.md", "the load leaves {:.2f} µm, and the journal lies {:.0f} µm lower", without_springs),
    ("how-to/bump-foil.md", "Feet that are held make this bump {:.0f} times stiffer", held_feet),
    (
        "validation-rig.md",
        "under 46.4, 55.6, 64.8 and 104.6 N it is {:.0f}, {:.0f}, {:.0f} and {:.0f} N",
        lambda: rig_at_rest("contact_normal_force", "46.4 N", "55.6 N", "64.8 N", "104.6 N"),
    ),
    (
        "validation-rig.md",
        "and the three moments {:.2f}, {:.2f} and {:.2f} N·m",
        lambda: rig_at_rest("friction_torque", "46.4 N", "55.6 N", "64.8 N", petals__linear_about="bore"),
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "sentence", "numbers"), STATED, ids=[f"{page}-{sentence[:30]}" for page, sentence, _ in STATED]
)
def test_a_sentence_states_what_is_computed(page: str, sentence: str, numbers: Callable[[], Numbers]) -> None:
    assert sentence.format(*numbers()) in " ".join(text(DOCS / page).replace("−", "-").split())


def test_another_number_is_seen() -> None:
    page, sentence, _ = STATED[0]
    assert sentence.format(4.0, 17.0) not in " ".join(text(DOCS / page).split())
