"""Geometry of the assembled foil pack that follows from a bearing and its petals, and whether it can be built.

::

    r_m = R_B − δ/2        metric radius
    φ0  = 2π/n             pitch
    φ1  = l_p / r_m        angle of a petal;  φ1/φ0 = k + f,  0 ≤ f < 1
    φ3  = φ1 − φ0          angle covered by the neighbour; φ3 ≤ φ ≤ φ1 is exposed to the film   (G1)
    layers = k + 1         number of petals where the pack is thickest
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from petalfoil.case.free_shape import arc_radius, arc_reach, chordal_tilt, pulled_down_radius, pulled_down_tilt
from petalfoil.case.measured_shape import EDGE_TOLERANCE, Table, fitted_bend_radius, measured_radius
from petalfoil.case.petal_table import LinearAbout, Petal, Petals
from petalfoil.case.problems import Problem
from petalfoil.case.sections import Bearing, Operation, Surface
from petalfoil.units import format_quantity

MAX_ARC_ANGLE = 2.4  # rad; beyond it an arc is no longer a shallow shell (model of the free shape)
ROOT_TOLERANCE = 1e-9  # m; a measured root may lie outside the bore by rounding only
ROOT_SCATTER = 3.0  # standard deviations by which a measured root may lie outside the bore
KNOWN = 256  # packs that are remembered: a run asks for those of its cases hundreds of times
BEND_TOLERANCE = 0.05  # by which a stated bend radius may miss the measured shape's: what production scatters by
FLUSH = 1e-9  # pitches; an overlap this close below a whole number is that number, rounded


@dataclass(frozen=True, kw_only=True)
class PackGeometry:
    """Derived geometry of `count` overlapping petals; see the module's docstring."""

    count: int
    thickness: float
    """With coating, `δ` [m]."""
    metric_radius: float
    """`r_m` [m]."""
    petal_angle: float
    """`φ1` [rad]."""
    bend_radius: float
    """`R_p` [m]; of a measured free shape that of the circle which fits it best."""
    root_tilt: float
    """`ψ` [rad]; nan where a measured table gives the free shape."""
    about_bore: bool = False
    """Bending is linear about the bore, not about the free shape (G7)."""
    table: Table | None = None
    """Measured free shape, rows of angle [rad] and radius [m]."""
    table_tolerance: float = 0.0
    """Standard deviation of its radii [m]."""

    @property
    def pitch(self) -> float:
        """`φ0` [rad]."""
        return 2.0 * math.pi / self.count

    @property
    def overlap(self) -> float:
        """Petal angle over pitch, `φ1/φ0` [1]."""
        return self.petal_angle / self.pitch

    @property
    def layers(self) -> int:
        """Number of petals on top of each other where the pack is thickest."""
        return math.floor(self.overlap + FLUSH) + 1

    @property
    def covered_angle(self) -> float:
        """Angle from the root that the neighbour covers, `φ3` [rad]."""
        return self.petal_angle - self.pitch

    @property
    def reference_radius(self) -> float:
        """Radius of the shape about which bending is linear: `R_p`, or `r_m` of the bore [m]."""
        return self.metric_radius if self.about_bore else self.bend_radius

    def free_radius(self, phi: ArrayLike) -> NDArray[np.float64]:
        """Return the radius of the free mid-surface, `r0` [m], at angles `phi` from the root [rad]."""
        if self.table is not None:
            return measured_radius(phi, self.table, self.table_tolerance)
        radius = pulled_down_radius if self.about_bore else arc_radius
        return radius(phi, metric_radius=self.metric_radius, bend_radius=self.bend_radius, tilt=self.root_tilt)


@lru_cache(maxsize=KNOWN)
def pack_of(bearing: Bearing, petals: Petals) -> PackGeometry:
    """Derive the foil pack of `petals` in `bearing`; of unequal petals that of the mean one.

    A chordal tilt that does not exist comes out as nan; `pack_problems` says why.
    """
    metric_radius = bearing.bushing_radius - petals.total_thickness / 2.0
    return pack_with(bearing, petals, (petals.mean, petals.arc_length / metric_radius))


