"""The same question on finer and finer grids: how far is a result from its grid-converged value?

Grids are nested: cells double along the pitch and, in a 3-D model, along the axis too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.records import failed_record
from petalfoil.analysis.richardson import richardson
from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import ConvergenceError
from petalfoil.results.estimate import Estimate
from petalfoil.results.places import MIN_FILM_PLACE, PEAK_PRESSURE_PLACE, films_at_peak
from petalfoil.results.record import Record
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE

Array = NDArray[np.float64]

Point = Callable[[Case, Progress | None], Record]
"""Solves a case on its grid."""

RATIO = 2.0
"""Cells of a grid over those of the next coarser one [1]."""

MOST_LEVELS = 10
"""Grids of a study: the finest then has 512 times the cells of the coarsest along a pitch."""

LEAST_CELLS = {ModelKind.TWO_D: 32, ModelKind.THREE_D: 24}
"""Cells per pitch below which the default adds finer grids instead of coarser ones: at 16 the film of the paper's
packs comes down to the floor where it should not, and such a grid only widens the bars."""

LEAST_AXIAL = 4
"""Coarsest division of the length: its pressure is zero at both ends, and one value is no profile."""


LEAST_ELEMENTS, MOST_ELEMENTS = 12, 96
"""Elements of a petal per pitch that a case may have."""


POSITION = ("eccentricity_x", "eccentricity_y")

BALANCED = {
    **dict.fromkeys(("bearing_force", "force_x", "force_y"), "load_x"),
    **dict.fromkeys(("moment_x", "moment_y"), "load_moment_x"),
}
"""Forces and moments that a balance is given, by the result that tells it."""

FILM_RESULTS = ("min_film_thickness", "knudsen_number")
"""Results that are constants of the case where contact holds the film."""

ANGLES = {name for name, variable in SCALARS.items() if variable.units == "rad"}


def grid_records(
    cases: Sequence[Case],
    point: Point,
    progress: Progress | None = None,
    finished: Sequence[Record] = (),
    known: Record | None = None,
) -> Iterator[Record]:
    """Yield the record of each case after the `finished` ones, from `point` or `known`.

    A grid without a solution is recorded as such.
    """
    done = [0.0, *parts(cases)]
    for number, case in enumerate(cases[len(finished) :], len(finished)):
        if known is not None and known.case_toml == case.to_toml():
            yield _labelled(known, case)
        else:
            part = _part(progress, done[number], done[number + 1], grid_text(case))
            yield _record(case, point, part)


def parts(cases: Sequence[Case]) -> list[float]:
    """Part of the whole cost that is spent after each grid."""
    spent = np.cumsum([float(unknowns(case)) for case in cases])
    return [float(part) for part in spent / spent[-1]]


def grids(case: Case, levels: int = 3, coarsest: int | None = None) -> list[Case]:
    """The case on nested grids, coarsest first.

    Parameters
    ----------
    case : Case
        The bearing.
    levels : int
        Number of grids.
    coarsest : int, optional
        Cells per pitch of the coarsest grid. By default the case's own grid is the finest, as long as coarser ones can
        be nested in it.
    """
    cells, axial = (case.cells_per_pitch, case.axial_cells) if coarsest is None else _shared(case, coarsest)
    if coarsest is None:
        for _ in range(levels - 1):
            if not _can_be_halved(case, cells, axial):
                break
            cells, axial = cells // 2, axial // 2
    return [on_grid(case, cells * 2**level, axial * 2**level) for level in range(levels)]


def grid_of(case: Case) -> tuple[int, int]:
    """Cells per pitch, and over the length (0 in a 2-D model)."""
    return case.cells_per_pitch, case.axial_cells if case.model.kind is ModelKind.THREE_D else 0


def grid_text(case: Case) -> str:
    """The grid of a case in words."""
    cells, axial = grid_of(case)
    return f"grid {cells} x {axial}" if axial else f"grid {cells}"


def unknowns(case: Case) -> int:
    """What the cost of a grid grows with."""
    cells, axial = grid_of(case)
    return cells * max(axial, 1)


def table(records: Sequence[Record]) -> list[Estimate]:
    """What the grids tell about every result that all solutions have.

    The last three grids in unbroken order count; of fewer than three, no order can be observed.

    Raises
    ------
    ConvergenceError
        Fewer than two grids have an answer.
    """
    answered = [record.converged for record in records]
    if sum(answered) < 2:
        states = ", ".join(f"{r.scalars['cells_per_pitch']}: {r.scalars['status']}" for r in records)
        advice = "choose other grids with --coarsest, or see why a single one does not converge with `solve`"
        raise ConvergenceError(f"a grid study needs answers on two grids at least ({states})", advice=advice)
    first, good = records[answered.index(True)], [record for record in records if record.converged]
    in_contact = any(float(record.scalars.get("contact_fraction", 0.0)) > 0.0 for record in good)
    results = [name for name in SCALARS if _is_result(name, first) and not (in_contact and name in MIN_FILM_PLACE)]
    names = [name for name in results if all(_known(name, record) for record in good) and not _is_held(name, good)]
    scale = resolution(first)
    estimates = [_estimate(name, records, scale.get(SCALARS[name].units, 0.0)) for name in names]
    peak = next((estimate.error for estimate in estimates if estimate.name == "peak_pressure"), 0.0)
    several = any(films_at_peak(record, peak) > 1 for record in good)
    return [estimate for estimate in estimates if not (several and estimate.name == PEAK_PRESSURE_PLACE)]


def error_bars(own: Record, point: Point, progress: Progress | None = None) -> dict[str, float]:
    """Error bars of the results of `point`, from its own grid and two more that are nested with it.

    Raises
    ------
    ConvergenceError
        Neither of the other grids has a solution.
    """
    case = Case.from_toml(own.case_toml)
    case = on_grid(case, *grid_of(case))
    own = replace(own, case_toml=case.to_toml())
    estimates = table(list(grid_records(grids(case), point, progress, known=own)))
    return {estimate.name: _bar(estimate, float(own.scalars[estimate.name])) for estimate in estimates}


def array_error_bars(own: Array, on_grids: Sequence[Array | None], *, alike: bool = True) -> Array:
    """Error bars of the entries of an array on one of the grids, coarsest first; None where a grid has no answer.

    An entry that fewer than two grids have has none: nan. Contacts are described `alike` on all grids, or not.
    """
    missing = np.full_like(own, np.nan)
    values = np.stack([missing if array is None else array for array in on_grids])
    bars = np.empty_like(own)
    for entry in np.ndindex(own.shape):
        here = values[(slice(None), *entry)]
        if np.count_nonzero(np.isfinite(here)) < 2:
            bars[entry] = np.nan
            continue
        counted = _unbroken(here)
        bars[entry] = abs(own[entry] - counted[-1]) + richardson([float(v) for v in counted], RATIO, alike=alike).error
    return bars


def of_one_size(bars: Array) -> Array:
    """Error bars of matrices over directions, (..., n, n): none below the root mean square of its matrix.

    Entries mix where axes are turned, so that none is better known than its matrix: its differences were small by
    accident. Alone, 96 % of the bars of stiffness and 93 % of those of damping on 64 cells of 44 random bearings hold
    against 512 cells; with this 99 % of both do.
    """
    of_matrix: Array = np.sqrt(np.mean(bars**2, axis=(-2, -1), keepdims=True))
    return np.fmax(bars, of_matrix)


def contacts_alike(records: Sequence[Record | None]) -> bool:
    """Whether contacts are described alike (points, asperities or nodes) on all grids that have an answer."""
    answered = [record for record in records if record is not None and record.converged]
    return len({record.scalars.get("contact_model") for record in answered}) <= 1


def resolution(record: Record) -> dict[str, float]:
    """Differences that residuals of `RESIDUAL_TOLERANCE` over ambient pressure can make, by unit."""
    pressure, radius, length = (float(record.scalars[k]) for k in ("ambient_pressure", "journal_radius", "length"))
    force = RESIDUAL_TOLERANCE * pressure * 2.0 * radius * length
    return {"N": force, "N m": force * radius}


# ---------------------------------------------------------------------------------------------- grids


def _shared(case: Case, coarsest: int) -> tuple[int, int]:
    """Cells of the coarsest grid; those along the axis in the proportion of the case."""
    axial = 2 * round(case.axial_cells * coarsest / case.cells_per_pitch / 2)
    return coarsest, max(axial, LEAST_AXIAL)


def _can_be_halved(case: Case, cells: int, axial: int) -> bool:
    if cells % 2 or cells // 2 < LEAST_CELLS[case.model.kind]:
        return False
    step = 4 if case.symmetric else 2  # half the length takes half the cells
    return case.model.kind is ModelKind.TWO_D or (axial % step == 0 and axial // 2 >= LEAST_AXIAL)


def on_grid(case: Case, cells: int, axial: int) -> Case:
    """The case on `cells` per pitch, and `axial` over the length of a 3-D model.

    Elements of petals, of fourth order, grow as the root of the cells: their error falls as that of the film.
    """
    changes: dict[str, object] = {"model.cells_per_pitch": cells}
    if case.model.kind is ModelKind.THREE_D:
        changes["model.axial_cells"] = axial
    elements = round(case.model.petal_cells * math.sqrt(cells / case.cells_per_pitch))
    if case.has_contact_points and elements != case.model.petal_cells:
        changes["model.petal_cells"] = min(max(elements, LEAST_ELEMENTS), MOST_ELEMENTS)
    return case.replace(**changes)


# ---------------------------------------------------------------------------------------------- records


def _record(case: Case, point: Point, progress: Progress) -> Record:
    try:
        record = point(case, progress)
    except ConvergenceError as failure:
        with running() as run:
            run.history.extend(failure.history)
            record = failed_record("solve", case, failure)
    return _labelled(record, case)


def _labelled(record: Record, case: Case) -> Record:
    cells, axial = grid_of(case)
    grid = {"cells_per_pitch": cells} | ({"axial_cells": axial} if axial else {})
    return replace(record, scalars={**record.scalars, **grid})


def _part(progress: Progress | None, start: float, end: float, text: str) -> Progress:
    """Progress of one grid as a part of the whole."""

    def tell(share: float, phase: str) -> None:
        if progress is not None:
            progress(start + share * (end - start), f"{text}, {phase}")

    return tell


# ---------------------------------------------------------------------------------------------- results


def _is_result(name: str, record: Record) -> bool:
    """Whether a number answers the question; under a load the position of the journal does, and no force or moment.

    Under the largest load both do, but for what limits it. Of two unequal bearings each carries a part of the load that
    is an answer.
    """
    if record.scalars.get("limited_by") in (FILM_RESULTS if name in FILM_RESULTS else (name,)):
        return False
    if name in POSITION:
        return not {"load_x", "load_capacity"}.isdisjoint(record.scalars)
    if name in BALANCED and BALANCED[name] in record.scalars and "other_force_x" not in record.scalars:
        return False
    return SCALARS[name].role is Role.ANSWER and SCALARS[name].kind is DataType.FLOAT


def _is_held(name: str, records: Sequence[Record]) -> bool:
    """Whether a result of the film is a constant of the case: on every grid contact holds it."""
    scalars = [record.scalars for record in records]
    held = all(one.get("min_film_thickness") == one.get("contact_film_thickness") for one in scalars)
    return name in FILM_RESULTS and held and len({one.get(name) for one in scalars}) == 1


def _known(name: str, record: Record) -> bool:
    return math.isfinite(float(record.scalars.get(name, math.nan)))


def _estimate(name: str, records: Sequence[Record], scale: float) -> Estimate:
    values = np.array([float(r.scalars[name]) if r.converged else math.nan for r in records])
    counted = _unbroken(values)
    if name in ANGLES:
        counted = np.unwrap(counted)
    found = richardson([float(value) for value in counted], RATIO, scale, alike=contacts_alike(records))
    return Estimate(
        name=name,
        values=tuple(float(value) for value in values),
        limit=_in_one_turn(found.limit, values) if name in ANGLES else found.limit,
        order=found.order,
        error=min(found.error, math.pi) if name in ANGLES else found.error,
        trusted=found.trusted,
    )


def _in_one_turn(angle: float, values: Array) -> float:
    """An angle in the turn that the values are given in: from 0, or about 0 where one is negative."""
    turn = 2.0 * math.pi
    return math.remainder(angle, turn) if np.nanmin(values) < 0.0 else angle % turn


def _bar(estimate: Estimate, value: float) -> float:
    """Error bar of the value on any grid of the study: its distance from the finest one's, and that one's bar."""
    finest = next(v for v in reversed(estimate.values) if not math.isnan(v))
    if estimate.name in ANGLES:
        return min(abs(math.remainder(value - finest, 2.0 * math.pi)) + estimate.error, math.pi)
    return abs(value - finest) + estimate.error


def _unbroken(values: Array) -> Array:
    """The values that one ratio connects: up to the finest, without a gap; the last two where that leaves one."""
    known = np.flatnonzero(np.isfinite(values))
    last = int(known[-1])
    gaps = np.flatnonzero(~np.isfinite(values[:last]))
    start = int(gaps[-1]) + 1 if len(gaps) else 0
    return values[start : last + 1] if last > start else values[known[-2:]]
