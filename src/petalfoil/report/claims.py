"""The paper's claims beside this program's numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from statistics import median

from petalfoil.report.families import Curve, Family
from petalfoil.report.grids import AT, COUNT, Grid
from petalfoil.report.meanings import Meaning
from petalfoil.report.scope import COMPARED
from petalfoil.report.study import ALMOST_TWOFOLD, TWO_TO_FOUR, Row, divided

PAPER_ACCURACY = 1e-5


class Verdict(StrEnum):
    """How a claim stands."""

    MET = "met"
    ELSEWHERE = "met under other assumptions"
    UNMET = "not met"


@dataclass(frozen=True)
class Claim:
    """One sentence of the paper.

    Attributes
    ----------
    quote : str
        What it says.
    where : str
        Where.
    ours : str
        This program's numbers.
    verdict : Verdict
        How it stands.
    """

    quote: str
    where: str
    ours: str
    verdict: Verdict


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """All that was run.

    Attributes
    ----------
    flat, spatial : Family
        The reference assumptions.
    tangent, tangent_spatial : Family
        Roots clamped along the bore's tangent.
    study : tuple of study.Row
        Loads under every assumption.
    meanings, tangent_meanings : tuple of Meaning
        Other quantities under the two sets.
    grids : tuple of Grid
        The paper's grids.
    seconds : float
        Wall time of everything [s].
    """

    flat: Family
    spatial: Family
    tangent: Family
    tangent_spatial: Family
    study: tuple[Row, ...]
    meanings: tuple[Meaning, ...]
    tangent_meanings: tuple[Meaning, ...]
    grids: tuple[Grid, ...]
    seconds: float

    @property
    def families(self) -> tuple[Family, ...]:
        """All load characteristics."""
        return self.flat, self.spatial, self.tangent, self.tangent_spatial


def claims(evidence: Evidence) -> tuple[Claim, ...]:
    """Every claim with the numbers that belong to it."""
    return (
        central(evidence),
        twofold(evidence),
        two_to_four(evidence),
        grid_range(evidence),
        accuracy(evidence),
        effort(evidence),
    )


def ratios(values: tuple[float, ...]) -> str:
    """Ratios at the compared displacements, for people."""
    return ", ".join(f"{value:.2f}" if math.isfinite(value) else "–" for value in values)


def displaced() -> str:
    """The compared displacements, for people."""
    return ", ".join(f"{e * 1e6:.0f}" for e in COMPARED[:-1]) + f" and {COMPARED[-1] * 1e6:.0f} µm"


def central(evidence: Evidence) -> Claim:
    """Figures 6 and 7: a film around the central journal."""
    curves = evidence.flat.curves
    films = ", ".join(f"{curve.figure('min_film_thickness')[0] * 1e6:.1f}" for curve in curves)
    peaks = ", ".join(
        f"{curve.figure('peak_pressure')[0] / curve.figure('ambient_pressure')[0]:.2f}" for curve in curves
    )
    touching = max(curve.figure("contact_fraction")[0] for curve in curves)
    return Claim(
        "Pressure and film thickness over every petal around the central journal, for n = 6, 8, 10",
        "3.8, Figures 6 and 7",
        f"smallest film {films} µm, largest p/p_a {peaks}; contacts carry {touching:.0%} of the push on the journal",
        Verdict.MET if touching == 0.0 else Verdict.UNMET,
    )


def fitting(rows: tuple[Row, ...], limits: tuple[float, float]) -> list[str]:
    """The assumptions whose typical ratio lies within limits."""
    return [row.variation.says for row in rows if limits[0] <= row.typical <= limits[1]]


def verdict(evidence: Evidence, limits: tuple[float, float]) -> tuple[Verdict, str]:
    """Whether a ratio of loads is met by the reference, elsewhere or nowhere; and where."""
    typical = median(evidence.flat.ratios)
    if limits[0] <= typical <= limits[1]:
        return Verdict.MET, ""
    found = fitting(evidence.study, limits)
    if not found:
        return Verdict.UNMET, "None of the assumptions tried gives it."
    return Verdict.ELSEWHERE, f"It is met with: {'; '.join(found)}."


def twofold(evidence: Evidence) -> Claim:
    """The claim of "almost a two-fold increase"."""
    few, many = evidence.flat.curves[0].count, evidence.flat.curves[-1].count
    how, where = verdict(evidence, ALMOST_TWOFOLD)
    ours = (
        f"{few} to {many} petals, e = {displaced()}: times {ratios(evidence.flat.ratios)} (in space "
        f"{ratios(evidence.spatial.ratios)}). Roots clamped along the bore's tangent: times "
        f"{ratios(evidence.tangent.ratios)} (in space {ratios(evidence.tangent_spatial.ratios)}). {where}"
    )
    quote = (
        "“increasing the number of petals (n) in the package from 6 to 10 led to almost a two-fold increase in the "
        "load characteristic value”"
    )
    return Claim(quote, "3.8", ours.strip(), how)


def two_to_four(evidence: Evidence) -> Claim:
    """The claim of an increase "by 2–4 times"."""
    how, where = verdict(evidence, TWO_TO_FOUR)
    step = "; ".join(
        f"{few.count} to {many.count} petals: times {ratios(grown(few, many))}"
        for few, many in pairwise(evidence.flat.curves)
    )
    push = next(meaning.ratio for meaning in evidence.meanings if meaning.name == "push")
    ours = f"{step}. The push of the film on the central journal grows {push:.2f} times in all. {where}"
    quote = (
        "“the load-carrying capability of the bearing increased by 2–4 times with an increase in the number of petals”"
    )
    return Claim(quote, "abstract, 5", ours.strip(), how)


def grown(few: Curve, many: Curve) -> tuple[float, ...]:
    """Load of one package over that of another at the compared displacements [1]."""
    return tuple(divided(after, before) for before, after in zip(few.loads(), many.loads(), strict=True))


def grid_range(evidence: Evidence) -> Claim:
    """17×11 … 35×30, stable from 24×17."""
    flat, space = (reference_load(family) for family in (evidence.flat, evidence.spatial))
    parts = []
    for grid in evidence.grids:
        known = flat if grid.nodes[1] == 1 else space
        name = f"{grid.nodes[0]} flat" if grid.nodes[1] == 1 else f"{grid.nodes[0]}×{grid.nodes[1]}"
        parts.append(f"{name} {grid.load / known - 1.0:+.1%}".replace("-", "−"))
    ours = (
        f"an answer on every grid, load of {COUNT} petals at e = {AT * 1e6:.0f} µm against {evidence.flat.grid} (flat) "
        f"and {evidence.spatial.grid} (space): {', '.join(parts)}. A Newton method has no bound on a step in time"
    )
    quote = (
        "Stability studied on grids of 17×11 to 35×30 nodes; “stable convergence when the values of 24×17 were reached”"
    )
    every = all(math.isfinite(grid.load) for grid in evidence.grids)
    return Claim(quote, "3.6", ours, Verdict.MET if every else Verdict.UNMET)


def reference_load(family: Family) -> float:
    """Load that the paper's grids are measured against [N]."""
    return next(curve.load(AT) for curve in family.curves if curve.count == COUNT)


