"""``petalfoil study``: the study in a folder shown, gone on with, exported."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from petalfoil.cli.commands import HELP, JSON, PLOT
from petalfoil.cli.failures import handled
from petalfoil.cli.outputs import DATA_SUFFIXES, FIGURE_SUFFIXES, check_file
from petalfoil.cli.study_commands import MemoryLimit, Scheduler, Workers, run_and_tell
from petalfoil.cli.study_outputs import deliver
from petalfoil.errors import UsageError
from petalfoil.studies.study_definition import Study

Folder = Annotated[Path, typer.Argument(metavar="FOLDER", help="Folder of the study.")]
Result = Annotated[list[str] | None, typer.Option("--of", metavar="RESULT", help="Result to draw, as often as needed.")]
Target = Annotated[Path, typer.Option("--to", metavar="FILE", help="File to write: .nc, .csv, or .toml with --case.")]
Number = Annotated[
    int | None, typer.Option("--case", metavar="N", help="Write this case of the study as a case file.", min=0)
]
AlsoFields = Annotated[bool, typer.Option("--fields", help="Write film and petals of the cases that are left too.")]


def study_commands() -> Any:
    """The commands ``show``, ``resume`` and ``export``."""
    group = typer.Typer(
        add_completion=False,
        help="Show, resume or export the study in a folder.",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode="rich",
        context_settings={"help_option_names": HELP},
    )
    group.command("show")(show)
    group.command("resume")(resume)
    group.command("export")(export)
    return typer.main.get_command(group)


def show(folder: Folder, plot: PLOT = None, of: Result = None, as_json: JSON = False) -> None:
    """Show a study, finished or not: counts, ranges, figure.

    Example: petalfoil study show study/ --of liftoff_speed --plot liftoff.png
    """
    from petalfoil.studies.run import stored

    with handled(as_json):
        if plot is not None:
            check_file(plot, "--plot", FIGURE_SUFFIXES)
        ds = stored(folder)
        if plot is not None:
            from petalfoil import plot as figures

            figures.save(figures.study(ds, tuple(of or ())), plot)
        deliver(ds, folder, as_json=as_json)


def resume(
    folder: Folder,
    workers: Workers = None,
    scheduler: Scheduler = "",
    memory: MemoryLimit = None,
    fields: AlsoFields = False,
    as_json: JSON = False,
) -> None:
    """Go on with a study that was stopped; finished cases are kept.

    Example: petalfoil study resume study/ --workers 2
    """
    from petalfoil.studies.run import refuse_other_version

    with handled(as_json):
        study = Study.load(folder)
        refuse_other_version(study)
        given = {"workers": workers, "scheduler": scheduler, "memory": memory, "fields": fields}
        run_and_tell(study, folder, {**given, "anew": False, "neighbours": False, "as_json": as_json})


def export(folder: Folder, to: Target, case: Number = None) -> None:
    """Write a study, finished or not, as NetCDF or CSV; or one of its cases as a case file.

    Example: petalfoil study export study/ --case 17 --to best.toml
    """
    from petalfoil.results.store import save
    from petalfoil.studies.case_files import write_case
    from petalfoil.studies.run import stored
    from petalfoil.studies.study_dataset import write_table

    with handled():
        check_file(to, "--to", (".toml",) if case is not None else (*DATA_SUFFIXES, ".csv"))
        if to.exists() and case is not None:
            raise UsageError(f"--to: {to} is there already: give another name")
        ds = stored(folder)
        if case is not None:
            write_case(Study.load(folder), ds, case, to)
        elif to.suffix == ".csv":
            write_table(to, ds)
        else:
            save(ds, to)