@lru_cache(maxsize=KNOWN)
def packs_of(bearing: Bearing, petals: Petals) -> tuple[PackGeometry, ...]:
    """The same of each petal: all span the angle of the mean one, and each lies on the bore with its own thickness.

    Petals whose thickness differs from the mean by `d` would span the angle `φ1 (1 + d / 2 R_B)` instead.
    """
    angle = pack_of(bearing, petals).petal_angle
    known = {petal: pack_with(bearing, petals, (petal, angle)) for petal in petals.each}
    return tuple(known[petal] for petal in petals.each)


def pack_with(bearing: Bearing, petals: Petals, one: tuple[Petal, float]) -> PackGeometry:
    """The pack as seen by `one` petal and its angle [rad]."""
    petal, angle = one
    metric_radius = bearing.bushing_radius - petal.total_thickness / 2.0
    bend_radius = _bend_radius(petals, petal)
    return PackGeometry(
        count=petals.count,
        thickness=petal.total_thickness,
        metric_radius=metric_radius,
        petal_angle=angle,
        bend_radius=bend_radius,
        root_tilt=_tilt(petals, petal, (metric_radius, bend_radius, angle)),
        about_bore=petals.linear_about is LinearAbout.BORE,
        table=petals.free_shape,
        table_tolerance=petals.free_shape_tolerance,
    )


def _bend_radius(petals: Petals, petal: Petal) -> float:
    if petals.free_shape is not None:
        return fitted_bend_radius(petals.free_shape)
    return math.nan if petal.bend_radius is None else petal.bend_radius  # nan never: `Petals` refuses it


def _tilt(petals: Petals, petal: Petal, arc: tuple[float, float, float]) -> float:
    metric_radius, bend_radius, petal_angle = arc
    if petals.free_shape is not None:
        return math.nan
    if petal.root_tilt != "chordal":
        return petal.root_tilt
    if bend_radius < metric_radius or petal_angle > MAX_ARC_ANGLE:
        return math.nan
    tilt = pulled_down_tilt if petals.linear_about is LinearAbout.BORE else chordal_tilt
    return tilt(metric_radius, bend_radius, petal_angle)


def solid_height(petals: Petals, layers: int) -> float:
    """Height of the solid pack where `layers` petals in a row are thickest [m]."""
    thickness = [petal.total_thickness for petal in petals.each]
    if len(set(thickness)) == 1:
        return layers * thickness[0]
    around = [*thickness, *thickness]
    return max(math.fsum(around[first : first + layers]) for first in range(petals.count))


def bearing_problems(
    bearing: Bearing, surface: Surface, operation: Operation, travel: float = 0.0
) -> Iterator[Problem]:
    """Yield what keeps a journal from fitting where it is asked to sit; the wall deflects by up to `travel`."""
    if bearing.clearance <= 0.0:
        yield Problem(
            "bearing.journal_radius",
            f"{_m(bearing.journal_radius)} does not fit into the bushing; allowed: less than bearing.bushing_radius, "
            f"{_m(bearing.bushing_radius)}",
            bearing.journal_radius,
            f"less than {bearing.bushing_radius:g} m",
        )
        return
    eccentricity = operation.farthest(bearing.length)
    farthest = bearing.clearance + travel - surface.contact_film_thickness
    if eccentricity >= farthest:
        yield Problem(
            "operation.eccentricity",
            f"the journal displaced by {_m(eccentricity)} touches the bushing by {_m(eccentricity - farthest)}; "
            f"allowed: less than the radial clearance less the contact film thickness, {_m(farthest)}",
            operation.eccentricity,
            f"less than {farthest:g} m",
        )