def accuracy(evidence: Evidence) -> Claim:
    """1e-5."""
    points = [record for family in evidence.families for record in family.points]
    worst = max(float(record.scalars["residual"]) for record in points)
    offs = [abs(grid.load / reference_load(evidence.flat) - 1.0) for grid in evidence.grids if grid.nodes[1] == 1]
    ours = (
        f"largest residual of {len(points)} points {worst:.0e} of what its row adds up. The grid leaves much more: "
        f"{min(offs):.1%} to {max(offs):.1%} of the load on the paper's numbers of nodes, so that accuracy beyond 1e-5 "
        "would not show there either"
    )
    quote = "“a calculation accuracy of 1e-5. A further increase in accuracy did not lead to an improvement in results”"
    return Claim(quote, "3.8, 5", ours, Verdict.MET if worst <= PAPER_ACCURACY else Verdict.UNMET)


def effort(evidence: Evidence) -> Claim:
    """A PC is enough."""
    flat = [record for curve in evidence.flat.curves for record in curve.records]
    count = median(float(record.scalars["factorizations"]) for record in flat)
    seconds = sum(float(record.scalars["wall_time"]) for record in flat)
    ours = (
        f"{len(flat)} flat points in {seconds:.0f} s, {count:.0f} factorisations in the median; this whole report "
        f"in {evidence.seconds:.0f} s, on one core"
    )
    return Claim(
        "“fast convergence, no need for high computational capabilities (a PC was sufficient)”",
        "3.8",
        ours,
        Verdict.MET,
    )
