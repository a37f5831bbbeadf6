"""The benchmark runs, its file has the rows, and its page speaks of each; the yardstick is right and stands alone."""

from __future__ import annotations

import ast
import importlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.physics.reynolds import circumferential_flux
from tests.docs.texts import DOCS, ROOT, text

FOLDER = ROOT / "benchmarks"


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """A script of the benchmarks, on one thread."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    call = [sys.executable, *arguments]
    return subprocess.run(call, capture_output=True, text=True, check=True, cwd=ROOT, env=environment)


def measured(path: Path, *options: str) -> list[dict[str, Any]]:
    """Rows of a quick run."""
    printed = run("benchmarks/run.py", "--quick", "--json", str(path), *options).stdout.splitlines()
    rows: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["rows"]
    descriptions = [row["description"] for row in rows]
    assert descriptions == [line[: len(text)] for text, line in zip(descriptions, printed, strict=True)]
    return rows


@pytest.mark.slow
def test_a_quick_run_of_the_plain_journal(tmp_path: Path) -> None:
    rows = {row["name"]: row for row in measured(tmp_path / "rows.json", "--only", "journal", "others")}
    error = rows["journal_48x16_error"]["ratio"]
    assert 1e-3 < error < 7e-3  # of second order: 0.08 % on 120 cells
    times = rows["journal_48x16"]["details"]
    assert rows["journal_48x16"]["ratio"] == times["seconds_solution"] / times["seconds_yardstick"]
    for name in ("openairbearing", "ross"):
        assert rows[name]["ratio"] is not None or rows[name]["remark"]


@pytest.mark.slow
def test_a_quick_run_has_all_rows(tmp_path: Path) -> None:
    before = tmp_path / "before.json"
    rows = {row["name"]: row for row in measured(before, "--classic-seconds", "600")}  # it needs two on a slow machine
    assert set(rows) >= {"warm_count", "warm_total", "factor_original", "growth_time", "growth_memory", "journal_48x16"}
    shares = [rows[f"warm_{name}"]["ratio"] for name in ("factorisation", "assembly", "solves", "rest")]
    assert_allclose(sum(shares), 1.0, rtol=1e-12)
    assert min(shares) > 0.0
    assert_allclose(rows["warm_total"]["ratio"] * rows["warm_factorisation"]["ratio"], 1.0, rtol=1e-12)
    assert rows["warm_count"]["ratio"] >= 2.0
    assert rows["race_n8_11_e0_numpy"]["details"]["apart at 1e-05"] < 1e-4
    again = run("benchmarks/run.py", "--quick", "--only", "point", "--against", str(before)).stdout
    assert again.count("(was ") == len([name for name in rows if name.startswith(("warm", "factor"))])


def test_the_yardstick_is_no_petalfoil() -> None:
    nodes = ast.walk(ast.parse(text(FOLDER / "yardstick.py")))
    imported = {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    assert imported == {"__future__", "typing", "scipy.sparse.linalg"}


def test_the_page_speaks_of_every_group() -> None:
    page = text(DOCS / "benchmarks.md")
    (listed,) = re.findall(r"^GROUPS = (\(.*\))$", text(FOLDER / "run.py"), re.MULTILINE)
    for group in ast.literal_eval(listed):
        assert f"`{group}`" in page


def test_the_least_flux_of_a_floor_is_the_flux(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a floor takes for a film is (F2) to rounding, not something less."""
    monkeypatch.syspath_prepend(str(FOLDER))
    floors = importlib.import_module("floors")
    rng = np.random.default_rng(1)
    P, H = 1.0 + 0.2 * rng.random((2, 3, 9, 1))
    sides = [np.ascontiguousarray(side) for nodes in (P, H) for side in (nodes[:, :-1], nodes[:, 1:])]
    expected = circumferential_flux(P, H, 10.0, np.full((8, 1), 0.01)).value
    assert_allclose(floors.Flux(*sides).through(10.0, 0.01), expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())


@pytest.mark.slow
def test_a_floor_is_below_what_a_task_takes() -> None:
    """Libraries take some of the profiled time, the films have been counted."""
    parts = json.loads(run("benchmarks/floors.py", "designs", "--inside").stdout)
    assert parts["count"] > 100
    assert parts["films"] == parts["count"] * parts["film"]
    assert 0.0 < parts["films"] < parts["libraries"] < parts["seconds"]
