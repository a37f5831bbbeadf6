"""``petalfoil show``: a result file once more, without running anything."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from petalfoil.analysis.file_exports import Export
from petalfoil.analysis.known_verbs import find, summaries
from petalfoil.cli.commands import JSON, KEYWORD, PLOT, command
from petalfoil.cli.exports import chosen, export_options
from petalfoil.cli.failures import handled
from petalfoil.cli.outputs import Outputs
from petalfoil.errors import UsageError
from petalfoil.results.answer import Answer
from petalfoil.results.layout import Series, SinglePoint
from petalfoil.results.store import load

if TYPE_CHECKING:
    import xarray as xr

HELP = """Show a stored result without computing it again: table, figure, files for other programs.

Example: petalfoil show curve.nc --plot curve.pdf
"""
RESULT = Annotated[Path, typer.Argument(metavar="RESULT", help="Result to show, written by --out.")]


def show_command() -> Any:
    """The command, with an option for every file that an analysis can be exported to."""
    options = [
        inspect.Parameter("result", KEYWORD, annotation=RESULT),
        inspect.Parameter("as_json", KEYWORD, annotation=JSON, default=False),
        inspect.Parameter("plot", KEYWORD, annotation=PLOT, default=None),
        *export_options(declared_exports().values()),
    ]

    def ask(**given: Any) -> None:
        show(**given)

    return command("show", ask, options, HELP)


def show(result: Path, *, as_json: bool, plot: Path | None, **files: Any) -> None:
    """Give a stored result out."""
    with handled(as_json):
        exports = declared_exports()
        outputs = Outputs.checked(as_json=as_json, plot=plot, exports=chosen(exports.values(), files))
        ds = load(result)
        if is_study(ds):
            show_study(ds, result, as_json=as_json, plot=plot)
            return
        analysis = find(str(ds.attrs["analysis"]))
        own = {export.option for export in analysis.exports} if analysis else set()
        for option in exports:
            if files[option] is not None and option not in own:
                raise UsageError(f"--{option}: a result of {ds.attrs['analysis']} has nothing for such a file")
        unknown = Series() if "point" in ds.dims else SinglePoint()  # of an analysis that is not declared here
        outputs.deliver(Answer.stored(ds, analysis.layout_of(ds) if analysis else unknown), ds)


def is_study(ds: xr.Dataset) -> bool:
    """Whether a result is that of many cases."""
    return {"vary", "settings"} <= ds.attrs.keys()


def show_study(ds: xr.Dataset, result: Path, *, as_json: bool, plot: Path | None) -> None:
    """Give a stored study out."""
    from petalfoil.cli.study_outputs import deliver

    if plot is not None:
        from petalfoil import plot as figures

        figures.save(figures.study(ds), plot)
    deliver(ds, result, as_json=as_json)


def declared_exports() -> dict[str, Export]:
    """The exports of all analyses by their option."""
    analyses = [analysis for verb in summaries() if (analysis := find(verb)) is not None]
    return {export.option: export for analysis in analyses for export in analysis.exports}
