"""Memory that a grid needs: its size counted as it is built, and a grid that does not fit refused at once."""

from __future__ import annotations

import re
import subprocess
import sys
import time

import pytest

import petalfoil
from petalfoil import memory
from petalfoil.errors import DefinitionError
from petalfoil.memory import check_memory, grid_of
from petalfoil.system.build import build_pair, build_problem
from tests.cases import FAULTS, case

GB = 1e9
HUGE = {"model.kind": "3d", "model.cells_per_pitch": 4096, "model.axial_cells": 512}


@pytest.mark.parametrize("kind", ["2d", "3d"])
@pytest.mark.parametrize("symmetry", [True, False])
@pytest.mark.parametrize("name", ["paper_n6", "paper_n8", "plain_journal"])
def test_unknowns_are_counted_as_they_are_built(name: str, symmetry: bool, kind: str) -> None:
    """Up to the rows of roots and edges, whose values are known."""
    grid = {"model.kind": kind, "model.symmetry": symmetry, "model.cells_per_pitch": 48, "model.axial_cells": 8}
    one = case(name, **grid)
    layout = build_problem(one).layout
    assert grid_of(one).unknowns == pytest.approx(layout.n_wall + layout.wall.film.unknown.size, rel=0.04)


def test_a_grid_beyond_memory_is_refused_in_less_than_a_second() -> None:
    one, solve = case("paper_n8", **HUGE), petalfoil.solve
    start = time.process_time()
    with pytest.raises(DefinitionError, match=r"needs some \d+ GB of memory, [\d.]+ GB are available") as caught:
        solve(one)
    assert time.process_time() - start < 1.0
    assert caught.value.key == "model.cells_per_pitch"
    assert caught.value.given == 4096


def test_the_grid_that_is_told_fits_and_one_a_little_finer_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "available_memory", lambda: 2.0 * GB)
    with pytest.raises(DefinitionError) as caught:
        check_memory(case("paper_n8", **HUGE))
    assert caught.value.allowed == "up to cells_per_pitch = 158, axial_cells = 18"
    fits = {"model.kind": "3d", "model.cells_per_pitch": 158, "model.axial_cells": 18}
    check_memory(case("paper_n8", **fits))
    with pytest.raises(DefinitionError):
        check_memory(case("paper_n8", **{**fits, "model.cells_per_pitch": 172}))


def test_a_2d_grid_names_no_axial_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "available_memory", lambda: 0.1 * GB)
    with pytest.raises(DefinitionError, match=r"allowed: up to cells_per_pitch = \d+$"):
        check_memory(case("paper_n8", **{"model.cells_per_pitch": 4096}))
    monkeypatch.setattr(memory, "available_memory", lambda: 1e3)
    with pytest.raises(DefinitionError, match="allowed: none here, free some memory"):
        check_memory(case("paper_n8"))


def test_two_bearings_need_twice_the_whole_length(monkeypatch: pytest.MonkeyPatch) -> None:
    pair = petalfoil.Case.load(FAULTS / "two_bearings_plain.toml")
    needed = 2.0 * grid_of(pair.replace(**{"model.symmetry": False})).memory
    monkeypatch.setattr(memory, "available_memory", lambda: 1.01 * needed)
    build_pair(pair)
    monkeypatch.setattr(memory, "available_memory", lambda: 0.99 * needed)
    with pytest.raises(DefinitionError, match=r"model\.cells_per_pitch"):
        build_pair(pair)


PEAK = """
import re
import sys
from pathlib import Path

import petalfoil
from petalfoil.equilibrium import coarse_start
from tests.cases import case

coarse_start.coarser = lambda case: None  # as where a coarse grid leads nowhere: from there a position takes less

def peak():  # [bytes]; that of `resource` would be the parent's
    return 1024 * int(re.search(r"VmHWM:\\s*(\\d+)", Path("/proc/self/status").read_text())[1])

changes = {} if sys.argv[4] == "-" else {"model.kind": "3d", "petals.theory": sys.argv[4]}
one = case(sys.argv[1], **changes, **{"model.cells_per_pitch": int(sys.argv[2]), "model.axial_cells": int(sys.argv[3])})
petalfoil.solve(one.replace(**{"model.cells_per_pitch": 8, "model.axial_cells": 2}))  # what Python itself takes
before = peak()
petalfoil.solve(one)
print(peak() - before)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize(
    ("name", "grid", "theory"),
    [
        ("paper_n8_spatial", (64, 24), "inextensible"),
        ("plain_journal", (512, 128), "-"),
        ("paper_n8", (64, 24), "shell"),
    ],
)
def test_the_estimate_holds_within_a_factor_of_two(name: str, grid: tuple[int, int], theory: str) -> None:
    cells, axial = grid
    command = [sys.executable, "-c", PEAK, name, str(cells), str(axial), theory]
    peak = float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    one = case(name, **{"model.cells_per_pitch": cells, "model.axial_cells": axial})
    one = one if theory == "-" else one.replace(**{"model.kind": "3d", "petals.theory": theory})
    assert 1.0 <= grid_of(one).memory / peak <= 2.0


LIMITED = """
import resource
import time

import psutil

import petalfoil
from petalfoil.errors import DefinitionError
from tests.cases import case

one = case("paper_n8", **{"model.kind": "3d"})
petalfoil.solve(one.replace(**{"model.cells_per_pitch": 8, "model.axial_cells": 2}))
most = psutil.Process().memory_info().data + 300_000_000
resource.setrlimit(resource.RLIMIT_DATA, (most, most))
start = time.process_time()
try:
    petalfoil.solve(one)
except DefinitionError as refusal:
    print(time.process_time() - start, refusal)
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="macOS ignores such limits")
def test_a_limit_of_the_process_counts_as_the_memory_that_there_is() -> None:
    """Near it SuperLU would go on for minutes."""
    run = subprocess.run([sys.executable, "-c", LIMITED], check=True, capture_output=True, text=True)
    seconds, refusal = run.stdout.split(" ", 1)
    assert float(seconds) < 1.0
    assert re.search(r"needs some 0\.\d+ GB of memory, 0\.[23]\d* GB are available; allowed: up to cells_per", refusal)
