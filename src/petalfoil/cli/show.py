"""``petalfoil show``: a result file once more, without running anything."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from petalfoil.cli.failures import handled
from petalfoil.cli.outputs import Outputs


def show(
    result: Annotated[Path, typer.Argument(metavar="RESULT", help="Result to show, written by --out.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object in SI units.")] = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE.png", help="Draw a figure: .png, .svg or .pdf.")] = None,
) -> None:
    """Show a result file once more: table and figure, without running anything.

    Example: petalfoil show curve.nc --plot curve.pdf
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, plot=plot)

        from petalfoil.analysis.registry import find
        from petalfoil.results.layout import Answer, Point, Series
        from petalfoil.results.store import load

        ds = load(result)
        analysis = find(str(ds.attrs["analysis"]))
        unknown = Series() if "point" in ds.dims else Point()  # of an analysis that is not declared here
        outputs.deliver(Answer.stored(ds, analysis.layout_of(ds) if analysis else unknown), ds)
