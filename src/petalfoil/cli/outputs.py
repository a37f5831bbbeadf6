"""Where an answer goes: places checked before the run, written after it."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Self, TypeAlias

import typer

from petalfoil.cli.failures import NOT_CONVERGED
from petalfoil.cli.streams import emit, say
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    import xarray as xr

    from petalfoil.results.answer import Answer

Writer: TypeAlias = "Callable[[xr.Dataset, Path], None]"

DATA_SUFFIXES = (".nc", ".nc4")
FIGURE_SUFFIXES = (".png", ".svg", ".pdf")


@dataclass(frozen=True, kw_only=True)
class ExportFile:
    """A file for another program.

    Parameters
    ----------
    option : str
        Option that asks for it.
    path : Path
        The file.
    suffixes : tuple of str
        Suffixes that are known.
    write : callable
        Writes it from labelled data.
    """

    option: str
    path: Path
    suffixes: tuple[str, ...]
    write: Writer


@dataclass(frozen=True, kw_only=True)
class Outputs:
    """What the user asked to be given.

    Parameters
    ----------
    as_json : bool
        One JSON object on standard output instead of the table.
    out : Path or None
        NetCDF file.
    plot : Path or None
        Figure.
    exports : tuple of ExportFile
        Files for other programs.
    """

    as_json: bool
    out: Path | None
    plot: Path | None
    exports: tuple[ExportFile, ...] = ()

    @classmethod
    def checked(
        cls,
        *,
        as_json: bool,
        out: Path | None = None,
        plot: Path | None = None,
        exports: tuple[ExportFile, ...] = (),
    ) -> Self:
        """Make sure, before any work is done, that it can be given out afterwards.

        Raises
        ------
        UsageError
            A file has a suffix that is not known, or cannot be written.
        """
        if out is not None:
            check_file(out, "--out", DATA_SUFFIXES)
        if plot is not None:
            check_file(plot, "--plot", FIGURE_SUFFIXES)
        for export in exports:
            check_file(export.path, export.option, export.suffixes)
            if export.path.suffix.lower() == ".xlsx":
                from petalfoil.results.spreadsheet import need_excel

                need_excel(export.path)
        return cls(as_json=as_json, out=out, plot=plot, exports=exports)

    def deliver(self, answer: Answer, dataset: xr.Dataset | None = None, *, stopped: int = 0) -> None:
        """Write the files, print the answer, and say what did not converge.

        Parameters
        ----------
        answer : Answer
            What was computed.
        dataset : xarray.Dataset, optional
            The same as labelled data, where it is at hand.
        stopped : int
            Exit code of a run that was interrupted, else 0.

        Raises
        ------
        typer.Exit
            When the run was interrupted or something did not converge.
        """
        try:
            self._write_files(answer, dataset)
        finally:  # an answer that took minutes is shown also when its file cannot be written
            self._print(answer)
        failures = answer.failures()
        for line in (*failures, *(remark for record in answer.records for remark in record.remarks)):
            say(line)
        if stopped:
            raise typer.Exit(stopped)
        if failures or any(record.errors == {} for record in answer.records):
            raise typer.Exit(NOT_CONVERGED)

    def _write_files(self, answer: Answer, dataset: xr.Dataset | None) -> None:
        if self.out is None and self.plot is None and not self.exports:
            return
        ds = answer.to_dataset() if dataset is None else dataset
        if self.out is not None:
            from petalfoil.results.store import save

            save(ds, self.out)
        if self.plot is not None:
            self._draw(answer, ds, self.plot)
        for export in self.exports:
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always", UserWarning)
                export.write(ds, export.path)
            for warning in told:
                say(f"Warning: {export.option}: {warning.message}")

    @staticmethod
    def _draw(answer: Answer, ds: xr.Dataset, path: Path) -> None:
        if not any(record.converged for record in answer.records):
            say(f"nothing converged, so {path} is not drawn")
            return
        from petalfoil import plot

        plot.save(plot.summary(ds), path)

    def _print(self, answer: Answer) -> None:
        if self.as_json:
            emit(answer.to_json() + "\n")
        else:
            from petalfoil.cli.printed_tables import render

            emit(render(answer))


def check_file(path: Path, option: str, suffixes: tuple[str, ...]) -> None:
    """Make sure that a file of one of these suffixes can be written."""
    if path.is_dir():
        raise UsageError(f"{option}: {path} is a folder; name a file in it, such as {path / f'result{suffixes[0]}'}")
    if path.suffix.lower() not in suffixes:
        raise UsageError(f"{option}: {path} has the suffix '{path.suffix}'; known: {', '.join(suffixes)}")
    if not path.parent.is_dir():
        raise UsageError(f"{option}: {path} cannot be written, there is no folder {path.parent}")
    try:
        # Files are written under a temporary name beside their place, and only trying tells whether that is allowed.
        with tempfile.TemporaryFile(dir=path.parent):
            pass
        if path.exists():
            with path.open("ab"):
                pass
    except OSError as error:
        raise UsageError(f"{option}: {path} cannot be written: {error.strerror}") from error
