"""A whole length, aligned, tilted or under a moment, over half the length of the aligned journal."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from measure import Row, at_most, in_turn

from petalfoil import Case, balance, solve

EXAMPLES = Path(__file__).parents[1] / "examples"
GRID = {"model.cells_per_pitch": 32, "model.axial_cells": 16}
QUICK = {"model.cells_per_pitch": 12, "model.axial_cells": 6}
TILT, LOAD, MOMENT = (50e-6, 0.0), (0.0, -10.0), (0.0, 0.02)
MOST = 2.5
"""Wanted: processor time of the whole length over that of half."""


def rows(grid: dict[str, int], repeats: int) -> list[Row]:
    """Ratios for `solve` at a tilt, and for `balance` at a tilt and under a moment."""
    half = Case.load(EXAMPLES / "paper_n8_spatial.toml").replace(**grid)
    tilted = half.replace(**{"operation.tilt": TILT})
    centred, centred_tilted = (of.replace(**{"operation.eccentricity": (0.0, 0.0)}) for of in (half, tilted))
    questions: dict[str, Callable[[], object]] = {
        "solve": lambda: solve(half),
        "solve at 50 µrad": lambda: solve(tilted),
        "balance with 10 N": lambda: balance(centred, LOAD),
        "balance with 10 N at 50 µrad": lambda: balance(centred_tilted, LOAD),
        "balance with 10 N and 0.02 N m": lambda: balance(centred, LOAD, moment=MOMENT),
    }
    seconds = in_turn(questions, repeats)
    pairs = [(name, name.split(" at ")[0].split(" and ")[0]) for name in questions]
    return [row(name, seconds[name] / seconds[base]) for name, base in pairs if name != base]


def row(name: str, ratio: float) -> Row:
    """One ratio."""
    return at_most(f"whole_length: {name}", f"whole length: {name}, over half of the aligned one", ratio, MOST)
