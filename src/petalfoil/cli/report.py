"""``petalfoil report``: what a design review asks about a bearing, on one page."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from petalfoil.analysis.progress_bar import bar
from petalfoil.cli.failures import NOT_CONVERGED, handled
from petalfoil.cli.reproduce import Folder, check_folder
from petalfoil.cli.streams import emit, say

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case to report on, a TOML file.")]
LoadText = Annotated[
    str | None,
    typer.Option(
        "--load", metavar="LOAD", help="Load on the rotor instead of the case's; a single value acts along -y."
    ),
]
MassText = Annotated[
    str | None,
    typer.Option(
        "--mass",
        metavar="QUANTITY",
        help="Mass of the rotor; by default rotor.mass of the case, else load over gravity.",
    ),
]
Bars = Annotated[bool, typer.Option("--error/--no-error", help="Error bars, from the case's grid and two more.")]
Pdf = Annotated[bool, typer.Option("--pdf", help="Print the page to report.pdf too, by a browser or WeasyPrint.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object in SI units.")]


def report(  # noqa: PLR0913 - the options of the command
    case: CaseFile,
    out: Folder = Path("report"),
    load: LoadText = None,
    mass: MassText = None,
    error: Bars = True,
    pdf: Pdf = False,
    as_json: Json = False,
) -> None:
    """Write a report for a design review: one page, and its data.

    Drawing, operating points, lift-off, stiffness and damping, stability,
    error bars, warnings, assumptions, and what computes it again. A part
    that has no result says why; exit code 3 if one did not converge.

    Example: petalfoil report case.toml --load "20 N" --out report --pdf
    """
    with handled(as_json):
        check_folder(out)

        from petalfoil.case import Case
        from petalfoil.cli.commands import note_bare_number
        from petalfoil.report import case_report

        request = case_report.request_of(Case.load(case), load=load, mass=mass, error=error, names=("--load", "--mass"))
        for option, text, unit in (("--load", load, "N"), ("--mass", mass, "kg")):
            note_bare_number(option, text, unit)
        with bar("report") as progress:
            parts, page = case_report.report(request, out, print_it=pdf, progress=progress)
        found = {"page": str(page), **case_report.summary(parts)}
        emit(json.dumps(found, allow_nan=False) + "\n" if as_json else f"report: {page}\n")
        for part in parts:
            if part.refusal is not None:
                say(f"{part.title}: {part.refusal}")
        if any(part.is_failed for part in parts):
            raise typer.Exit(NOT_CONVERGED)
