"""The analyses by name, without loading any: those of this folder, and those declared while the program runs.

An analysis stands in the file of its name, under the decorator of `declaration.py`. Its help text is read from the
source, so that listing all of them costs a few milliseconds.
"""

from __future__ import annotations

import ast
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from petalfoil.analysis.declaration import Analysis

MARK = "\n@analysis("
_DECLARED: dict[str, Analysis] = {}


def summaries() -> dict[str, str]:
    """First line of the help text of every analysis, by name."""
    declared = {verb: analysis.summary for verb, analysis in _DECLARED.items()}
    return dict(sorted({**_written(), **declared}.items()))


def find(verb: str) -> Analysis | None:
    """The analysis of a name; None where there is none."""
    if verb not in _DECLARED and verb in _written():
        import_module(f"petalfoil.analysis.{verb}")
    return _DECLARED.get(verb)


def register(analysis: Analysis) -> None:
    """Make an analysis known under its name."""
    _DECLARED[analysis.verb] = analysis


def forget(verb: str) -> None:
    """Undo `register`."""
    _DECLARED.pop(verb, None)


@cache
def _written() -> dict[str, str]:
    """Names and first lines of the analyses in this folder."""
    found = {}
    for path in Path(__file__).parent.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        if MARK in text:
            found[path.stem] = _summary(text, path.stem)
    return found


def _summary(text: str, name: str) -> str:
    functions = [node for node in ast.parse(text).body if isinstance(node, ast.FunctionDef) and node.name == name]
    return (ast.get_docstring(functions[0]) or "").partition("\n")[0] if functions else ""
