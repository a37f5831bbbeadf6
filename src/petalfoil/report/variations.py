"""The assumptions that the study varies, one at a time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from petalfoil.case import Case
from petalfoil.report.families import TANGENT
from petalfoil.report.paper import package
from petalfoil.walls.petals import petals_of

DEGREE = math.pi / 180.0
DOWNWARD = -0.5 * math.pi


@dataclass(frozen=True)
class Variation:
    """One set of assumptions.

    Attributes
    ----------
    name : str
        Key.
    says : str
        What is different from the reference, for people.
    changes : mapping
        Changes of the case by dotted path.
    changed : callable
        Further changes that depend on the package.
    bounds : bool
        Fixed bounds (21), (22) in place of contact between petals.
    """

    name: str
    says: str
    changes: Mapping[str, object] = field(default_factory=dict)
    changed: Callable[[Case], Mapping[str, object]] = lambda case: {}
    bounds: bool = False

    def case(self, count: int, cells: int) -> Case:
        """The package of `count` petals under these assumptions, flat."""
        case = package(count, **{"model.cells_per_pitch": cells, **self.changes})
        return case.replace(**self.changed(case))


def middle_below(case: Case) -> Mapping[str, object]:
    """Roots turned so that the middle of an exposed strip lies below."""
    return _turned(case, 0.5)


def edge_below(case: Case) -> Mapping[str, object]:
    """Roots turned so that a free edge lies below."""
    return _turned(case, 1.0)


def _turned(case: Case, place: float) -> Mapping[str, object]:
    petals, geometry = petals_of(case)
    pitch, end = petals.pitch, petals.pitch * geometry.overlap
    return {"petals.first_root": math.remainder(DOWNWARD - end + (1.0 - place) * pitch, pitch)}


def short_arcs(case: Case) -> Mapping[str, object]:
    """Petals as long as 1.8 pitches, whatever their number: the other way to read l = 1.8."""
    petals, geometry = petals_of(case)
    return {"petals.arc_length": 1.8 * petals.pitch * geometry.metric_radius}


def tilted(degrees: float, mount: str) -> Mapping[str, object]:
    """Another root tilt and mount."""
    return {"petals.mount": mount, "petals.root_tilt": degrees * DEGREE}


REFERENCE = Variation("reference", "reference: hinged, chordal tilt (20.1°)")
CLAMPED = Variation("clamped_tangent", "clamped along the bore's tangent (tilt 0°)", TANGENT)

VARIATIONS = (
    REFERENCE,
    Variation("hinged_0", "hinged, tilt 0°", tilted(0.0, "hinged")),
    Variation("hinged_10", "hinged, tilt 10°", tilted(10.0, "hinged")),
    Variation("hinged_25", "hinged, tilt 25°", tilted(25.0, "hinged")),
    Variation("hinged_30", "hinged, tilt 30°", tilted(30.0, "hinged")),
    Variation("hinged_45", "hinged, tilt 45°", tilted(45.0, "hinged")),
    Variation("clamped_minus_3", "clamped, tilt −3°", tilted(-3.0, "clamped")),
    CLAMPED,
    Variation("clamped_1", "clamped, tilt 1°", tilted(1.0, "clamped")),
    Variation("clamped_5", "clamped, tilt 5°", tilted(5.0, "clamped")),
    Variation("clamped_10", "clamped, tilt 10°", tilted(10.0, "clamped")),
    Variation("clamped_chordal", "clamped, chordal tilt", {"petals.mount": "clamped"}),
    Variation("floor", "film floor 10 µm", {"surface.contact_film_thickness": 10e-6}),
    Variation("edges", "film continuous across the petals' edges", {"model.edges": "continuous"}),
    Variation("middle", "displaced toward the middle of a petal", changed=middle_below),
    Variation("edge", "displaced toward a free edge", changed=edge_below),
    Variation("bronze", "petals of 110 GPa", {"petals.youngs_modulus": 110e9}),
    Variation("slip", "gas that slips at the walls", {"model.slip": True}),
    Variation("arcs", "petals 1.8 pitches long", changed=short_arcs),
    Variation("bounds", "fixed bounds (21), (22) between petals", bounds=True),
    Variation("bounds_tangent", "fixed bounds, clamped, tilt 0°", TANGENT, bounds=True),
)
