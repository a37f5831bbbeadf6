"""Claims of the paper beside computed results."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from statistics import median

from petalfoil.report.assumptions import ALMOST_TWOFOLD, TWO_TO_FOUR, AssumptionResult, ratio
from petalfoil.report.interpretations import Interpretation
from petalfoil.report.load_characteristics import COMPARED, CharacteristicFamily, LoadCharacteristic
from petalfoil.report.paper_grids import AT, COUNT, GridLoad

PAPER_ACCURACY = 1e-5
"""The calculation accuracy that the paper states [1]."""


class Verdict(StrEnum):
    """Whether a claim agrees with the results."""

    MET = "met"
    ELSEWHERE = "met under other assumptions"
    UNMET = "not met"


@dataclass(frozen=True)
class Claim:
    """One claim of the paper.

    Attributes
    ----------
    quote : str
        The claim.
    where : str
        Section of the paper.
    computed : str
        The results of this program.
    verdict : Verdict
        Whether they agree.
    """

    quote: str
    where: str
    computed: str
    verdict: Verdict


@dataclass(frozen=True, kw_only=True)
class Evidence:
    """All results of the report.

    Attributes
    ----------
    reference_2d, reference_3d : CharacteristicFamily
        The reference assumptions.
    tangent_2d, tangent_3d : CharacteristicFamily
        Petals clamped tangentially to the bore.
    assumptions : tuple of AssumptionResult
        Loads under every assumption.
    reference_interpretations, tangent_interpretations : tuple of Interpretation
        Other quantities under the two sets of assumptions.
    grids : tuple of GridLoad
        Loads on the grids of the paper.
    seconds : float
        Wall time of all calculations [s].
    """

    reference_2d: CharacteristicFamily
    reference_3d: CharacteristicFamily
    tangent_2d: CharacteristicFamily
    tangent_3d: CharacteristicFamily
    assumptions: tuple[AssumptionResult, ...]
    reference_interpretations: tuple[Interpretation, ...]
    tangent_interpretations: tuple[Interpretation, ...]
    grids: tuple[GridLoad, ...]
    seconds: float

    @property
    def families(self) -> tuple[CharacteristicFamily, ...]:
        """All load characteristics."""
        return self.reference_2d, self.reference_3d, self.tangent_2d, self.tangent_3d


def claims(evidence: Evidence) -> tuple[Claim, ...]:
    """All claims with the results that belong to them."""
    return (
        centred_journal(evidence),
        twofold(evidence),
        two_to_four(evidence),
        grid_range(evidence),
        accuracy(evidence),
        effort(evidence),
    )


def ratios_text(values: tuple[float, ...]) -> str:
    """Ratios at the compared displacements as text."""
    return ", ".join(f"{value:.2f}" if math.isfinite(value) else "–" for value in values)


def displacements_text() -> str:
    """The compared displacements as text."""
    return ", ".join(f"{e * 1e6:.0f}" for e in COMPARED[:-1]) + f" and {COMPARED[-1] * 1e6:.0f} µm"


def centred_journal(evidence: Evidence) -> Claim:
    """Figures 6 and 7: film around the centred journal."""
    curves = evidence.reference_2d.curves
    films = ", ".join(f"{curve.values('min_film_thickness')[0] * 1e6:.1f}" for curve in curves)
    peaks = ", ".join(
        f"{curve.values('peak_pressure')[0] / curve.values('ambient_pressure')[0]:.2f}" for curve in curves
    )
    contact = max(curve.values("contact_fraction")[0] for curve in curves)
    return Claim(
        "Pressure and film thickness over every petal around the centred journal, for n = 6, 8, 10",
        "3.8, Figures 6 and 7",
        f"minimum film thickness {films} µm, peak p/p_a {peaks}; solid contact carries {contact:.0%} of the normal "
        "force on the journal",
        Verdict.MET if contact == 0.0 else Verdict.UNMET,
    )


def agreeing(results: tuple[AssumptionResult, ...], limits: tuple[float, float]) -> list[str]:
    """Assumptions whose median ratio lies within limits."""
    return [row.assumption.description for row in results if limits[0] <= row.median_ratio <= limits[1]]


def verdict(evidence: Evidence, limits: tuple[float, float]) -> tuple[Verdict, str]:
    """Whether the reference or another assumption gives a ratio within limits, and which."""
    if limits[0] <= median(evidence.reference_2d.ratios) <= limits[1]:
        return Verdict.MET, ""
    names = agreeing(evidence.assumptions, limits)
    if not names:
        return Verdict.UNMET, "None of the assumptions gives this ratio."
    return Verdict.ELSEWHERE, f"This ratio follows with: {'; '.join(names)}."


def twofold(evidence: Evidence) -> Claim:
    """The claim of "almost a two-fold increase"."""
    few, many = evidence.reference_2d.curves[0].count, evidence.reference_2d.curves[-1].count
    agreement, where = verdict(evidence, ALMOST_TWOFOLD)
    computed = (
        f"{few} to {many} petals, e = {displacements_text()}: factors {ratios_text(evidence.reference_2d.ratios)} "
        f"(3-D: {ratios_text(evidence.reference_3d.ratios)}). Clamped tangentially to the bore: factors "
        f"{ratios_text(evidence.tangent_2d.ratios)} (3-D: {ratios_text(evidence.tangent_3d.ratios)}). {where}"
    )
    quote = (
        "“increasing the number of petals (n) in the package from 6 to 10 led to almost a two-fold increase in the "
        "load characteristic value”"
    )
    return Claim(quote, "3.8", computed.strip(), agreement)


def two_to_four(evidence: Evidence) -> Claim:
    """The claim of an increase "by 2–4 times"."""
    agreement, where = verdict(evidence, TWO_TO_FOUR)
    steps = "; ".join(
        f"{few.count} to {many.count} petals: factors {ratios_text(load_ratios(few, many))}"
        for few, many in pairwise(evidence.reference_2d.curves)
    )
    force = next(one.ratio for one in evidence.reference_interpretations if one.name == "film_normal_force")
    computed = (
        f"{steps}. The normal force of the film on the centred journal grows by a factor of {force:.2f} in total. "
        f"{where}"
    )
    quote = (
        "“the load-carrying capability of the bearing increased by 2–4 times with an increase in the number of petals”"
    )
    return Claim(quote, "abstract, 5", computed.strip(), agreement)


def load_ratios(few: LoadCharacteristic, many: LoadCharacteristic) -> tuple[float, ...]:
    """Load of one pack over the load of another at the compared displacements [1]."""
    return tuple(ratio(after, before) for before, after in zip(few.loads(), many.loads(), strict=True))


def grid_range(evidence: Evidence) -> Claim:
    """Grids of 17×11 to 35×30 nodes, stable from 24×17."""
    load_2d, load_3d = (reference_load(family) for family in (evidence.reference_2d, evidence.reference_3d))
    parts = []
    for grid in evidence.grids:
        reference = load_2d if grid.nodes[1] == 1 else load_3d
        name = f"{grid.nodes[0]} (2-D)" if grid.nodes[1] == 1 else f"{grid.nodes[0]}×{grid.nodes[1]}"
        difference = f"{grid.load / reference - 1.0:+.1%}".replace("-", "−")
        parts.append(f"{name} {difference}")
    converged = [grid for grid in evidence.grids if math.isfinite(grid.load)]
    computed = (
        f"{len(converged)} of {len(evidence.grids)} grids converge; difference of the load of {COUNT} petals at e = "
        f"{AT * 1e6:.0f} µm from that with {evidence.reference_2d.grid} (2-D) and {evidence.reference_3d.grid} (3-D): "
        f"{', '.join(parts)}. Newton's method has no limit of a time step"
    )
    quote = (
        "Stability studied on grids of 17×11 to 35×30 nodes; “stable convergence when the values of 24×17 were reached”"
    )
    return Claim(quote, "3.6", computed, Verdict.MET if len(converged) == len(evidence.grids) else Verdict.UNMET)


def reference_load(family: CharacteristicFamily) -> float:
    """Load with which the loads on the grids of the paper are compared [N]."""
    return next(curve.load(AT) for curve in family.curves if curve.count == COUNT)


def accuracy(evidence: Evidence) -> Claim:
    """The claim that an accuracy of 1e-5 suffices."""
    points = [record for family in evidence.families for record in family.points]
    worst = max(float(record.scalars["residual"]) for record in points)
    load_2d = reference_load(evidence.reference_2d)
    errors = [abs(grid.load / load_2d - 1.0) for grid in evidence.grids if grid.nodes[1] == 1]
    computed = (
        f"largest residual of {len(points)} points {worst:.0e} of the scale of its row. The error of the grid is much "
        f"larger, {min(errors):.1%} to {max(errors):.1%} of the load with the numbers of nodes of the paper. An "
        "accuracy beyond 1e-5 would not show there either"
    )
    quote = "“a calculation accuracy of 1e-5. A further increase in accuracy did not lead to an improvement in results”"
    return Claim(quote, "3.8, 5", computed, Verdict.MET if worst <= PAPER_ACCURACY else Verdict.UNMET)


def effort(evidence: Evidence) -> Claim:
    """The claim that a PC suffices."""
    points = evidence.reference_2d.points
    count = median(float(record.scalars["factorizations"]) for record in points)
    seconds = sum(float(record.scalars["wall_time"]) for record in points)
    computed = (
        f"{len(points)} points of the 2-D model in {seconds:.0f} s, median {count:.0f} factorisations; this report in "
        f"{evidence.seconds:.0f} s, on one core"
    )
    quote = "“fast convergence, no need for high computational capabilities (a PC was sufficient)”"
    return Claim(quote, "3.8", computed, Verdict.MET)
