"""The page: claims, figures, the study, what was assumed."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape

import xarray as xr

from petalfoil import __version__, plot
from petalfoil.report import figures, html, tables
from petalfoil.report.claims import Claim, Evidence, Verdict, claims, fitting
from petalfoil.report.families import Family
from petalfoil.report.paper import CITATION, DEPARTURES, DOI, SILENT, STATED
from petalfoil.report.study import ALMOST_TWOFOLD, TWO_TO_FOUR
from petalfoil.report.tables import Table

TITLE = "The figures and claims of the petal bearing paper, computed anew"

SECTIONS = {
    "claims": "The paper’s claims beside these numbers",
    "figures67": "Figures 6 and 7: pressure and film, journal central",
    "figure8": "Figure 8: load against displacement",
    "study": "Which assumption gives the paper’s growth of the load?",
    "meanings": "What else could “load characteristic” mean?",
    "grids": "Grids and accuracy",
    "silent": "Where the paper is silent, and what was assumed",
    "data": "Data",
}

HALF_PAGE = 5.4
"""Width of a figure that is shown beside another [inch]."""

CLASSES = {Verdict.MET: "met", Verdict.ELSEWHERE: "elsewhere", Verdict.UNMET: "unmet"}


def render(evidence: Evidence, files: tuple[str, ...]) -> str:
    """The whole page; `files` are the data beside it."""
    body = (
        *opening(evidence),
        *claim_table(claims(evidence)),
        *figures_6_and_7(evidence),
        *figure_8(evidence),
        *study(evidence),
        *meanings(evidence),
        *grids(evidence),
        *silences(),
        *data(files),
    )
    return html.page(TITLE, body)


def opening(evidence: Evidence) -> Iterator[str]:
    """Title, what this is, where to find what."""
    yield f"<h1>{escape(TITLE)}</h1>"
    yield html.paragraph(
        f"{CITATION}, doi:{DOI}. Computed by petalfoil {__version__} in {evidence.seconds:.0f} s.", "note"
    )
    links = "".join(f'<a href="#{name}">{escape(text)}</a>' for name, text in SECTIONS.items())
    yield f"<nav>{links}</nav>"
    yield html.paragraph(
        "The paper couples the gas film of a petal bearing with the bending of its overlapping petals. Its numerical "
        "part (section 3.8) is a flat model of three bearings that differ in their number of petals. Here they are "
        "solved again, flat as there and with the axial coordinate that the paper left for later. "
        f"Stated there: {STATED}. What is not stated, the first of all material, mount and tilt of the petals, had to "
        "be assumed; the assumptions are named below, and varied."
    )


def claim_table(found: tuple[Claim, ...]) -> Iterator[str]:
    """Claims beside numbers."""
    yield html.section("claims", SECTIONS["claims"])
    rows = "".join(map(claim_row, found))
    head = "<tr><th style='width:31%'>the paper</th><th>this computation</th><th></th></tr>"
    yield f"<table><thead>{head}</thead><tbody>{rows}</tbody></table>"


def claim_row(claim: Claim) -> str:
    """One claim."""
    quote = f"{html.prose(claim.quote)}<br><span class='note'>{html.prose(claim.where)}</span>"
    stands = f"<td class='verdict {CLASSES[claim.verdict]}'>{escape(claim.verdict)}</td>"
    return f"<tr><td>{quote}</td><td>{html.prose(claim.ours)}</td>{stands}</tr>"


def figures_6_and_7(evidence: Evidence) -> Iterator[str]:
    """Pressure and film."""
    yield html.section("figures67", SECTIONS["figures67"])
    yield html.paragraph(
        "Over the part of a petal that faces the journal, from where the petal before it ends to its own free edge. "
        "With the journal central all petals are alike. The paper’s dimensionless film is h / H*, H* = 1 mm: divide "
        "micrometres by 1000."
    )
    flat, space = evidence.flat, evidence.spatial
    yield html.picture(plot.petal_profiles(central(flat)), f"Flat model, {flat.grid}; {flat.says}.")
    yield html.picture(
        plot.petal_profiles(central(space)), f"Spatial model at its mid-plane, {space.grid}; {space.says}."
    )
    yield html.picture(
        figures.petal_maps(central(space)), "Spatial model: pressure and film over the same part and the length."
    )


def central(family: Family) -> list[tuple[str, xr.Dataset]]:
    """The central points of a family that converged, with their labels."""
    return [(curve.label, curve.dataset.isel(point=0)) for curve in family.curves if curve.records[0].converged]


def characteristic(family: Family, caption: str) -> str:
    """One family's picture of Figure 8."""
    curves = [(curve.label, curve.dataset) for curve in family.curves]
    words = f"{caption}, {family.grid}. {family.says.capitalize()}."
    return html.picture(plot.load_characteristic(curves), words, HALF_PAGE)


