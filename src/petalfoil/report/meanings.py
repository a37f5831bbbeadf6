"""What "load characteristic" may mean: the same ratio of other quantities, under two sets of assumptions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from petalfoil.analysis.static import static
from petalfoil.report.families import Curve, Family
from petalfoil.report.paper import package
from petalfoil.report.scope import Scope
from petalfoil.report.study import divided, load, push

SHARE_OF_ROOM = 0.4
"""Displacement over the room that the package leaves, for a comparison at like places."""
AT = 200e-6  # [m]


@dataclass(frozen=True)
class Meaning:
    """One quantity of all packages.

    Attributes
    ----------
    name : str
        Key.
    says : str
        The quantity, for people.
    unit : str
        Its unit.
    values : tuple of float
        For each number of petals, in that unit.
    """

    name: str
    says: str
    unit: str
    values: tuple[float, ...]

    @property
    def ratio(self) -> float:
        """Most petals over fewest [1]."""
        return divided(self.values[-1], self.values[0])


def meanings(family: Family, changes: Mapping[str, object], scope: Scope) -> tuple[Meaning, ...]:
    """Quantities that a sentence about the load of the flat model may speak of."""
    curves = family.curves
    rest = [_at_rest(curve.count, changes, scope) for curve in curves]
    displaced = f"e = {AT * 1e6:g} µm"
    return (
        Meaning("load", f"load |F|, {displaced}", "N", tuple(curve.load(AT) for curve in curves)),
        Meaning(
            "load_at_like_place",
            f"load |F|, e = {SHARE_OF_ROOM:g} of the room left",
            "N",
            tuple(map(_at_like_place, curves)),
        ),
        Meaning("slope", "slope of the load at the centre", "N/mm", tuple(map(_slope, curves))),
        Meaning(
            "push", "push of the film ∫(p − p_a) dA, journal central", "N", tuple(push(c.records[0]) for c in curves)
        ),
        Meaning("excess", "largest excess pressure, journal central", "kPa", tuple(map(_excess, curves))),
        Meaning(
            "preload", "sum of contact reactions at rest, journal central", "N", tuple(preload for preload, _ in rest)
        ),
        Meaning("load_at_rest", f"load at rest, {displaced}", "N", tuple(still for _, still in rest)),
        Meaning(
            "load_with_rest",
            f"load at rest plus load of the film, {displaced}",
            "N",
            tuple(still + curve.load(AT) for (_, still), curve in zip(rest, curves, strict=True)),
        ),
    )


def _at_rest(count: int, changes: Mapping[str, object], scope: Scope) -> tuple[float, float]:
    """Preload of the central journal and reaction at `AT`, no rotation [N]."""
    case = package(count, **{**changes, "model.cells_per_pitch": scope.flat_cells})
    central, displaced = static.records(case, (0.0, AT))
    return float(central.reported().get("contact_normal_force", math.nan)), load(displaced)


def _at_like_place(curve: Curve) -> float:
    return curve.load(SHARE_OF_ROOM * package(curve.count).pack_clearance)


def _slope(curve: Curve) -> float:
    """Load of the first displaced point over its displacement [N/mm]."""
    return 1e-3 * curve.figure("bearing_force")[1] / curve.displacements()[1]


def _excess(curve: Curve) -> float:
    central = curve.records[0]
    p_a = float(central.scalars["ambient_pressure"])
    return 1e-3 * (float(central.reported().get("peak_pressure", math.nan)) - p_a)
