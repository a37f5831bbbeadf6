"""Options of files for other programs, as the analyses declare them: of a run, and of a stored result."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from petalfoil.cli.outputs import ExportFile
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    import xarray as xr

    from petalfoil.analysis.file_exports import Export


def export_options(exports: Iterable[Export]) -> list[inspect.Parameter]:
    """Options for the files of exports, and for their settings; absent where nothing is given."""
    options: dict[str, inspect.Parameter] = {}
    for export in exports:
        wanted = typer.Option(f"--{export.option}", metavar=export.metavar, help=export.help)
        options[export.option] = _option(export.option, Annotated[Path | None, wanted])
        for name, argument in export.settings.items():
            given = typer.Option(f"--{name}", metavar=argument.metavar, help=argument.help)
            options.setdefault(name, _option(name, Annotated[str | None, given]))
    return list(options.values())


def chosen(exports: Iterable[Export], given: Mapping[str, Any]) -> tuple[ExportFile, ...]:
    """The exports that the options ask for, with their settings.

    Raises
    ------
    UsageError
        A setting has another form, or no file is asked for that would have it.
    """
    exports = tuple(exports)
    wanted = [export for export in exports if given[export.option] is not None]
    used = {name for export in wanted for name in export.settings}
    for export in exports:
        for name in export.settings:
            if given[name] is not None and name not in used:
                raise UsageError(f"--{name} says nothing without --{export.option}")
    return tuple(
        ExportFile(
            option=f"--{export.option}",
            path=given[export.option],
            suffixes=export.suffixes,
            write=_writer(export, given),
        )
        for export in wanted
    )


def _option(name: str, annotation: Any) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=annotation, default=None)


def _writer(export: Export, given: Mapping[str, Any]) -> Any:
    """The function that writes an export with its settings, loaded when it is called."""
    settings = {
        name: argument.named(f"--{name}", given[name])
        for name, argument in export.settings.items()
        if given[name] is not None
    }
    module, _, function = export.writer.partition(":")

    def write(ds: xr.Dataset, path: Path) -> None:
        getattr(import_module(module), function)(ds, path, **settings)

    return write
