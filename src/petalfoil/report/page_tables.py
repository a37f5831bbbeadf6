"""Results of the report as tables of text, for the page, the CSV files and the terminal."""

from __future__ import annotations

import math
from dataclasses import dataclass

from petalfoil.report.assumptions import AssumptionResult
from petalfoil.report.claims import Evidence
from petalfoil.report.interpretations import Interpretation
from petalfoil.report.load_characteristics import COMPARED, CharacteristicFamily
from petalfoil.report.paper_grids import GridLoad
from petalfoil.results import tables
from petalfoil.results.answer import Answer
from petalfoil.results.tables import tables_of

MISSING = "–"

SMALLEST_LOAD = 1e-3
"""A ratio to a load below this is not shown [N]: around the centred journal loads are rounding."""


@dataclass(frozen=True)
class PageTable:
    """Headings and cells.

    Attributes
    ----------
    head : tuple of str
        Headings, the unit behind a line break; empty for lines that explain themselves.
    rows : tuple of tuple of str
        Cells.
    title : str
        What stands above it.
    left : tuple of int
        Columns of words, negative numbers from the end; where there are none, cells tell which columns hold numbers.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    title: str = ""
    left: tuple[int, ...] = ()


def of_answer(answer: Answer) -> tuple[PageTable, ...]:
    """The tables of an answer."""
    return tuple(map(_plain, tables_of(answer)))


def _plain(table: tables.TextTable) -> PageTable:
    head = tuple(f"{column.heading}\n{column.unit}".rstrip() for column in table.columns)
    words = tuple(k for k, column in enumerate(table.columns) if not column.of_numbers)
    return PageTable(head, tuple(table.lines), table.title, words if head else (0, -1))


def text(value: float, digits: int) -> str:
    """A number with `digits` decimals; a dash for nan."""
    return f"{value:.{digits}f}" if math.isfinite(value) else MISSING


def loads(family: CharacteristicFamily) -> PageTable:
    """Loads of a family at its displacements."""
    columns = [curve.values("bearing_force") for curve in family.curves]
    rows = [
        (text(e * 1e6, 0), *(text(column[k], 2) for column in columns), text(_ratio(columns[0][k], columns[-1][k]), 2))
        for k, e in enumerate(family.curves[0].displacements())
    ]
    few, many = family.curves[0].count, family.curves[-1].count
    return PageTable(("e, µm", *(f"{curve.label}, N" for curve in family.curves), f"{many} / {few}"), tuple(rows))


def _ratio(few: float, many: float) -> float:
    return many / few if few > SMALLEST_LOAD else math.nan


def assumption_ratios(results: tuple[AssumptionResult, ...]) -> PageTable:
    """Ratios of the loads under every assumption."""
    few, many = (results[0].packs[which].count for which in (0, -1))
    head = ("assumption", *(f"{many} / {few} at {e * 1e6:.0f} µm" for e in COMPARED))
    head += (f"normal force of the film, {many} / {few}", "largest contact fraction", "agrees with")
    rows = [
        (
            row.assumption.description,
            *(text(ratio, 2) for ratio in row.ratios),
            text(row.normal_force_ratio, 2),
            f"{row.contact_fraction:.0%}" if math.isfinite(row.contact_fraction) else MISSING,
            ", ".join(name for name, agrees in (("two-fold", row.twofold), ("2–4", row.two_to_four)) if agrees),
        )
        for row in results
    ]
    return PageTable(head, tuple(rows))


def assumption_loads(results: tuple[AssumptionResult, ...]) -> PageTable:
    """Loads under every assumption."""
    counts = [pack.count for pack in results[0].packs]
    head = ("assumption", *(f"n = {n}, {e * 1e6:.0f} µm [N]" for n in counts for e in COMPARED))
    rows = [
        (row.assumption.description, *(text(load, 2) for pack in row.packs for load in pack.loads)) for row in results
    ]
    return PageTable(head, tuple(rows))


def interpretations(
    reference: tuple[Interpretation, ...], tangent: tuple[Interpretation, ...], counts: tuple[int, ...]
) -> PageTable:
    """Other quantities and their ratios."""
    few, many = counts[0], counts[-1]
    head = ("quantity", "unit", *(f"n = {n}" for n in counts), f"{many} / {few}")
    head += (*(f"clamped, n = {n}" for n in counts), f"clamped, {many} / {few}")
    rows = [
        (one.description, one.unit, *_values(one), *_values(other))
        for one, other in zip(reference, tangent, strict=True)
    ]
    return PageTable(head, tuple(rows))


def _values(one: Interpretation) -> tuple[str, ...]:
    return (*(text(value, 2) for value in one.values), text(one.ratio, 2))


def grids(loads: tuple[GridLoad, ...]) -> PageTable:
    """Loads on the grids of the paper."""
    head = ("nodes per petal", "cells per pitch", "load, N", "factorisations, cold start", "largest residual")
    rows = []
    for grid in loads:
        is_2d = grid.nodes[1] == 1
        nodes, cells = (f"{pair[0]}" if is_2d else f"{pair[0]}×{pair[1]}" for pair in (grid.nodes, grid.cells))
        rows.append((nodes, cells, text(grid.load, 2), f"{grid.factorizations}", f"{grid.residual:.0e}"))
    return PageTable(head, tuple(rows))


def profiles(family: CharacteristicFamily) -> PageTable:
    """Pressure and film over the first petal around the centred journal: the data of Figures 6 and 7."""
    rows = []
    for curve in family.curves:
        centred = curve.records[0]
        if not centred.converged:
            continue
        p_a = float(centred.scalars["ambient_pressure"])
        for i, phi in enumerate(centred.coords["phi_exposed"]):
            for j, z in enumerate(centred.coords["z"]):
                p, h = (float(centred.fields[name][0, i, j]) for name in ("pressure", "film_thickness"))
                rows.append((f"{curve.count}", f"{phi:.9g}", f"{z:.9g}", f"{p / p_a:.9g}", f"{h:.9g}"))
    return PageTable(("petals", "phi [rad]", "z [m]", "p/p_a [1]", "h [m]"), tuple(rows))


CHARACTERISTIC = {
    "bearing_force": "load [N]",
    "attitude_angle": "attitude angle [rad]",
    "min_film_thickness": "minimum film thickness [m]",
    "peak_pressure": "peak pressure [Pa]",
    "contact_fraction": "contact fraction [1]",
    "friction_torque": "friction torque [N m]",
}


def characteristics(evidence: Evidence) -> PageTable:
    """All points of all characteristics: the data of Figure 8."""
    rows = []
    for family in evidence.families:
        for curve in family.curves:
            columns = [curve.values(name) for name in CHARACTERISTIC]
            for k, e in enumerate(curve.displacements()):
                rows.append((family.name, f"{curve.count}", f"{e:.9g}", *(f"{column[k]:.9g}" for column in columns)))
    return PageTable(("assumptions", "petals", "e [m]", *CHARACTERISTIC.values()), tuple(rows))
