"""The report on disk: page, labelled data, tables, one JSON object."""

from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import TypeAlias

from petalfoil.errors import StoreError
from petalfoil.report import page, tables
from petalfoil.report.claims import Evidence, claims
from petalfoil.report.meanings import Meaning
from petalfoil.report.study import Row
from petalfoil.report.tables import Table
from petalfoil.results.atomic import replacing
from petalfoil.results.store import save
from petalfoil.results.summary import as_json

Plain: TypeAlias = "float | int | str | bool | list[Plain] | dict[str, Plain] | None"

PAGE, SUMMARY = "index.html", "report.json"


def write(evidence: Evidence, folder: Path) -> Path:
    """Write everything into `folder`; gives the page.

    Raises
    ------
    StoreError
        Something cannot be written.
    """
    sheets = {
        "figure6_7_flat.csv": tables.profiles(evidence.flat),
        "figure6_7_spatial.csv": tables.profiles(evidence.spatial),
        "figure8.csv": tables.characteristics(evidence),
        "study.csv": tables.absolute(evidence.study),
    }
    curves = {f"{f.name}_n{c.count}.nc": c.dataset for f in evidence.families for c in f.curves}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, sheet in sheets.items():
            _put(folder / name, csv_text(sheet))
        _put(folder / SUMMARY, json.dumps(summary(evidence), indent=1, allow_nan=False, ensure_ascii=False) + "\n")
        _put(folder / PAGE, page.render(evidence, (*sheets, SUMMARY, *curves)))
    except OSError as error:
        raise StoreError(f"cannot write to {folder}: {error.strerror}") from error
    for name, dataset in curves.items():
        save(dataset, folder / name)
    return folder / PAGE


def csv_text(sheet: Table) -> str:
    """A table as comma-separated values."""
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(sheet.head)
    writer.writerows(sheet.rows)
    return buffer.getvalue()


def summary(evidence: Evidence) -> dict[str, Plain]:
    """The whole report but its fields: SI units, null for what is not there."""
    return {
        "claims": [
            {"claim": c.quote, "where": c.where, "ours": c.ours, "verdict": str(c.verdict)} for c in claims(evidence)
        ],
        "curves": {
            family.name: {
                str(curve.count): [dict(as_json(record)) for record in curve.records] for curve in family.curves
            }
            for family in evidence.families
        },
        "study": [_study(row) for row in evidence.study],
        "meanings": {
            "reference": [_meaning(m) for m in evidence.meanings],
            "tangent": [_meaning(m) for m in evidence.tangent_meanings],
        },
        "grids": [
            {
                "nodes": list(grid.nodes),
                "cells": list(grid.cells),
                "bearing_force": _number(grid.load),
                "factorizations": grid.factorisations,
                "residual": _number(grid.residual),
            }
            for grid in evidence.grids
        ],
        "wall_time": evidence.seconds,
    }


def _study(row: Row) -> dict[str, Plain]:
    packages: list[Plain] = [
        {
            "count": package.count,
            "bearing_force": [_number(load) for load in package.loads],
            "film_push": _number(package.push),
            "contact_fraction": _number(package.share),
        }
        for package in row.packages
    ]
    return {
        "name": row.variation.name,
        "assumption": row.variation.says,
        "packages": packages,
        "ratios": [_number(ratio) for ratio in row.ratios],
        "twofold": row.twofold,
        "two_to_four": row.two_to_four,
    }


def _meaning(meaning: Meaning) -> dict[str, Plain]:
    values: list[Plain] = [_number(value) for value in meaning.values]
    return {"name": meaning.name, "unit": meaning.unit, "values": values, "ratio": _number(meaning.ratio)}


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _put(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
