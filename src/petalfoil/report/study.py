"""Under which assumption do the paper's sentences about its loads hold? Loads as ratios, one assumption at a time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from petalfoil.analysis.curve import curve
from petalfoil.mesh.quadrature import cubic_weights
from petalfoil.report.bounds import bounded_loads
from petalfoil.report.families import Progress
from petalfoil.report.scope import COMPARED, Scope
from petalfoil.report.variations import VARIATIONS, Variation
from petalfoil.results import Record

ALMOST_TWOFOLD = (1.6, 2.2)
"""What passes for "almost a two-fold increase"."""
TWO_TO_FOUR = (2.0, 4.0)

Triple = tuple[float, ...]


@dataclass(frozen=True)
class Loads:
    """One package under one set of assumptions.

    Attributes
    ----------
    count : int
        Petals.
    loads : tuple of float
        `|F|` at the compared displacements [N].
    push : float
        The film's push on the central journal, sum of its excess pressure over its area [N].
    share : float
        Largest contact share on the way [1].
    """

    count: int
    loads: Triple
    push: float
    share: float


@dataclass(frozen=True)
class Row:
    """The packages under one set of assumptions."""

    variation: Variation
    packages: tuple[Loads, ...]

    @property
    def ratios(self) -> Triple:
        """Load of the most petals over that of the fewest, at the compared displacements [1]."""
        return tuple(divided(b, a) for a, b in zip(self.packages[0].loads, self.packages[-1].loads, strict=True))

    @property
    def typical(self) -> float:
        """Median of the ratios [1]."""
        return float(np.median(self.ratios))

    @property
    def push_ratio(self) -> float:
        """The same ratio of the film's push on the central journal [1]."""
        return divided(self.packages[-1].push, self.packages[0].push)

    @property
    def share(self) -> float:
        """Largest contact share of all [1]."""
        return max(package.share for package in self.packages)

    @property
    def twofold(self) -> bool:
        """Whether "almost a two-fold increase" fits."""
        return within(self.typical, ALMOST_TWOFOLD)

    @property
    def two_to_four(self) -> bool:
        """Whether "increased by 2-4 times" fits."""
        return within(self.typical, TWO_TO_FOUR)


def divided(many: float, few: float) -> float:
    """Ratio of two loads; nan where it means nothing."""
    return many / few if few > 0.0 and many > 0.0 else math.nan


def within(value: float, limits: tuple[float, float]) -> bool:
    """Whether a number lies between limits."""
    return limits[0] <= value <= limits[1]


def run(scope: Scope, progress: Progress) -> tuple[Row, ...]:
    """All variations of the scope."""
    chosen = [v for v in VARIATIONS if not scope.studied or v.name in scope.studied]
    rows = []
    for number, variation in enumerate(chosen):
        progress(number / len(chosen), variation.says)
        rows.append(Row(variation, tuple(loads(variation, count, scope) for count in scope.counts)))
    return tuple(rows)


def loads(variation: Variation, count: int, scope: Scope) -> Loads:
    """Loads of one package."""
    case = variation.case(count, scope.study_cells)
    if variation.bounds:
        return Loads(count, *bounded_loads(case, COMPARED))
    central, *displaced = curve.records(case, (0.0, *COMPARED))
    share = max(float(record.reported().get("contact_fraction", math.nan)) for record in (central, *displaced))
    return Loads(count, tuple(load(record) for record in displaced), push(central), share)


def load(record: Record) -> float:
    """`|F|` of a point [N]; nan where it did not converge."""
    return float(record.reported().get("bearing_force", math.nan))


def push(record: Record) -> float:
    """Sum of the film's excess pressure over its area [N]; of a flat model times the length."""
    if not record.converged:
        return math.nan
    radius, length, p_a = (float(record.scalars[name]) for name in ("journal_radius", "length", "ambient_pressure"))
    excess = np.asarray(record.fields["pressure"], dtype=np.float64) - p_a
    phi, z = (np.asarray(record.coords[name], dtype=np.float64) for name in ("phi_exposed", "z"))
    along = np.trapezoid(excess, phi, axis=1).sum(axis=0)
    return float(radius * (along[0] * length if len(z) == 1 else along @ cubic_weights(z)))
