"""What a worker does for a task: it runs an analysis, or makes a file of the records of one."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from petalfoil.analysis import known_verbs
from petalfoil.analysis.arguments import StoredResult
from petalfoil.analysis.declaration import Analysis
from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.run_context import Progress
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.memory import grid_of
from petalfoil.results.answer import Answer
from petalfoil.results.layout import Layout
from petalfoil.results.record import Record, warnings_of_all
from petalfoil.results.rounding import without_rounding
from petalfoil.results.tables import shown_bars, tables_of
from petalfoil.studio.arrays import arrays_of
from petalfoil.studio.design import Design, without_files
from petalfoil.studio.protocol import FoundAnswer, Mapped, Searched, Work, WorkerTask
from petalfoil.walls import Capability, wall_kind

if TYPE_CHECKING:
    import xarray as xr

COARSE_CELLS = 32
"""Cells per pitch of the coarse answer: half of the time of the default grid's, forces within some per cent."""
COARSE_PLAIN_CELLS = 96
"""The same round the circle of a plain bearing."""
MOST_UNKNOWNS = 150_000
"""Largest grid that the page runs: a minute or two on one core, and some 2 GB."""


def perform(task: WorkerTask, progress: Progress) -> FoundAnswer | Mapped | Searched | bytes:
    """Do what a task asks for.

    Raises
    ------
    PetalfoilError
        The case or the arguments are refused, or no answer was found.
    """
    analysis = found_analysis(task.verb)
    if task.work is Work.ANSWER:
        return answered(task, analysis, progress)
    if task.work in (Work.STUDY, Work.OPTIMUM):
        from petalfoil.studio import study_tasks

        case = Case(**without_files(task.case_toml))
        refuse_huge(case)
        return (study_tasks.mapped if task.work is Work.STUDY else study_tasks.searched)(task, case, progress)
    return file_of(task, analysis)


def warm_up() -> None:
    """Load what an answer needs, so that the first one is as quick as the others."""
    for verb in ("balance", "solve"):
        found_analysis(verb)
    Design.starting().case()


def found_analysis(verb: str) -> Analysis:
    """The analysis of a name."""
    analysis = known_verbs.find(verb)
    if analysis is None:
        raise UsageError(f"no analysis is called {verb!r}; known: {', '.join(known_verbs.summaries())}")
    return analysis


def answered(task: WorkerTask, analysis: Analysis, progress: Progress) -> FoundAnswer:
    """Run an analysis and lay out its answer for the page."""
    start = time.perf_counter()
    case = Case(**without_files(task.case_toml))
    case = coarse(case) if task.coarse else case
    refuse_huge(case)
    run = analysis.start(case, analysis.read(without_stored(analysis, task.arguments)), progress)
    for _ in analysis.advance(run, progress):
        pass
    answer = analysis.answer(run)
    last = answer.records[-1]
    scalars = without_rounding(last)
    return FoundAnswer(
        verb=task.verb,
        tables=tuple(tables_of(answer)),
        warnings=answer.warnings,
        failures=tuple(answer.failures()),
        scalars=scalars,
        bars=shown_bars(last, scalars),
        arrays=arrays_of(answer),
        records=() if task.coarse else answer.records,
        grid=grid_of(case).words,
        seconds=time.perf_counter() - start,
        is_series=run.is_series,
    )


def coarse(case: Case) -> Case:
    """The case in 2-D on a coarse grid, without the settings of an axial grid; a coarser grid of its own is kept."""
    cells = COARSE_CELLS if wall_kind(case).can(Capability.PACK) else COARSE_PLAIN_CELLS
    changes = {"model.kind": ModelKind.TWO_D, "model.cells_per_pitch": min(cells, case.cells_per_pitch)}
    return case.replace(**changes)


def refuse_huge(case: Case) -> None:
    """Refuse a grid that would hold up everybody.

    Raises
    ------
    DefinitionError
        It has more than `MOST_UNKNOWNS` unknowns.
    """
    unknowns = case.bearings * grid_of(case).unknowns
    if unknowns > MOST_UNKNOWNS:
        raise DefinitionError(
            f"model.cells_per_pitch: the grid has {unknowns:.3g} unknowns; the page runs up to {MOST_UNKNOWNS:,}. "
            "Choose fewer cells, or save the case and run it from the command line",
            key="model.cells_per_pitch",
            given=case.cells_per_pitch,
            allowed=f"up to {MOST_UNKNOWNS:,} unknowns",
        )


def without_stored(analysis: Analysis, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments, none of which names a file.

    Raises
    ------
    UsageError
        An argument would be read from a file.
    """
    for name in arguments:
        if isinstance(analysis.arguments.get(name), StoredResult):
            raise UsageError(f"{name}: the page reads no files of the server")
    return dict(arguments)


# ---------------------------------------------------------------------------------------------- files


def file_of(task: WorkerTask, analysis: Analysis) -> bytes:
    """The bytes of a file of an answer."""
    answer = stored_answer(task.records, analysis)
    if task.work is Work.REPORT:
        from petalfoil.studio.one_page import one_page

        return one_page(answer, task.case_toml).encode()
    ds = answer.to_dataset()
    return netcdf(ds) if task.work is Work.NETCDF else picture(ds, task.work.value)


def stored_answer(records: tuple[Record, ...], analysis: Analysis) -> Answer:
    """The answer that consists of records."""
    layout = layout_of(records, analysis)
    return Answer(
        verb=analysis.verb,
        layout=layout,
        records=records,
        estimates=layout.estimates(records),
        warnings=warnings_of_all(records),
    )


def layout_of(records: tuple[Record, ...], analysis: Analysis) -> Layout:
    """The layout of an analysis that holds as many records."""
    if len(analysis.layouts) == 1:
        return analysis.layouts[0]
    return next(layout for layout in analysis.layouts if bool(layout.dimension) is (len(records) > 1))


def netcdf(ds: xr.Dataset) -> bytes:
    """A NetCDF file."""
    from petalfoil.results.store import save

    with tempfile.TemporaryDirectory(prefix="petalfoil-") as folder:
        path = Path(folder) / "result.nc"
        save(ds, path)
        return path.read_bytes()


def picture(ds: xr.Dataset, suffix: str) -> bytes:
    """The figure of an answer as PNG or SVG."""
    import io

    from petalfoil.plot import summary

    buffer = io.BytesIO()
    summary(ds).savefig(buffer, format=suffix)
    return buffer.getvalue()
