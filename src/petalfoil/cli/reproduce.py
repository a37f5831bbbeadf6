"""``petalfoil reproduce``: the paper's figures and claims, computed anew."""

from __future__ import annotations

import json
import tempfile
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from petalfoil.analysis.progress_bar import bar
from petalfoil.cli.failures import NOT_CONVERGED, handled
from petalfoil.cli.streams import emit, say
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    from petalfoil.report.claims import Evidence

Folder = Annotated[
    Path,
    typer.Option(metavar="FOLDER", help="Where page and data go: a new or an empty folder, or that of an earlier run."),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object in SI units.")]


def reproduce(out: Folder = Path("paper"), as_json: Json = False) -> None:
    """Compute the paper's Figures 6, 7 and 8 and its claims: a page and data.

    Three bearings with 6, 8 and 10 petals, 2-D and 3-D; a study of what
    the paper does not state. A few minutes on one core.

    Example: petalfoil reproduce --out paper
    """
    with handled(as_json):
        check_folder(out)

        from petalfoil.report.reproduce import report

        with bar("reproduce") as progress:
            evidence, page = report(out, progress=progress)
        emit(_json(evidence, page) if as_json else _text(evidence, page))
        failed = [record for family in evidence.families for record in family.points if not record.converged]
        if failed:
            say(f"{len(failed)} points did not converge and are left blank")
            raise typer.Exit(NOT_CONVERGED)


def check_folder(folder: Path) -> None:
    """Make sure before any work that the folder can be written to."""
    try:
        folder.mkdir(exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UsageError(f"--out: {folder} cannot be written as a folder: {error.strerror}") from error


def _json(evidence: Evidence, page: Path) -> str:
    from petalfoil.report.report_files import summary

    return json.dumps({"page": str(page), **summary(evidence)}, allow_nan=False) + "\n"


def _text(evidence: Evidence, page: Path) -> str:
    """Claims and where they stand."""
    from petalfoil.report.claims import claims

    lines = []
    for claim in claims(evidence):
        lines += [f"{claim.verdict.upper()}: {claim.quote} ({claim.where})"]
        lines += [textwrap.fill(claim.computed, 110, initial_indent="    ", subsequent_indent="    "), ""]
    return "\n".join([*lines, f"Figures, the study of assumptions and data: {page}\n"])
