"""The files of the report: page, NetCDF, CSV and JSON."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import TypeAlias

from petalfoil.errors import StoreError, UsageError
from petalfoil.report import page_tables, paper_page
from petalfoil.report.assumptions import AssumptionResult
from petalfoil.report.claims import Evidence, claims
from petalfoil.report.interpretations import Interpretation
from petalfoil.report.page_tables import PageTable
from petalfoil.results.atomic import replacing
from petalfoil.results.store import save
from petalfoil.results.summary import as_json

Plain: TypeAlias = "float | int | str | bool | list[Plain] | dict[str, Plain] | None"

PAGE, SUMMARY = "index.html", "report.json"
SHEET = "figure8.csv"
"""A file that the pages of the paper have and the report of a case has not."""


def refuse_foreign(folder: Path, own: tuple[str, ...]) -> None:
    """Refuse a folder with files, unless a report of the same kind wrote it: those are written anew.

    Parameters
    ----------
    folder : Path
        Where the report is to go.
    own : tuple of str
        Files by which a folder of this kind of report is known.

    Raises
    ------
    UsageError
        It holds something else.
    """
    if not folder.is_dir() or all((folder / name).is_file() for name in own):
        return
    others = sorted(path.name for path in folder.iterdir())
    if others:
        some = ", ".join(others[:3]) + (" …" if len(others) > 3 else "")
        raise UsageError(f"{folder} holds other files ({some}): give a new folder or an empty one")


def write(evidence: Evidence, folder: Path) -> Path:
    """Write all files into `folder`; returns the path of the page.

    Raises
    ------
    StoreError
        A file cannot be written.
    """
    sheets = {
        "figure6_7_2d.csv": page_tables.profiles(evidence.reference_2d),
        "figure6_7_3d.csv": page_tables.profiles(evidence.reference_3d),
        SHEET: page_tables.characteristics(evidence),
        "assumptions.csv": page_tables.assumption_loads(evidence.assumptions),
    }
    curves = {f"{f.name}_n{c.count}.nc": c.dataset for f in evidence.families for c in f.curves}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, sheet in sheets.items():
            _put(folder / name, csv_text(sheet))
        _put(folder / SUMMARY, json.dumps(summary(evidence), indent=1, allow_nan=False, ensure_ascii=False) + "\n")
        _put(folder / PAGE, paper_page.render(evidence, (*sheets, SUMMARY, *curves)))
    except OSError as error:
        raise StoreError(f"cannot write to {folder}: {error.strerror}") from error
    for name, dataset in curves.items():
        save(dataset, folder / name)
    return folder / PAGE


def csv_text(sheet: PageTable) -> str:
    """A table as comma-separated values."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(sheet.head)
    writer.writerows(sheet.rows)
    return buffer.getvalue()


def summary(evidence: Evidence) -> dict[str, Plain]:
    """The scalar results of the report in SI units; null for missing values."""
    return {
        "claims": [
            {"claim": c.quote, "where": c.where, "computed": c.computed, "verdict": str(c.verdict)}
            for c in claims(evidence)
        ],
        "curves": {
            family.name: {
                str(curve.count): [dict(as_json(record)) for record in curve.records] for curve in family.curves
            }
            for family in evidence.families
        },
        "assumptions": [_assumption(row) for row in evidence.assumptions],
        "interpretations": {
            "reference": [_interpretation(one) for one in evidence.reference_interpretations],
            "tangent": [_interpretation(one) for one in evidence.tangent_interpretations],
        },
        "grids": [
            {
                "nodes": list(grid.nodes),
                "cells": list(grid.cells),
                "bearing_force": _number(grid.load),
                "factorizations": grid.factorizations,
                "residual": _number(grid.residual),
            }
            for grid in evidence.grids
        ],
        "wall_time": evidence.seconds,
    }


def _assumption(row: AssumptionResult) -> dict[str, Plain]:
    packs: list[Plain] = [
        {
            "count": pack.count,
            "bearing_force": [_number(load) for load in pack.loads],
            "film_normal_force": _number(pack.film_normal_force),
            "contact_fraction": _number(pack.contact_fraction),
        }
        for pack in row.packs
    ]
    return {
        "name": row.assumption.name,
        "assumption": row.assumption.description,
        "packs": packs,
        "ratios": [_number(ratio) for ratio in row.ratios],
        "twofold": row.twofold,
        "two_to_four": row.two_to_four,
    }


def _interpretation(one: Interpretation) -> dict[str, Plain]:
    values: list[Plain] = [_number(value) for value in one.values]
    return {"name": one.name, "unit": one.unit, "values": values, "ratio": _number(one.ratio)}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _put(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
