"""Compiled loops on disk are those of the sources at hand."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from petalfoil.compiled import compiled, digest, is_on_disk, numba_is_installed
from petalfoil.system import point_tables


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """A module with a constant and a class of the package."""
    digest.cache_clear()
    made = ModuleType("loops_of_a_test")
    made.__file__ = str(tmp_path / "loops.py")
    Path(made.__file__).write_text("LIMIT = 2.0\n", encoding="utf-8")
    made.LIMIT, made.Rows = 2.0, point_tables.PointRows  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, made.__name__, made)
    return made


def digested(module: ModuleType) -> str:
    """Its digest, found anew."""
    digest.cache_clear()
    return digest(module.__name__)


def test_a_digest_follows_all_sources(module: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The module's own file, its constants, and files of classes that it imports."""
    first = digested(module)
    assert digested(module) == first
    module.LIMIT = 3.0  # type: ignore[attr-defined]
    other_constant = digested(module)
    Path(str(module.__file__)).write_text("LIMIT = 3.0\n", encoding="utf-8")
    other_file = digested(module)
    elsewhere = tmp_path / "point_tables.py"
    elsewhere.write_bytes(Path(str(point_tables.__file__)).read_bytes() + b"\n")
    monkeypatch.setattr(point_tables, "__file__", str(elsewhere))
    assert len({first, other_constant, other_file, digested(module)}) == 4


def test_loops_run_with_numba_and_without() -> None:
    """Without it the function is what it was; with it its name has the digest."""

    def doubled(values: np.ndarray) -> np.ndarray:
        return 2.0 * values

    fast = compiled(doubled)
    np.testing.assert_array_equal(fast(np.arange(3.0)), [0.0, 2.0, 4.0])
    assert numba_is_installed() is not (fast is doubled)
    assert (digest(__name__) in doubled.__qualname__) is numba_is_installed()


def test_what_is_on_disk_is_younger_than_its_sources(tmp_path: Path) -> None:
    """Of the function, beside its file, and not of a former state of any source."""
    file, other, cached = tmp_path / "loops.py", tmp_path / "tables.py", tmp_path / "__pycache__"
    cached.mkdir()
    for source in (file, other):
        source.write_text("", encoding="utf-8")
        os.utime(source, (100.0, 100.0))
    assert not is_on_disk(file, "rows", tmp_path)
    index = cached / "loops.rows_0a1b-12.py311.nbi"
    index.write_bytes(b"")
    os.utime(index, (200.0, 200.0))
    assert is_on_disk(file, "rows", tmp_path)
    assert not is_on_disk(file, "row", tmp_path)
    os.utime(other, (300.0, 300.0))
    assert not is_on_disk(file, "rows", tmp_path)


@pytest.mark.skipif(not numba_is_installed(), reason="numba names what it keeps")
def test_numba_names_what_it_keeps_as_it_is_looked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its index files have the names that `is_on_disk` looks for."""
    file = tmp_path / "kept_loops.py"
    file.write_text(
        "from petalfoil.compiled import compiled\n\n\n@compiled\ndef rows(x):\n    return 2.0 * x\n", encoding="utf-8"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    assert not is_on_disk(file, "rows", tmp_path)
    kept = __import__("kept_loops")
    assert kept.rows(2.0) == 4.0
    assert is_on_disk(file, "rows", tmp_path)
