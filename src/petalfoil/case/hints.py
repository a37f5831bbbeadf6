"""What a wrong key or word was probably meant to be: slips, names of before and of other codes, physics left out."""

from __future__ import annotations

import difflib
import re
from collections.abc import Sequence

SLIP = 0.85
"""Similarity from which a key is a misspelt one: 'roottilt' is 'root_tilt', 'wall_temperature' no 'temperature'."""

SYNONYMS = {
    "ambient_temperature": "gas.temperature",
    "angular_velocity": "operation.speed",
    "axial_length": "bearing.length",
    "bearing_radius": "bearing.bushing_radius",
    "bushing_temperature": "bushing.temperature",
    "cte": "shaft.expansion",
    "e": "petals.youngs_modulus",
    "elastic_modulus": "petals.youngs_modulus",
    "film_floor": "surface.contact_film_thickness",
    "foil_length": "petals.arc_length",
    "foil_thickness": "petals.thickness",
    "inertia": "rotor.transverse_inertia",
    "journal_temperature": "shaft.temperature",
    "leaf_count": "petals.count",
    "leaf_length": "petals.arc_length",
    "leaf_thickness": "petals.thickness",
    "leaves": "petals",
    "min_film": "surface.contact_film_thickness",
    "modulus": "petals.youngs_modulus",
    "mu": "gas.viscosity",
    "n": "petals.count",
    "nu": "petals.poisson_ratio",
    "number": "petals.count",
    "number_of_foils": "petals.count",
    "number_of_leaves": "petals.count",
    "number_of_petals": "petals.count",
    "omega": "operation.speed",
    "pressure": "gas.ambient_pressure",
    "radius": "bearing.journal_radius",
    "rotational_speed": "operation.speed",
    "roughness": "surface.contact_film_thickness",
    "rpm": "operation.speed",
    "shaft_radius": "bearing.journal_radius",
    "shaft_temperature": "shaft.temperature",
    "thermal_expansion": "shaft.expansion",
    "weight": "operation.load",
    "yield_stress": "petals.yield_strength",
}
"""Keys of before and of other codes, and the path of the key that is meant."""

SAME_WORD = {
    "built-in": "clamped",
    "cantilever": "clamped",
    "cantilevered": "clamped",
    "fixed": "clamped",
    "flat": "2d",
    "pinned": "hinged",
    "rigid": "clamped",
    "simply supported": "hinged",
    "spatial": "3d",
    "welded": "clamped",
}
"""Choices of before and of other codes, and the word that is meant."""

_EXPLAINED = (
    (r"diameter", "Diameters are not read: give bearing.journal_radius and bearing.bushing_radius."),
    (r"clearance", "The radial clearance follows: give bearing.journal_radius and bearing.bushing_radius."),
    (r"overlap", "The overlap follows from petals.arc_length and petals.count."),
    (
        r"tilt|misalign|slope",
        "The journal's axis is held at operation.tilt, or tilts under operation.moment, or with a rotor.span.",
    ),
    (r"backing|spring", "Springs behind petals stand in the table [backing]."),
    (
        r"bump_height",
        "The height of a bump follows from its half length and angle: give bump_foil.bump_half_angle, "
        "2 atan(height / half length).",
    ),
    (
        r"chord",
        "Lengths of petals are along the arc: give petals.arc_length, 2 R asin(chord / (2 R)) at the bend radius R.",
    ),
    (
        r"preload|crush|interference",
        "Preload follows: give the free shape (petals.bend_radius) and the radii of the bearing.",
    ),
    (r"bump|compliant|foundation", "Bump foils stand in the table [bump_foil], in place of [petals]."),
    (
        r"feed|supply|orifice|inlet|recess|porous",
        "External pressurisation is not modelled: the film is self-acting, fed from gas.ambient_pressure.",
    ),
    (r"turbul|reynolds_number", "Turbulence is not modelled: the film is laminar and without fluid inertia."),
    (r"groove|herringbone|texture|dimple", "Grooves and textures are not modelled: the surfaces are smooth."),
    (r"wear", "Wear is not modelled."),
    (
        r"heat|therm|conductivity|cooling|(wall|inlet)_temperature",
        "Heat is a network of conductances between film, shaft, pack and bushing: see the keys of [heat].",
    ),
)
"""Patterns of keys that no other key stands for, and what is modelled in their place; the first that fits counts."""


def nearest(name: object, known: Sequence[str], cutoff: float = 0.6) -> str:
    """Return " Did you mean '…'?" for the known name closest to `name`, or nothing."""
    matches = difflib.get_close_matches(str(name).lower(), known, n=1, cutoff=cutoff)
    return _question(matches[0]) if matches else ""


def nearest_word(word: object, known: Sequence[str]) -> str:
    """The same for one of a few choices."""
    same = SAME_WORD.get(str(word).lower().strip(), "")
    return _question(same) if same in known else nearest(word, known)


def nearest_key(name: str, section: str, paths: Sequence[str]) -> str:
    """Say what an unknown key was meant to be, or why there is none for it; nothing where neither is known.

    Parameters
    ----------
    name : str
        The key as it was written.
    section : str
        Path of its table; empty for the case itself.
    paths : sequence of str
        Dotted paths of all tables and keys.
    """
    plain = re.sub(r"[\s-]+", "_", name.strip().lower())
    here = [key for home, _, key in (path.rpartition(".") for path in paths) if home == section]
    if slip := nearest(plain, here, SLIP):
        return slip
    meant: str = SYNONYMS.get(plain, "") or next((path for path in paths if path.rpartition(".")[2] == plain), "")
    if meant:
        return _question(meant.removeprefix(f"{section}."))
    explained = next((words for pattern, words in _EXPLAINED if re.search(pattern, plain)), "")
    return f" {explained}" if explained else nearest(plain, here)


def _question(meant: str) -> str:
    return f" Did you mean {meant!r}?"
