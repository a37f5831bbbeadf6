"""The texts of the repository, and the code they speak of, as tests read them."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCE = ROOT / "src" / "petalfoil"
DOCS = ROOT / "docs"

Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef

LABEL = r"[A-Z]\d{1,2}"


@cache
def text(path: Path) -> str:
    """Contents of a file."""
    return path.read_text(encoding="utf-8")


@cache
def tree(path: Path) -> ast.Module:
    """Syntax tree of a module."""
    return ast.parse(text(path), str(path))


def modules() -> list[Path]:
    """Every module of the package."""
    return sorted(SOURCE.rglob("*.py"))


def pages() -> list[Path]:
    """Every page of the documentation, and the guide for contributors."""
    return [ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md"))]


def name_of(path: Path) -> str:
    """Path from the root of the repository, to tell tests apart."""
    return path.relative_to(ROOT).as_posix()


def definitions(node: Documented, owner: str = "") -> Iterator[tuple[str, ast.ClassDef | ast.FunctionDef]]:
    """Public classes, functions and methods of a module with their dotted names."""
    for child in node.body:
        if isinstance(child, ast.ClassDef | ast.FunctionDef) and not child.name.startswith("_"):
            yield owner + child.name, child
            if isinstance(child, ast.ClassDef):
                yield from definitions(child, f"{owner}{child.name}.")


def docstrings(path: Path) -> Iterator[str]:
    """Docstrings of a module and of all it defines."""
    for node in ast.walk(tree(path)):
        if isinstance(node, Documented):
            found = ast.get_docstring(node)
            if found:
                yield found


def theory_labels() -> list[str]:
    """Labels of the equations of `docs/theory.md`, in order."""
    return re.findall(rf"\\tag{{({LABEL})}}", text(DOCS / "theory.md"))


def labels_in(words: str) -> set[str]:
    """Equation labels that a text quotes: "(F1)", "(C1)–(C3)", "(`docs/theory.md`, S1-S3)", "[theory, P5](…)"."""
    found = set(re.findall(rf"\(({LABEL})\)", words))
    for named in re.findall(r"theory(?:\.md`?)?, ([^)\]]*)[)\]]", words):
        found |= set(re.findall(rf"\b{LABEL}\b", named))
    return found