def figure_8(evidence: Evidence) -> Iterator[str]:
    """Load against displacement, under two sets of assumptions."""
    yield html.section("figure8", SECTIONS["figure8"])
    yield html.paragraph(
        "Hinged petals turn about their roots without resistance. Six of them lean on each other with their free edges "
        "alone, and give way as a ring; their load rises where the journal also presses them onto each other in their "
        "middles, from about 200 µm. Eight and ten are held like that from the start. Petals clamped along the bore "
        "resist each for itself: about twice the load with ten instead of six."
    )
    yield html.pair(characteristic(evidence.flat, "Flat"), characteristic(evidence.spatial, "In space"))
    yield html.pair(characteristic(evidence.tangent, "Flat"), characteristic(evidence.tangent_spatial, "In space"))
    for one, other in ((evidence.flat, evidence.tangent), (evidence.spatial, evidence.tangent_spatial)):
        yield html.pair(*(f"<div>{described(family)}</div>" for family in (one, other)))


def described(family: Family) -> str:
    """Loads of a family with what they belong to."""
    kind = "In space" if family.name.endswith("spatial") else "Flat"
    return html.paragraph(f"{kind}, {family.says}:", "note") + html.table(tables.loads(family))


def study(evidence: Evidence) -> Iterator[str]:
    """Ratios under every assumption."""
    yield html.section("study", SECTIONS["study"])
    low, high = ALMOST_TWOFOLD
    few, many = evidence.flat.curves[0].count, evidence.flat.curves[-1].count
    yield html.paragraph(
        "One assumption at a time, flat, on a coarser grid. A row fits “almost two-fold” where the median of its "
        f"three ratios is {low:g} to {high:g}, and “2–4 times” where it is {TWO_TO_FOUR[0]:g} to {TWO_TO_FOUR[1]:g}. "
        f"“Push” is the same ratio of ∫(p − p_a) dA with the journal central, {many} over {few} petals; a dash, where "
        "the film sucks. Where contacts carry most, there is no film to speak of."
    )
    yield html.picture(
        figures.study(evidence.study), "Growth of the load with the number of petals under every assumption."
    )
    yield html.bullets(findings(evidence))
    marked = [number for number, row in enumerate(evidence.study) if row.twofold]
    yield html.table(tables.study(evidence.study), marked)


def findings(evidence: Evidence) -> Iterator[str]:
    """What the study says, in words."""
    rows = evidence.study
    for words, limits in (("Almost two-fold", ALMOST_TWOFOLD), ("2–4 times", TWO_TO_FOUR), ("Falling", (0.0, 1.0))):
        yield f"{words}: {'; '.join(fitting(rows, limits)) or 'none of these'}."
    yield (
        "Film floor, edges, gas and the direction of the displacement change little; mount and root tilt decide. "
        "Neither does the paper state."
    )


def meanings(evidence: Evidence) -> Iterator[str]:
    """Other quantities."""
    yield html.section("meanings", SECTIONS["meanings"])
    yield html.paragraph(
        "The sentence names the load characteristic, the modulus of (64), but no displacement. The same ratio of other "
        "quantities, for the reference and for roots clamped along the bore’s tangent:"
    )
    counts = tuple(curve.count for curve in evidence.flat.curves)
    yield html.table(tables.meanings(evidence.meanings, evidence.tangent_meanings, counts))


def grids(evidence: Evidence) -> Iterator[str]:
    """The paper's grids."""
    yield html.section("grids", SECTIONS["grids"])
    yield html.paragraph(
        "The paper counts nodes along a petal and along the axis, and marches an explicit scheme, whose step is bound "
        "by the grid. Here every grid has its answer from nothing; 8 petals, e = 200 µm. An axial number of nodes is "
        "odd here, so that one lies in the plane of symmetry."
    )
    yield html.table(tables.grids(evidence.grids))


def silences() -> Iterator[str]:
    """What was assumed."""
    yield html.section("silent", SECTIONS["silent"])
    rows = tuple((silence.what, silence.paper, silence.assumed) for silence in SILENT)
    yield html.table(Table(("", "the paper", "assumed here"), rows))
    yield html.paragraph("Where this computation departs from the printed equations:")
    yield html.bullets(DEPARTURES)


def data(files: tuple[str, ...]) -> Iterator[str]:
    """Links to what lies beside the page."""
    yield html.section("data", SECTIONS["data"])
    links = "".join(f'<li><a href="{escape(name)}">{escape(name)}</a></li>' for name in files)
    yield f"<ul>{links}</ul>"
    yield html.paragraph(
        "NetCDF files hold every field of every point with its case: `petalfoil show FILE`, or xarray. CSV files and "
        "report.json are in SI units; the study’s in those of its headings."
    )