def pack_problems(bearing: Bearing, petals: Petals, surface: Surface, operation: Operation) -> Iterator[Problem]:
    """Yield what keeps a foil pack from being assembled: no overlap, no clearance (G2), no free shape."""
    if bearing.bushing_radius <= petals.total_thickness:
        yield Problem(
            "petals.thickness",
            f"a petal of {_m(petals.total_thickness)} is thicker than the bushing's radius, "
            f"{_m(bearing.bushing_radius)}; a number without a unit is in metres: write '0.1 mm'",
            petals.thickness,
            f"less than {bearing.bushing_radius:g} m",
        )
        return
    pack = pack_of(bearing, petals)
    if pack.petal_angle >= 2.0 * math.pi:
        longest = pack.metric_radius * 2.0 * math.pi
        yield Problem(
            "petals.arc_length",
            f"petals of {_m(petals.arc_length)} reach round the whole bore; allowed: less than {_m(longest)}",
            petals.arc_length,
            f"less than {longest:g} m",
        )
        return
    yield from _overlap_problems(pack, petals)
    yield from _clearance_problems(pack, petals, (bearing, surface, operation))
    yield from _shape_problems(pack, bearing, petals)


def _overlap_problems(pack: PackGeometry, petals: Petals) -> Iterator[Problem]:
    if pack.overlap > 1.0 + FLUSH:
        return
    shortest = pack.metric_radius * pack.pitch
    yield Problem(
        "petals.arc_length",
        f"petals of {_m(petals.arc_length)} do not overlap: {_m(shortest - petals.arc_length)} short of the distance "
        f"between the roots of {pack.count}; allowed: more than {_m(shortest)}",
        petals.arc_length,
        f"more than {shortest:g} m",
    )


def _clearance_problems(
    pack: PackGeometry, petals: Petals, around: tuple[Bearing, Surface, Operation]
) -> Iterator[Problem]:
    bearing, surface, operation = around
    eccentricity = operation.farthest(bearing.length)
    clearance = bearing.clearance - eccentricity
    need = solid_height(petals, pack.layers) + surface.contact_film_thickness
    if pack.overlap <= 1.0 + FLUSH or need <= clearance:
        return
    displaced = need <= bearing.clearance
    where = f", the clearance {_m(bearing.clearance)} less the eccentricity {_m(eccentricity)}," if eccentricity else ""
    yield Problem(
        "operation.eccentricity" if displaced else "petals",
        f"the foil pack does not fit: {pack.layers} layers of {_layer(pack, petals)} and the contact film "
        f"thickness {_m(surface.contact_film_thickness)} need {_m(need)}, "
        f"the radial clearance between journal and bushing{where} is {_m(clearance)}: "
        f"{_m(need - clearance)} too much",
        operation.eccentricity if displaced else pack.thickness,
        f"an eccentricity up to {bearing.clearance - need:g} m" if displaced else f"at most {clearance:g} m in all",
    )


def _layer(pack: PackGeometry, petals: Petals) -> str:
    """Thickness of a layer where the pack is thickest."""
    if len(set(petals.each)) == 1:
        return _m(pack.thickness)
    return f"{_m(solid_height(petals, pack.layers) / pack.layers)} on average"


def _shape_problems(pack: PackGeometry, bearing: Bearing, petals: Petals) -> Iterator[Problem]:
    if petals.free_shape is not None:
        found = list(_table_problems(pack, bearing, petals.free_shape))
        yield from found or _twice_given(pack, petals)
    elif pack.petal_angle > MAX_ARC_ANGLE:
        longest = MAX_ARC_ANGLE * pack.metric_radius
        yield Problem(
            "petals.arc_length",
            f"an arc of {_m(petals.arc_length)} spans {pack.petal_angle:.4g} rad, too far for a circular free "
            f"shape; allowed: up to {MAX_ARC_ANGLE} rad, {_m(longest)}",
            petals.arc_length,
            f"up to {longest:g} m",
        )
    else:
        for number, one in enumerate(packs_of(bearing, petals)):
            problems = list(_arc_problems(one, number, petals))
            yield from problems
            if problems:  # the first petal that cannot be made says what is wrong with the others
                return


