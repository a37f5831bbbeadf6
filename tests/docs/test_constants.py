"""Numbers of the pages are those of the code: "1e-8 (`RESIDUAL_TOLERANCE`)" is compared with the constant of that name.

A constant is named as in its module (`SUSPECT`), with its module where several have one of that name
(`liftoff.PRECISION`), or as a field of a class of options (`InteriorOptions.near`). Several numbers before a name are
the values of a sequence, or its first and last.
"""

from __future__ import annotations

import ast
import dataclasses
import importlib
import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.docs.texts import ROOT, SOURCE, modules, name_of, pages, text, tree

NAME = r"(?:[a-z_]+\.)?[A-Z][A-Z0-9]*_[A-Z0-9_]+|[a-z_]+\.[A-Z][A-Z0-9_]+|[A-Z]{3,}|[A-Z]\w+\.[a-z_]+"
MARKER = re.compile(rf"(?P<before>[^`|]{{0,120}}?)\s\(`(?P<name>{NAME})`\)")
NUMBER = re.compile(r"(?<![\w.^{])\d+(?:\.\d+)?(?:e[+-]?\d+)?")
SEQUENCE = re.compile(rf"{NUMBER.pattern}(?:(?:,| and|, then| to| or)\s{NUMBER.pattern})*(?=[^\d]*$)")

Value = float | tuple[float, ...]


def markers(words: str) -> Iterator[tuple[str, tuple[float, ...]]]:
    """Name of each marked constant with the numbers in front of it."""
    for hit in MARKER.finditer(" ".join(words.split())):
        shown = SEQUENCE.search(hit["before"])
        if shown is None:
            yield hit["name"], ()
            continue
        factor = 1e-2 if hit["before"][shown.end() :].lstrip().startswith("%") else 1.0
        yield hit["name"], tuple(float(number) * factor for number in NUMBER.findall(shown.group()))


def defined(node: ast.stmt) -> Iterator[str]:
    """Names of the constants or the class that a statement at the top of a module defines."""
    if isinstance(node, ast.ClassDef):
        yield node.name
    targets = [node.target] if isinstance(node, ast.AnnAssign) else node.targets if isinstance(node, ast.Assign) else []
    flat = [item for target in targets for item in (target.elts if isinstance(target, ast.Tuple) else [target])]
    yield from (item.id for item in flat if isinstance(item, ast.Name))


@cache
def homes_of_all() -> dict[str, list[Path]]:
    """Modules that assign a constant or define a class at their top, by its name."""
    found: dict[str, list[Path]] = {}
    for path in modules():
        for name in {name for node in tree(path).body for name in defined(node)}:
            found.setdefault(name, []).append(path)
    return found


def homes(name: str) -> list[Path]:
    """Modules that assign a constant or define a class of this name at their top."""
    return homes_of_all().get(name, [])


def constants(name: str) -> list[Value]:
    """Values of the constants of a name, one for each module that has it."""
    owner, _, last = name.rpartition(".")
    is_class = owner[:1].isupper()
    found: list[Value] = []
    for path in homes(owner if is_class else last):
        if owner and not is_class and path.stem != owner:
            continue
        dotted = ".".join(path.relative_to(SOURCE.parent).with_suffix("").parts)
        module = importlib.import_module(dotted)
        value = field_default(getattr(module, owner), last) if is_class else getattr(module, last)
        found.append(tuple(float(v) for v in np.ravel(value)) if np.ndim(value) else float(value))
    return found


def field_default(owner: type, name: str) -> object:
    """Default of a field of a dataclass."""
    (default,) = (field.default for field in dataclasses.fields(owner) if field.name == name)
    return default


def agree(shown: tuple[float, ...], value: Value) -> bool:
    """Whether the numbers shown are the value, or a sequence, or its first and last."""
    if not isinstance(value, tuple):
        value = (value,)
    options = [value, (value[0], value[-1])]
    return any(len(shown) == len(v) and all(map(close, shown, v)) for v in options)


def close(one: float, other: float) -> bool:
    """Equal but for rounding."""
    return math.isclose(one, other, rel_tol=1e-12)


def wrong_in(words: str) -> Iterator[str]:
    """Every marked constant of a text that is not in the code, or has another value there."""
    for name, shown in markers(words):
        found = constants(name)
        if not found:
            yield f"{name}: no such constant"
        elif len(found) > 1:
            yield f"{name}: {len(found)} modules have one, name the module too"
        elif not agree(shown, found[0]):
            yield f"{name}: {shown} on the page, {found[0]} in the code"


def test_numbers_of_the_pages_are_those_of_the_code() -> None:
    every = [*pages(), ROOT / "README.md"]
    assert sum(len(list(markers(text(path)))) for path in every) > 30
    assert [(name_of(path), wrong) for path in every for wrong in wrong_in(text(path))] == []


@pytest.mark.parametrize(
    "words",
    [
        "at most 1e-7 (`RESIDUAL_TOLERANCE`)",
        "at most 1e-8 (`RESIDUAL_TOLERANCES`)",
        "the tolerance (`RESIDUAL_TOLERANCE`)",
        "a width of 0.2 % (`liftoff.PRECISION`)",
        "a width of 0.1 % (`PRECISION`)",
        "above 0.2 (`InteriorOptions.near`)",
        "in 4, then 15 parts (`SUBSTEPS`)",
    ],
)
def test_another_number_is_seen(words: str) -> None:
    assert len(list(wrong_in(words))) == 1
