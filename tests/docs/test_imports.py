"""Scripts beside the package import what it has: those of the documentation run only when the site is built."""

from __future__ import annotations

import ast
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.docs.texts import ROOT

OTHER_STATES = {"former_tasks.py"}
"""Runs in the sources of earlier states too, whose names it tries."""

SCRIPTS = [
    path
    for folder in ("docs/_ext", "examples", "benchmarks")
    for path in sorted((ROOT / folder).rglob("*.py"))
    if path.name not in OTHER_STATES
]


def imported(path: Path) -> set[tuple[str, str]]:
    """Modules of petalfoil and the names that a script takes from them."""
    tree = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    froms = [node for node in tree if isinstance(node, ast.ImportFrom) and node.module]
    return {(str(node.module), name.name) for node in froms for name in node.names}


def exists(module: str, name: str) -> bool:
    """Whether a module has a name, or a module of that name inside."""
    return hasattr(import_module(module), name) or find_spec(f"{module}.{name}") is not None


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_what_a_script_imports_is_there(path: Path) -> None:
    names = {(module, name) for module, name in imported(path) if module.split(".")[0] == "petalfoil"}
    assert [f"{module}.{name}" for module, name in sorted(names) if not exists(module, name)] == []
