"""The page of the report: claims, figures, varied assumptions, unstated inputs."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import xarray as xr

from petalfoil import __version__, plot
from petalfoil.report import html, page_figures, page_tables
from petalfoil.report.assumptions import ALMOST_TWOFOLD, TWO_TO_FOUR
from petalfoil.report.claims import Claim, Evidence, Verdict, agreeing, claims
from petalfoil.report.load_characteristics import CharacteristicFamily
from petalfoil.report.page_tables import PageTable
from petalfoil.report.paper_cases import CITATION, DEPARTURES, DOI, STATED, UNSTATED

TITLE = "Figures and claims of the petal bearing paper, computed again"

SECTIONS = {
    "claims": "Claims of the paper and computed results",
    "figures67": "Figures 6 and 7: pressure and film thickness, centred journal",
    "figure8": "Figure 8: load against displacement",
    "assumptions": "Which assumption gives the increase of the load in the paper?",
    "interpretations": "Other quantities that “load characteristic” may denote",
    "grids": "Grids and accuracy",
    "unstated": "Inputs that the paper does not state, and the assumptions for them",
    "data": "Data",
}

HALF_PAGE = 5.4
"""Width of a figure beside another one [inch]."""

CLASSES = {Verdict.MET: "met", Verdict.ELSEWHERE: "elsewhere", Verdict.UNMET: "unmet"}


def render(evidence: Evidence, files: tuple[str, ...]) -> str:
    """The page as HTML; `files` are the names of the data files beside it."""
    body = (
        *opening(evidence),
        *claim_table(claims(evidence)),
        *figures_6_and_7(evidence),
        *figure_8(evidence),
        *assumptions(evidence),
        *interpretations(evidence),
        *grids(evidence),
        *unstated_inputs(),
        *data(files),
    )
    return html.page(TITLE, body)


def opening(evidence: Evidence) -> Iterator[str]:
    """Title, source, navigation and summary."""
    yield f"<h1>{escape(TITLE)}</h1>"
    yield html.paragraph(
        f"{CITATION}, doi:{DOI}. Computed by petalfoil {__version__} in {evidence.seconds:.0f} s.", "note"
    )
    links = "".join(f'<a href="#{name}">{escape(text)}</a>' for name, text in SECTIONS.items())
    yield f"<nav>{links}</nav>"
    yield html.paragraph(
        "The paper couples the gas film of a petal bearing with the bending of its overlapping petals. Its numerical "
        "part (section 3.8) is a 2-D model of three bearings with different numbers of petals. This report computes "
        "them again, in 2-D and in 3-D; the paper leaves 3-D for later. "
        f"Stated in the paper: {STATED}. Material, mount and root tilt of the petals, among others, are not stated. "
        "The assumptions for them are listed and varied below."
    )


def claim_table(rows: tuple[Claim, ...]) -> Iterator[str]:
    """Claims beside results."""
    yield html.section("claims", SECTIONS["claims"])
    body = "".join(map(claim_row, rows))
    head = "<tr><th style='width:31%'>the paper</th><th>this computation</th><th></th></tr>"
    yield f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"


def claim_row(claim: Claim) -> str:
    """One claim."""
    quote = f"{html.prose(claim.quote)}<br><span class='note'>{html.prose(claim.where)}</span>"
    agreement = f"<td class='verdict {CLASSES[claim.verdict]}'>{escape(claim.verdict)}</td>"
    return f"<tr><td>{quote}</td><td>{html.prose(claim.computed)}</td>{agreement}</tr>"


def figures_6_and_7(evidence: Evidence) -> Iterator[str]:
    """Pressure and film thickness."""
    yield html.section("figures67", SECTIONS["figures67"])
    yield html.paragraph(
        "The figures show the part of a petal that bounds the film, from the free edge of the previous petal to its "
        "own free edge. All petals are alike around the centred journal. The dimensionless film thickness of the "
        "paper is h / H*, H* = 1 mm: divide micrometres by 1000."
    )
    family_2d, family_3d = evidence.reference_2d, evidence.reference_3d
    yield html.picture(
        plot.petal_profiles(centred(family_2d)), f"2-D model, {family_2d.grid}; {family_2d.description}."
    )
    yield html.picture(
        plot.petal_profiles(centred(family_3d)),
        f"3-D model at its mid-plane, {family_3d.grid}; {family_3d.description}.",
    )
    yield html.picture(
        page_figures.petal_maps(centred(family_3d)),
        "3-D model: pressure and film thickness over the petal and the length.",
    )


def centred(family: CharacteristicFamily) -> list[tuple[str, xr.Dataset]]:
    """The converged points with a centred journal, with their labels."""
    return [(curve.label, curve.dataset.isel(point=0)) for curve in family.curves if curve.records[0].converged]


def characteristic(family: CharacteristicFamily, model: str) -> str:
    """One family as a picture of Figure 8."""
    curves = [(curve.label, curve.dataset) for curve in family.curves]
    caption = f"{model}, {family.grid}. {family.description.capitalize()}."
    return html.picture(plot.load_characteristic(curves), caption, HALF_PAGE)


def figure_8(evidence: Evidence) -> Iterator[str]:
    """Load against displacement, under two sets of assumptions."""
    yield html.section("figure8", SECTIONS["figure8"])
    yield html.paragraph(
        "Hinged petals turn about their roots without resistance. Six hinged petals touch each other at their free "
        "edges only, and yield together as a ring. Their load increases from about 200 µm, where the journal also "
        "presses the middles of the petals onto each other. Eight and ten petals touch there at any displacement. "
        "Each clamped petal resists by its own bending: ten carry about twice the load of six."
    )
    yield html.pair(characteristic(evidence.reference_2d, "2-D"), characteristic(evidence.reference_3d, "3-D"))
    yield html.pair(characteristic(evidence.tangent_2d, "2-D"), characteristic(evidence.tangent_3d, "3-D"))
    for pair in ((evidence.reference_2d, evidence.tangent_2d), (evidence.reference_3d, evidence.tangent_3d)):
        yield html.pair(*(f"<div>{load_table(family)}</div>" for family in pair))


def load_table(family: CharacteristicFamily) -> str:
    """Loads of a family with its assumptions."""
    model = "3-D" if family.name.endswith("3d") else "2-D"
    return html.paragraph(f"{model}, {family.description}:", "note") + html.table(page_tables.loads(family))


def assumptions(evidence: Evidence) -> Iterator[str]:
    """Ratios of the loads under every assumption."""
    yield html.section("assumptions", SECTIONS["assumptions"])
    low, high = ALMOST_TWOFOLD
    few, many = evidence.reference_2d.curves[0].count, evidence.reference_2d.curves[-1].count
    yield html.paragraph(
        "Each row changes one assumption, in 2-D on a coarser grid. A row agrees with “almost two-fold” if the "
        f"median of its three ratios is {low:g} to {high:g}, and with “2–4 times” if it is {TWO_TO_FOUR[0]:g} to "
        f"{TWO_TO_FOUR[1]:g}. The normal force of the film is ∫(p − p_a) dA with a centred journal, {many} over {few} "
        "petals; a dash stands where the film pressure is on average below ambient. Where the contact fraction is "
        "close to 100 %, hardly any film remains."
    )
    yield html.picture(
        page_figures.load_ratios(evidence.assumptions),
        "Increase of the load with the number of petals under every assumption.",
    )
    yield html.bullets(findings(evidence))
    marked = [number for number, row in enumerate(evidence.assumptions) if row.twofold]
    yield html.table(page_tables.assumption_ratios(evidence.assumptions), marked)


def findings(evidence: Evidence) -> Iterator[str]:
    """Results of the varied assumptions as sentences."""
    ranges = (("Almost two-fold", ALMOST_TWOFOLD), ("2–4 times", TWO_TO_FOUR), ("Decrease", (0.0, 1.0)))
    for name, limits in ranges:
        yield f"{name}: {'; '.join(agreeing(evidence.assumptions, limits)) or 'none of these'}."
    yield (
        "Contact film thickness, edges, gas and direction of the displacement have little influence. Mount and root "
        "tilt have a large one, and the paper states neither."
    )


def interpretations(evidence: Evidence) -> Iterator[str]:
    """Other quantities."""
    yield html.section("interpretations", SECTIONS["interpretations"])
    yield html.paragraph(
        "The claim names the load characteristic, the modulus of (64), but no displacement. The table shows the same "
        "ratio of other quantities, for the reference and for petals clamped tangentially to the bore."
    )
    counts = tuple(curve.count for curve in evidence.reference_2d.curves)
    yield html.table(
        page_tables.interpretations(evidence.reference_interpretations, evidence.tangent_interpretations, counts)
    )


def grids(evidence: Evidence) -> Iterator[str]:
    """Loads on the grids of the paper."""
    yield html.section("grids", SECTIONS["grids"])
    yield html.paragraph(
        "The paper counts nodes per petal and along the axis. Its explicit scheme has a time step limited by the "
        "grid. Here every grid is solved from a cold start, with 8 petals and e = 200 µm. The number of axial nodes is "
        "odd, so that one node lies in the plane of symmetry."
    )
    yield html.table(page_tables.grids(evidence.grids))


def unstated_inputs() -> Iterator[str]:
    """Inputs that the paper does not state, and departures from its equations."""
    yield html.section("unstated", SECTIONS["unstated"])
    rows = tuple((one.what, one.paper, one.assumed) for one in UNSTATED)
    yield html.table(PageTable(("", "the paper", "assumed here"), rows))
    yield html.paragraph("Departures of this computation from the printed equations:")
    yield html.bullets(DEPARTURES)


def data(files: tuple[str, ...]) -> Iterator[str]:
    """Links to the data files."""
    yield html.section("data", SECTIONS["data"])
    links = "".join(f'<li><a href="{escape(name)}">{escape(name)}</a></li>' for name in files)
    yield f"<ul>{links}</ul>"
    yield html.paragraph(
        "NetCDF files contain all fields of all points with their case; open them with `petalfoil show FILE` or "
        "xarray. CSV files and report.json are in SI units; assumptions.csv is in the units of its headings."
    )
