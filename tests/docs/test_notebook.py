"""The tutorial that is a notebook runs in a kernel, and what it shows is there: figures, tables, a case."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.docs.texts import ROOT

pytestmark = pytest.mark.slow

jupytext = pytest.importorskip("jupytext", reason="needs petalfoil[docs]")
nbclient = pytest.importorskip("nbclient", reason="needs petalfoil[docs]")
pytest.importorskip("ipykernel", reason="needs petalfoil[docs]")

NOTEBOOK = ROOT / "examples" / "notebooks" / "first_bearing.py"
LONGEST = 300.0
"""Time of a cell on a machine that others use [s]."""


@pytest.fixture
def kernel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A kernel of this Python, and of no other that is installed."""
    folder = tmp_path / "kernels" / "here"
    folder.mkdir(parents=True)
    command = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    (folder / "kernel.json").write_text(json.dumps({"argv": command, "display_name": "here", "language": "python"}))
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    return "here"


def test_the_notebook_runs_and_shows_figures_tables_and_a_case(kernel: str) -> None:
    notebook = jupytext.read(NOTEBOOK)
    nbclient.NotebookClient(
        notebook, timeout=LONGEST, kernel_name=kernel, resources={"metadata": {"path": str(NOTEBOOK.parent)}}
    ).execute()
    shown: list[dict[str, Any]] = [
        output.get("data", {"text/plain": output.get("text", "")})
        for cell in notebook.cells
        if cell.cell_type == "code"
        for output in cell.outputs
    ]
    pages = [one["text/html"] for one in shown if "text/html" in one]
    assert sum("image/png" in one for one in shown) == 2
    assert any("petals.thickness" in page for page in pages)
    assert any("minimum film thickness" in page for page in pages)
    assert any("minimum film thickness" in one["text/plain"] and "±" in one["text/plain"] for one in shown)