def _key(petals: Petals, name: str, number: int) -> str:
    """Path of a field of one petal."""
    return f"petals.{name}[{number}]" if isinstance(getattr(petals, name), tuple) else f"petals.{name}"


def _arc_problems(pack: PackGeometry, number: int, petals: Petals) -> Iterator[Problem]:
    if math.isnan(pack.root_tilt):
        yield Problem(
            _key(petals, "bend_radius", number),
            f"a chordal petal bent to {_m(pack.bend_radius)} would lie outside the bore; allowed: at least the "
            f"metric radius, {_m(pack.metric_radius)} ({_m(pack.metric_radius - pack.bend_radius)} more), "
            "or another petals.root_tilt",
            pack.bend_radius,
            f"at least {pack.metric_radius:g} m",
        )
        return
    if pack.about_bore:  # a curve over the angle turns back nowhere
        return
    reach = arc_reach(metric_radius=pack.metric_radius, bend_radius=pack.bend_radius, tilt=pack.root_tilt)
    if reach <= pack.petal_angle:
        yield Problem(
            _key(petals, "root_tilt", number),
            f"an arc bent to {_m(pack.bend_radius)} with a root tilt of {pack.root_tilt:.4g} rad turns back at "
            f"{reach:.4g} rad and does not reach the free edge at {pack.petal_angle:.4g} rad "
            f"({pack.petal_angle - reach:.4g} rad short)",
            pack.root_tilt,
            "a tilt and a bend radius whose arc reaches the free edge",
        )


def _table_problems(pack: PackGeometry, bearing: Bearing, table: Table) -> Iterator[Problem]:
    last, root = table[-1][0], table[0][1]
    if last < pack.petal_angle - EDGE_TOLERANCE:
        yield Problem(
            "petals.free_shape",
            f"the table ends at {_deg(last)}, {_deg(pack.petal_angle - last)} short of the free edge at "
            f"{_deg(pack.petal_angle)}",
            last,
            f"a last angle of at least {pack.petal_angle:.8g} rad",
        )
    lowest = bearing.journal_radius + pack.thickness / 2.0
    outermost = pack.metric_radius + max(ROOT_TOLERANCE, ROOT_SCATTER * pack.table_tolerance)
    if not lowest <= root <= outermost:
        yield Problem(
            "petals.free_shape",
            f"the root, which cannot move, is at the radius {_m(root)}; allowed: from {_m(lowest)} (journal) to "
            f"{_m(outermost)} (bore)",
            root,
            f"a first radius from {lowest:g} m to {outermost:g} m",
        )


def _twice_given(pack: PackGeometry, petals: Petals) -> Iterator[Problem]:
    """Yield what contradicts a measured free shape."""
    given, measured = petals.mean.bend_radius, pack.bend_radius
    if given is not None and abs(given / measured - 1.0) > BEND_TOLERANCE:
        yield Problem(
            "petals.bend_radius",
            f"{_m(given)} contradicts the measured petals.free_shape, whose best circle has the radius {_m(measured)}; "
            f"allowed: within {100.0 * BEND_TOLERANCE:g} % of it, or no bend_radius",
            given,
            f"{measured:g} m",
        )
    if petals.root_tilt != "chordal":
        yield Problem(
            "petals.root_tilt",
            "is given beside a measured petals.free_shape, which has its own; allowed: one of the two",
            petals.root_tilt,
            "a root tilt or a measured free shape",
        )


def _deg(angle: float) -> str:
    return format_quantity(angle, "rad", digits=8)


def _m(length: float) -> str:
    return format_quantity(length, "m", digits=6)
