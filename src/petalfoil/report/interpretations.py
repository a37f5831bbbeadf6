"""Other quantities that "load characteristic" may denote, and their ratios, under two sets of assumptions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from petalfoil.analysis.static import static
from petalfoil.report.assumptions import film_normal_force, load, ratio
from petalfoil.report.load_characteristics import CharacteristicFamily, LoadCharacteristic, Scope
from petalfoil.report.paper_cases import paper_case

CLEARANCE_FRACTION = 0.4
"""Displacement over the clearance above the solid pack height, for a comparison at equal relative displacement [1]."""
AT = 200e-6
"""Displacement of the compared loads [m]."""


@dataclass(frozen=True)
class Interpretation:
    """One quantity of all packs.

    Attributes
    ----------
    name : str
        Key.
    description : str
        The quantity.
    unit : str
        Its unit.
    values : tuple of float
        Its value for each number of petals, in that unit.
    """

    name: str
    description: str
    unit: str
    values: tuple[float, ...]

    @property
    def ratio(self) -> float:
        """Value with the most petals over value with the fewest [1]."""
        return ratio(self.values[-1], self.values[0])


def interpretations(
    family: CharacteristicFamily, changes: Mapping[str, object], scope: Scope
) -> tuple[Interpretation, ...]:
    """Quantities of the 2-D model that a sentence about its load may denote."""
    curves = family.curves
    at_rest = [_at_zero_speed(curve.count, changes, scope) for curve in curves]
    displaced = f"e = {AT * 1e6:g} µm"
    return (
        Interpretation("load", f"load |F|, {displaced}", "N", tuple(curve.load(AT) for curve in curves)),
        Interpretation(
            "load_at_equal_clearance_fraction",
            f"load |F|, e = {CLEARANCE_FRACTION:g} of the clearance above the solid pack height",
            "N",
            tuple(map(_at_clearance_fraction, curves)),
        ),
        Interpretation("stiffness", "stiffness at the centred position", "N/mm", tuple(map(_stiffness, curves))),
        Interpretation(
            "film_normal_force",
            "normal force of the film ∫(p − p_a) dA, centred journal",
            "N",
            tuple(film_normal_force(curve.records[0]) for curve in curves),
        ),
        Interpretation("peak_excess", "peak excess pressure, centred journal", "kPa", tuple(map(_excess, curves))),
        Interpretation(
            "preload",
            "sum of contact reactions at zero speed, centred journal",
            "N",
            tuple(preload for preload, _ in at_rest),
        ),
        Interpretation(
            "load_at_zero_speed", f"load at zero speed, {displaced}", "N", tuple(still for _, still in at_rest)
        ),
        Interpretation(
            "sum_of_loads",
            f"load at zero speed plus load |F|, {displaced}",
            "N",
            tuple(still + curve.load(AT) for (_, still), curve in zip(at_rest, curves, strict=True)),
        ),
    )


def _at_zero_speed(count: int, changes: Mapping[str, object], scope: Scope) -> tuple[float, float]:
    """Preload of the centred journal, and load at `AT`, both at zero speed [N]."""
    case = paper_case(count, **{**changes, "model.cells_per_pitch": scope.cells_2d})
    centred, displaced = static.records(case, (0.0, AT))
    return float(centred.reported().get("contact_normal_force", math.nan)), load(displaced)


def _at_clearance_fraction(curve: LoadCharacteristic) -> float:
    return curve.load(CLEARANCE_FRACTION * paper_case(curve.count).pack_clearance)


def _stiffness(curve: LoadCharacteristic) -> float:
    """Load of the first displaced point over its displacement [N/mm]."""
    return 1e-3 * curve.values("bearing_force")[1] / curve.displacements()[1]


def _excess(curve: LoadCharacteristic) -> float:
    centred = curve.records[0]
    p_a = float(centred.scalars["ambient_pressure"])
    return 1e-3 * (float(centred.reported().get("peak_pressure", math.nan)) - p_a)
