"""Ratios of petalfoil to other methods, and to itself at other sizes, in one table.

    python benchmarks/run.py [--quick] [--json FILE] [--against FILE] [--only GROUP ...] [--classic-seconds S]

Times are the smallest processor times of calls made in turn. Only ratios of one run can be compared.
docs/benchmarks.md explains the rows.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

import former
import growth
import numpy as np
import orbit
import others
import plain_journal
import race
import scipy
import warm_point
import whole_length
from measure import Row

import petalfoil

GROUPS = ("race", "point", "growth", "whole", "journal", "orbit", "others", "former")


def groups(quick: bool, classic_seconds: float) -> dict[str, Callable[[], list[Row]]]:
    """The measurements of each group. A quick run has the same rows; its grids are too small for the limits."""
    if quick:
        return {
            "race": lambda: race.rows(race.QUICK, classic_seconds, 1),
            "point": lambda: warm_point.rows(warm_point.Grid(12, 6), 3, 2),
            "growth": lambda: growth.rows((growth.Grid(8, 4), growth.Grid(14, 8)), None),
            "whole": lambda: whole_length.rows(whole_length.QUICK, 1),
            "journal": lambda: plain_journal.rows(((48, 16),), 2),
            "orbit": lambda: orbit.rows(orbit.QUICK),
            "others": lambda: others.rows(1),
            "former": lambda: former.rows(1, quick=True),
        }
    return {
        "race": lambda: race.rows(race.FULL, classic_seconds, 3),
        "point": lambda: warm_point.rows(warm_point.Grid(), 9, 7),
        "growth": lambda: growth.rows(growth.SIZES, growth.LARGEST),
        "whole": lambda: whole_length.rows(whole_length.GRID, 3),
        "journal": lambda: plain_journal.rows(plain_journal.GRIDS, 7),
        "orbit": lambda: orbit.rows(orbit.FULL),
        "others": lambda: others.rows(2),
        "former": lambda: former.rows(3),
    }


def main() -> None:
    """Measure, show the table as it grows, write the file."""
    chosen = arguments()
    before = earlier(chosen.against)
    measured: list[Row] = []
    for name, measure in groups(chosen.quick, chosen.classic_seconds).items():
        if name not in chosen.only:
            continue
        for row in measure():
            measured.append(row if not chosen.quick else replace(row, target="", met=None))
            print(line(measured[-1], before), flush=True)
    if chosen.json is not None:
        chosen.json.write_text(
            json.dumps(report(measured, chosen.quick), indent=1, allow_nan=False) + "\n", encoding="utf-8"
        )


def arguments() -> argparse.Namespace:
    """Arguments of the command line."""
    about, usage = (__doc__ or "").split("\n\n")[:2]
    parser = argparse.ArgumentParser(description=about, usage=usage.strip())
    parser.add_argument("--quick", action="store_true", help="small grids, about a minute")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all rows with their details")
    parser.add_argument("--against", type=Path, metavar="FILE", help="show the ratios of an earlier run beside")
    parser.add_argument("--only", nargs="+", choices=GROUPS, default=GROUPS, help="some groups of rows")
    parser.add_argument("--classic-seconds", type=float, default=30.0, metavar="S", help="limit of each race")
    return parser.parse_args()


def earlier(path: Path | None) -> dict[str, float]:
    """Ratios of an earlier run by the names of their rows."""
    if path is None:
        return {}
    rows = json.loads(path.read_text(encoding="utf-8"))["rows"]
    return {row["name"]: row["ratio"] for row in rows if row["ratio"] is not None}


def line(row: Row, before: dict[str, float]) -> str:
    """One row as text."""
    ratio = "–" if row.ratio is None else shown(row.ratio)
    ratio += f" (was {shown(before[row.name])})" if row.name in before else ""
    verdict = {True: "met", False: "not met", None: ""}[row.met]
    target = f"{row.target} {verdict}".strip()
    return f"{row.description:<88} {ratio:>9}  {target:<16} {row.remark}".rstrip()


def shown(ratio: float) -> str:
    """Three significant digits, no exponent."""
    return np.format_float_positional(ratio, precision=3, unique=False, fractional=False, trim="-")


def report(measured: list[Row], quick: bool) -> dict[str, object]:
    """Contents of the file: the versions, then the rows."""
    return {
        "petalfoil": petalfoil.__version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "cores": os.cpu_count(),
        "quick": quick,
        "rows": [row.plain() for row in measured],
    }


if __name__ == "__main__":
    sys.exit(main())
