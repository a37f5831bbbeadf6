"""The map of every folder, in the docstring of its `__init__.py`, names each of its files and no other."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.docs.texts import SOURCE, tree

FOLDERS = tuple(sorted(path.parent.name for path in SOURCE.glob("*/__init__.py")))
"""Folders whose maps are checked."""


def mapped(folder: Path) -> set[str]:
    """File names in the first column of a folder's map: `file.py`, ``file`` or `file`, at the start of a line."""
    words = ast.get_docstring(tree(folder / "__init__.py")) or ""
    return {name.removesuffix(".py") for name in re.findall(r"^(?:- )?`{1,2}(\w+(?:\.py)?)`{1,2}", words, re.MULTILINE)}


def files(folder: Path) -> set[str]:
    """Modules and folders in a folder."""
    inside = {path.stem for path in folder.glob("*.py")} | {path.parent.name for path in folder.glob("*/__init__.py")}
    return inside - {"__init__"}


def test_the_map_of_the_verification_names_each_of_its_tests() -> None:
    folder = SOURCE.parents[1] / "tests" / "verification"
    named = set(re.findall(r"^\| `(test_\w+)\.py`", (folder / "README.md").read_text(encoding="utf-8"), re.MULTILINE))
    assert named ^ {path.stem for path in folder.glob("test_*.py")} == set()


@pytest.mark.parametrize("name", FOLDERS)
def test_a_map_names_the_files_of_its_folder(name: str) -> None:
    folder = SOURCE / name
    assert files(folder)
    assert sorted(mapped(folder) ^ files(folder)) == []
