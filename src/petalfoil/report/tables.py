"""Results of the report as rows of text: the same for the page, the CSV files and the terminal."""

from __future__ import annotations

import math
from dataclasses import dataclass

from petalfoil.report.claims import Evidence
from petalfoil.report.families import Family
from petalfoil.report.grids import Grid
from petalfoil.report.meanings import Meaning
from petalfoil.report.scope import COMPARED
from petalfoil.report.study import Row

NOTHING = "–"


@dataclass(frozen=True)
class Table:
    """Headings and cells."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def text(value: float, digits: int) -> str:
    """A number with so many decimals; a dash where there is none."""
    return f"{value:.{digits}f}" if math.isfinite(value) else NOTHING


def loads(family: Family) -> Table:
    """Loads of a family at its displacements."""
    places = family.curves[0].displacements()
    columns = [curve.figure("bearing_force") for curve in family.curves]
    rows = [
        (text(e * 1e6, 0), *(text(column[k], 2) for column in columns), text(_ratio(columns[0][k], columns[-1][k]), 2))
        for k, e in enumerate(places)
    ]
    few, many = family.curves[0].count, family.curves[-1].count
    return Table(("e, µm", *(f"{curve.label}, N" for curve in family.curves), f"{many} / {few}"), tuple(rows))


def _ratio(few: float, many: float) -> float:
    return many / few if few > 1e-3 else math.nan


def study(rows: tuple[Row, ...]) -> Table:
    """Ratios of the loads under every assumption."""
    few, many = (rows[0].packages[which].count for which in (0, -1))
    head = ("assumption", *(f"{many} / {few} at {e * 1e6:.0f} µm" for e in COMPARED))
    head += (f"push, {many} / {few}", "contacts carry up to", "fits")
    lines = [
        (
            row.variation.says,
            *(text(ratio, 2) for ratio in row.ratios),
            text(row.push_ratio, 2),
            f"{row.share:.0%}" if math.isfinite(row.share) else NOTHING,
            ", ".join(name for name, fits in (("two-fold", row.twofold), ("2–4", row.two_to_four)) if fits),
        )
        for row in rows
    ]
    return Table(head, tuple(lines))


def absolute(rows: tuple[Row, ...]) -> Table:
    """Loads under every assumption."""
    counts = [package.count for package in rows[0].packages]
    head = ("assumption", *(f"n = {n}, {e * 1e6:.0f} µm [N]" for n in counts for e in COMPARED))
    lines = [
        (row.variation.says, *(text(load, 2) for package in row.packages for load in package.loads)) for row in rows
    ]
    return Table(head, tuple(lines))


def meanings(reference: tuple[Meaning, ...], tangent: tuple[Meaning, ...], counts: tuple[int, ...]) -> Table:
    """The same ratio of other quantities."""
    few, many = counts[0], counts[-1]
    head = ("quantity", "unit", *(f"n = {n}" for n in counts), f"{many} / {few}")
    head += (*(f"clamped, n = {n}" for n in counts), f"clamped, {many} / {few}")
    lines = [
        (one.says, one.unit, *_figures(one), *_figures(other)) for one, other in zip(reference, tangent, strict=True)
    ]
    return Table(head, tuple(lines))


def _figures(meaning: Meaning) -> tuple[str, ...]:
    return (*(text(value, 2) for value in meaning.values), text(meaning.ratio, 2))


def grids(found: tuple[Grid, ...]) -> Table:
    """The paper's grids."""
    head = ("nodes a petal", "cells a pitch", "load, N", "factorisations from nothing", "largest residual")
    lines = []
    for grid in found:
        flat = grid.nodes[1] == 1
        nodes, cells = (f"{pair[0]}" if flat else f"{pair[0]}×{pair[1]}" for pair in (grid.nodes, grid.cells))
        lines.append((nodes, cells, text(grid.load, 2), f"{grid.factorisations}", f"{grid.residual:.0e}"))
    return Table(head, tuple(lines))


def profiles(family: Family) -> Table:
    """Pressure and film over the first petal around the central journal: the data of Figures 6 and 7."""
    lines = []
    for curve in family.curves:
        central = curve.records[0]
        if not central.converged:
            continue
        p_a = float(central.scalars["ambient_pressure"])
        for i, phi in enumerate(central.coords["phi_exposed"]):
            for j, z in enumerate(central.coords["z"]):
                p, h = (float(central.fields[name][0, i, j]) for name in ("pressure", "film_thickness"))
                lines.append((f"{curve.count}", f"{phi:.9g}", f"{z:.9g}", f"{p / p_a:.9g}", f"{h:.9g}"))
    return Table(("petals", "phi [rad]", "z [m]", "p/p_a [1]", "h [m]"), tuple(lines))


CHARACTERISTIC = {
    "bearing_force": "load [N]",
    "attitude_angle": "attitude angle [rad]",
    "min_film_thickness": "smallest film [m]",
    "peak_pressure": "largest pressure [Pa]",
    "contact_fraction": "contact share [1]",
    "friction_torque": "friction torque [N m]",
}


def characteristics(evidence: Evidence) -> Table:
    """Every point of every curve: the data of Figure 8."""
    lines = []
    for family in evidence.families:
        for curve in family.curves:
            columns = [curve.figure(name) for name in CHARACTERISTIC]
            for k, e in enumerate(curve.displacements()):
                lines.append((family.name, f"{curve.count}", f"{e:.9g}", *(f"{column[k]:.9g}" for column in columns)))
    return Table(("assumptions", "petals", "e [m]", *CHARACTERISTIC.values()), tuple(lines))
