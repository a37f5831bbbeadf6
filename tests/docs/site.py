"""The documentation site as tests see it: its extensions, its tables of contents, its gallery."""

from __future__ import annotations

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

from tests.docs.texts import DOCS, ROOT, text

GALLERY = sorted((ROOT / "examples" / "gallery").glob("plot_*.py"))
TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.MULTILINE | re.DOTALL)


def extension(name: str) -> ModuleType:
    """A module of `docs/_ext`."""
    spec = importlib.util.spec_from_file_location(name, DOCS / "_ext" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    sys.modules[name] = found  # dataclasses look their module up
    spec.loader.exec_module(found)
    return found


def listed() -> set[Path]:
    """Pages that stand in a table of contents."""
    found = set()
    for page in DOCS.rglob("*.md"):
        for tree in TOCTREE.findall(text(page)):
            entries = [line for line in tree.splitlines() if line and not line.startswith(":")]
            found |= {path.resolve() for entry in entries for path in page.parent.glob(f"{entry}.md")}
    return found
