"""Whether error bars are below an accuracy that was asked for, and which finer grid comes next.

A bar is compared with the magnitude of its result; that of a component with the whole vector, of an angle with a
radian, of the contact fraction with 1, of an entry of an array with the largest entry: a component that vanishes by
symmetry has no digits of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from petalfoil.analysis.grid_study import grid_of, on_grid, unknowns
from petalfoil.case import Case, ModelKind
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS, SCALARS
from petalfoil.results.summary import in_order, shown_as
from petalfoil.units import format_percent

LARGEST = {ModelKind.TWO_D: 1024, ModelKind.THREE_D: 128 * 48}
"""Cells per pitch, times those over the length, up to which grids are refined. A point takes a second or half a minute
there; twice the cells would take four to eight times as long."""

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
            if not bar <= accuracy:
                worst[name] = max(worst.get(name, 0.0), bar)
    return worst


def relative_bars(record: Record) -> dict[str, float]:
    """Error bar over the size of each result that tables show with one, by its name there."""
    errors, bars = record.errors or {}, {}
    shown = {*in_order(errors), *OWN_ROWS}
    for name, error in errors.items():
        if name in shown:
            bars[shown_as(name).label] = _over(error, size_of(name, record.scalars))
    for name, values in record.fields.items():
        if f"{name}_error" in FIELDS and f"{name}_error" in record.fields:
            errors_of = record.fields[f"{name}_error"].astype(float)
            if errors_of.size:
                size = float(np.max(np.abs(values.astype(float))))
                bars[FIELDS[name].long_name] = _over(float(np.max(errors_of)), size)
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


def remark_on(record: Record, accuracy: float) -> Record:
    """The record with a remark that names what misses the accuracy on the finest grid."""
    missed = shortfalls([record], accuracy)
    if not missed:
        return record
    named = ", ".join(f"{name} (± {format_percent(bar)})" for name, bar in sorted(missed.items()))
    text = f"an accuracy of {100.0 * accuracy:g} % is not reached on the finest grid that is tried: {named}"
    return replace(record, remarks=(*record.remarks, text))
