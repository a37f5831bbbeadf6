"""The documentation site as tests see it: its tables of contents, its gallery."""

from __future__ import annotations

import re
from pathlib import Path

from tests.docs.texts import DOCS, ROOT, text

GALLERY = sorted((ROOT / "examples" / "gallery").glob("plot_*.py"))
TOCTREE = re.compile(r"^```\{toctree\}\n(.*?)^```", re.MULTILINE | re.DOTALL)


def listed() -> set[Path]:
    """Pages that stand in a table of contents."""
    found = set()
    for page in DOCS.rglob("*.md"):
        for tree in TOCTREE.findall(text(page)):
            entries = [line for line in tree.splitlines() if line and not line.startswith(":")]
            found |= {path.resolve() for entry in entries for path in page.parent.glob(f"{entry}.md")}
    return found
