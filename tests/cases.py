"""Cases and their TOML tables, for tests of whatever reads one."""

import copy
import tomllib
from pathlib import Path
from typing import Any

from petalfoil.case import Case

EXAMPLES = Path(__file__).parents[1] / "examples"
FAULTS = Path(__file__).parent / "faults"
"""Small cases that were once answered wrongly, or not at all."""


def tables(name: str = "paper_n8") -> dict[str, Any]:
    """Return the tables of one of the examples, free to change."""
    return tomllib.loads((EXAMPLES / f"{name}.toml").read_text(encoding="utf-8"))


def case(name: str = "paper_n8", **changes: object) -> Case:
    """Return one of the examples, with changes by dotted path."""
    return Case.load(EXAMPLES / f"{name}.toml").replace(**changes)


def put(data: dict[str, Any], path: str, value: object) -> dict[str, Any]:
    """Return a copy of nested tables with `value` at a dotted path; `DELETE` removes the entry."""
    copied = copy.deepcopy(data)
    *parents, name = path.split(".")
    table = copied
    for parent in parents:
        table = table.setdefault(parent, {})
    if value is DELETE:
        del table[name]
    else:
        table[name] = value
    return copied


DELETE = object()
