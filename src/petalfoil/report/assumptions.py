"""Loads under one changed assumption at a time: which of them gives the ratios of loads that the paper states?"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from petalfoil.analysis.curve import curve
from petalfoil.case import Case
from petalfoil.mesh.quadrature import cubic_weights
from petalfoil.report.fixed_bounds import bounded_loads
from petalfoil.report.load_characteristics import COMPARED, TANGENT, Progress, Scope
from petalfoil.report.paper_cases import paper_case
from petalfoil.results import Record
from petalfoil.walls.petals import petals_of

DEGREE = math.pi / 180.0
DOWNWARD = -0.5 * math.pi

ALMOST_TWOFOLD = (1.6, 2.2)
"""Range of ratios that counts as "almost a two-fold increase"."""
TWO_TO_FOUR = (2.0, 4.0)
"""Range of ratios of "increased by 2-4 times"."""


@dataclass(frozen=True)
class Assumption:
    """One set of assumptions.

    Attributes
    ----------
    name : str
        Key.
    description : str
        The difference from the reference.
    changes : mapping
        Changes of the case by dotted path.
    derived_changes : callable
        Further changes that depend on the case.
    fixed_bounds : bool
        Fixed bounds (21), (22) instead of contact between petals.
    """

    name: str
    description: str
    changes: Mapping[str, object] = field(default_factory=dict)
    derived_changes: Callable[[Case], Mapping[str, object]] = lambda case: {}
    fixed_bounds: bool = False

    def case(self, count: int, cells: int) -> Case:
        """The 2-D case of `count` petals with `cells` cells per pitch under these assumptions."""
        case = paper_case(count, **{"model.cells_per_pitch": cells, **self.changes})
        return case.replace(**self.derived_changes(case))


def middle_below(case: Case) -> Mapping[str, object]:
    """Roots turned so that the middle of an exposed strip lies below the journal."""
    return _turned(case, 0.5)


def edge_below(case: Case) -> Mapping[str, object]:
    """Roots turned so that a free edge lies below the journal."""
    return _turned(case, 1.0)


def _turned(case: Case, place: float) -> Mapping[str, object]:
    petals, geometry = petals_of(case)
    pitch, end = petals.pitch, petals.pitch * geometry.overlap
    return {"petals.first_root": math.remainder(DOWNWARD - end + (1.0 - place) * pitch, pitch)}


def short_arcs(case: Case) -> Mapping[str, object]:
    """Petals 1.8 pitches long for any number of petals: another reading of l = 1.8."""
    petals, geometry = petals_of(case)
    return {"petals.arc_length": 1.8 * petals.pitch * geometry.metric_radius}


def tilted(degrees: float, mount: str) -> Mapping[str, object]:
    """Another mount and root tilt [deg]."""
    return {"petals.mount": mount, "petals.root_tilt": degrees * DEGREE}


REFERENCE = Assumption("reference", "reference: hinged, chordal tilt (20.1°)")
CLAMPED = Assumption("clamped_tangent", "clamped tangentially to the bore (tilt 0°)", TANGENT)

ASSUMPTIONS = (
    REFERENCE,
    Assumption("hinged_0", "hinged, tilt 0°", tilted(0.0, "hinged")),
    Assumption("hinged_10", "hinged, tilt 10°", tilted(10.0, "hinged")),
    Assumption("hinged_25", "hinged, tilt 25°", tilted(25.0, "hinged")),
    Assumption("hinged_30", "hinged, tilt 30°", tilted(30.0, "hinged")),
    Assumption("hinged_45", "hinged, tilt 45°", tilted(45.0, "hinged")),
    Assumption("clamped_minus_3", "clamped, tilt −3°", tilted(-3.0, "clamped")),
    CLAMPED,
    Assumption("clamped_1", "clamped, tilt 1°", tilted(1.0, "clamped")),
    Assumption("clamped_5", "clamped, tilt 5°", tilted(5.0, "clamped")),
    Assumption("clamped_10", "clamped, tilt 10°", tilted(10.0, "clamped")),
    Assumption("clamped_chordal", "clamped, chordal tilt", {"petals.mount": "clamped"}),
    Assumption("floor", "contact film thickness 10 µm", {"surface.contact_film_thickness": 10e-6}),
    Assumption("edges", "film continuous across the edges of the petals", {"model.edges": "continuous"}),
    Assumption("middle", "displaced toward the middle of a petal", derived_changes=middle_below),
    Assumption("edge", "displaced toward a free edge", derived_changes=edge_below),
    Assumption("bronze", "petals with a Young's modulus of 110 GPa", {"petals.youngs_modulus": 110e9}),
    Assumption("slip", "gas with slip at the walls", {"model.slip": True}),
    Assumption("arcs", "petals 1.8 pitches long", derived_changes=short_arcs),
    Assumption("bounds", "fixed bounds (21), (22) between petals", fixed_bounds=True),
    Assumption("bounds_tangent", "fixed bounds, clamped, tilt 0°", TANGENT, fixed_bounds=True),
)


# ---------------------------------------------------------------------------------------------- results


@dataclass(frozen=True)
class PackLoads:
    """One pack under one set of assumptions.

    Attributes
    ----------
    count : int
        Number of petals.
    loads : tuple of float
        `|F|` at the compared displacements [N].
    film_normal_force : float
        Normal force of the film on the centred journal, `int (p - p_a) dA` [N].
    contact_fraction : float
        Largest contact fraction of all points [1].
    """

    count: int
    loads: tuple[float, ...]
    film_normal_force: float
    contact_fraction: float


@dataclass(frozen=True)
class AssumptionResult:
    """All packs under one set of assumptions."""

    assumption: Assumption
    packs: tuple[PackLoads, ...]

    @property
    def ratios(self) -> tuple[float, ...]:
        """Load with the most petals over load with the fewest, at the compared displacements [1]."""
        return tuple(ratio(b, a) for a, b in zip(self.packs[0].loads, self.packs[-1].loads, strict=True))

    @property
    def median_ratio(self) -> float:
        """Median of the ratios [1]."""
        return float(np.median(self.ratios))

    @property
    def normal_force_ratio(self) -> float:
        """The same ratio of the normal force of the film on the centred journal [1]."""
        return ratio(self.packs[-1].film_normal_force, self.packs[0].film_normal_force)

    @property
    def contact_fraction(self) -> float:
        """Largest contact fraction of all packs [1]."""
        return max(pack.contact_fraction for pack in self.packs)

    @property
    def twofold(self) -> bool:
        """Whether the median ratio agrees with "almost a two-fold increase"."""
        return within(self.median_ratio, ALMOST_TWOFOLD)

    @property
    def two_to_four(self) -> bool:
        """Whether the median ratio agrees with "increased by 2-4 times"."""
        return within(self.median_ratio, TWO_TO_FOUR)


def ratio(many: float, few: float) -> float:
    """Ratio of two positive forces; nan if one of them is not positive."""
    return many / few if few > 0.0 and many > 0.0 else math.nan


def within(value: float, limits: tuple[float, float]) -> bool:
    """Whether `value` lies between `limits`."""
    return limits[0] <= value <= limits[1]


def run(scope: Scope, progress: Progress) -> tuple[AssumptionResult, ...]:
    """Results of all assumptions of the scope."""
    chosen = [one for one in ASSUMPTIONS if not scope.assumptions or one.name in scope.assumptions]
    results = []
    for number, assumption in enumerate(chosen):
        progress(number / len(chosen), assumption.description)
        packs = tuple(pack_loads(assumption, count, scope) for count in scope.counts)
        results.append(AssumptionResult(assumption, packs))
    return tuple(results)


def pack_loads(assumption: Assumption, count: int, scope: Scope) -> PackLoads:
    """Loads of one pack."""
    case = assumption.case(count, scope.assumption_cells)
    if assumption.fixed_bounds:
        return PackLoads(count, *bounded_loads(case, COMPARED))
    centred, *displaced = curve.records(case, (0.0, *COMPARED))
    fraction = max(float(record.reported().get("contact_fraction", math.nan)) for record in (centred, *displaced))
    return PackLoads(count, tuple(load(record) for record in displaced), film_normal_force(centred), fraction)


def load(record: Record) -> float:
    """`|F|` of a point [N]; nan where it did not converge."""
    return float(record.reported().get("bearing_force", math.nan))


def film_normal_force(record: Record) -> float:
    """Normal force of the film on the journal, `int (p - p_a) dA` [N]; of a 2-D model per length times the length."""
    if not record.converged:
        return math.nan
    radius, length, p_a = (float(record.scalars[name]) for name in ("journal_radius", "length", "ambient_pressure"))
    excess = np.asarray(record.fields["pressure"], dtype=np.float64) - p_a
    phi, z = (np.asarray(record.coords[name], dtype=np.float64) for name in ("phi_exposed", "z"))
    along = np.trapezoid(excess, phi, axis=1).sum(axis=0)
    return float(radius * (along[0] * length if len(z) == 1 else along @ cubic_weights(z)))
