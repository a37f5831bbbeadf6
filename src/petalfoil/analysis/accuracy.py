"""Whether error bars are below an accuracy that was asked for, and which finer grid or more harmonics come next.

A bar is compared with the magnitude of its result; that of a component with the whole vector, of an angle with a
radian, of the contact fraction with 1, of an entry of an array with the largest entry: a component that vanishes by
symmetry has no digits of its own.

Where petals rub, harmonics of their slips leave a part of a bar that no grid makes smaller (`harmonics_bars.py`): the
larger of both parts is refined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from petalfoil.analysis.grid_study import grid_of, grid_text, on_grid, unknowns
from petalfoil.analysis.harmonics_bars import harmonics_bar, scalar_harmonics_bar
from petalfoil.case import Case, ModelKind
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS, SCALARS
from petalfoil.results.summary import in_order, shown_as
from petalfoil.units import format_percent

LARGEST = {ModelKind.TWO_D: 1024, ModelKind.THREE_D: 128 * 48}
"""Cells per pitch, times those over the length, up to which grids are refined. A point takes a second or half a minute
there; twice the cells would take four to eight times as long."""

MOST_HARMONICS = {ModelKind.TWO_D: 128, ModelKind.THREE_D: 64}
"""Harmonics of slips up to which they are doubled."""

VECTORS = {
    "force_x": "bearing_force",
    "force_y": "bearing_force",
    "film_force_x": "bearing_force",
    "film_force_y": "bearing_force",
    "contact_force_x": "bearing_force",
    "contact_force_y": "bearing_force",
    "contact_normal_force": "bearing_force",
    "eccentricity_x": "reference_film_thickness",
    "eccentricity_y": "reference_film_thickness",
}
"""What the components of vectors are compared with, if that is larger."""

UNIT = {"contact_fraction": 1.0}
"""What is compared with a value of its own."""


OWN_ROWS = ("amplitude", "tilt_amplitude", "dominant_whirl_ratio")
"""Results that a table of its own shows."""


@dataclass(frozen=True)
class Resolution:
    """What a question is asked with.

    Attributes
    ----------
    case : Case
        The bearing on its grid.
    harmonics : int or None
        Fewest harmonics of slips; None for as many as they need.
    """

    case: Case
    harmonics: int | None = None

    @property
    def text(self) -> str:
        """It in words."""
        grid = grid_text(self.case)
        return grid if self.harmonics is None else f"{grid}, {self.harmonics} harmonics of slips"


@dataclass(frozen=True)
class RelativeBar:
    """An error bar over the size of its result, and the part of it that comes from harmonics of slips [1]."""

    whole: float
    by_harmonics: float = 0.0

    @property
    def by_grids(self) -> float:
        """The part that comes from the grids; of a bar without bound that of harmonics first."""
        return self.whole - self.by_harmonics if np.isfinite(self.by_harmonics) else 0.0


def ahead_of(here: Resolution, records: Sequence[Record], accuracy: float) -> Resolution | None:
    """What refines the larger part of the largest error bar that misses the accuracy and can be refined.

    None where every bar that misses it has a part above it that is at its limit.
    """
    told = max((int(record.scalars.get("friction_harmonics", 0)) for record in records), default=0)
    on, more = finer(here.case), more_harmonics(here, told)
    missed = [bar for record in records for bar in relative_bars(record).values() if not bar.whole <= accuracy]
    for bar in sorted(missed, key=lambda bar: bar.whole, reverse=True):
        by_grid = bar.by_grids, None if on is None else replace(here, case=on)
        by_harmonics = bar.by_harmonics, more
        for part, ahead in sorted([by_grid, by_harmonics], key=lambda each: each[0], reverse=True):
            if ahead is not None:
                return ahead
            if part > accuracy:
                break
    return None


def more_harmonics(here: Resolution, told: int) -> Resolution | None:
    """With twice as many harmonics as the `told` ones; None where slips have one, and where these are too many."""
    harmonics = 2 * max(told, here.harmonics or 0)
    several = 1 < told and harmonics <= MOST_HARMONICS[here.case.model.kind]
    return replace(here, harmonics=harmonics) if several else None


def finer(case: Case) -> Case | None:
    """The case on twice as many cells each way; None where that is finer than accuracy is bought with."""
    cells, axial = grid_of(case)
    ahead = on_grid(case, 2 * cells, 2 * axial)
    return ahead if unknowns(ahead) <= LARGEST[case.model.kind] else None


def shortfalls(records: Sequence[Record], accuracy: float) -> dict[str, float]:
    """Largest relative error bar of each shown result of which it is above `accuracy`, by its name in words."""
    worst: dict[str, float] = {}
    for record in records:
        for name, bar in relative_bars(record).items():
            if not bar.whole <= accuracy:
                worst[name] = max(worst.get(name, 0.0), bar.whole)
    return worst


def relative_bars(record: Record) -> dict[str, RelativeBar]:
    """Error bar over the size of each result that tables show with one, by its name there."""
    errors, bars = record.errors or {}, dict[str, RelativeBar]()
    shown = {*in_order(errors), *OWN_ROWS}
    for name, error in errors.items():
        if name in shown:
            size, by_harmonics = size_of(name, record.scalars), scalar_harmonics_bar(name, record)
            bars[shown_as(name).label] = RelativeBar(_over(error, size), _over(by_harmonics, size))
    for name, values in record.fields.items():
        if f"{name}_error" in FIELDS and f"{name}_error" in record.fields:
            errors_of = record.fields[f"{name}_error"].astype(float)
            if errors_of.size:
                size, part = float(np.max(np.abs(values.astype(float)))), harmonics_bar(name, record)
                whole, of_harmonics = float(np.max(errors_of)), 0.0 if part is None else float(np.max(part))
                bars[FIELDS[name].long_name] = RelativeBar(_over(whole, size), _over(of_harmonics, size))
    return bars


def size_of(name: str, scalars: Mapping[str, object]) -> float:
    """What the error bar of a result is compared with, in its unit."""

    def magnitude(of: str) -> float:
        value = scalars.get(of, 0.0)
        return abs(value) if isinstance(value, int | float) else 0.0

    least = UNIT.get(name, 1.0 if SCALARS[name].units == "rad" else 0.0)
    return max(magnitude(name), magnitude(VECTORS.get(name, name)), least)


def _over(error: float, size: float) -> float:
    if error == 0.0:
        return 0.0
    return error / size if size > 0.0 and np.isfinite(error) else float("inf")


def remark_on(record: Record, accuracy: float, stopped: str = "") -> Record:
    """The record with a remark that names what misses the accuracy, and why; `stopped` says what ended it before."""
    missed = {name: bar for name, bar in relative_bars(record).items() if not bar.whole <= accuracy}
    if not missed:
        return record
    named = ", ".join(f"{name} ({told(bar)})" for name, bar in sorted(missed.items()))
    text = f"an accuracy of {100.0 * accuracy:g} % is not reached on the finest grid that is tried: {named}"
    if any(0.0 < bar.by_harmonics < np.inf for bar in missed.values()):
        text += f"; slips have {record.scalars['friction_harmonics']} harmonics"
        kind = Case.from_toml(record.case_toml).model.kind
        text += f", and {MOST_HARMONICS[kind]} are the most that are tried"
    return replace(record, remarks=(*record.remarks, f"{text}; {stopped}" if stopped else text))


def told(bar: RelativeBar) -> str:
    """A bar in words, with its part by harmonics where they have one."""
    if not np.isfinite(bar.by_harmonics):
        return "unknown, as one harmonic of slips has no half"
    part = f", {format_percent(bar.by_harmonics)} of it from harmonics of slips" if bar.by_harmonics > 0.0 else ""
    return f"± {format_percent(bar.whole)}{part}"
