"""The texts below the attributes of a definition, read from its source where a list of keys asks for them.

Pydantic reads them too (`use_attribute_docstrings`), but of every class as it is made: a third of the time that a case
takes to load.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from functools import cache
from itertools import pairwise

from petalfoil.case.definition import Definition


@cache
def attribute_texts(definition: type[Definition]) -> dict[str, str]:
    """Texts below the attributes of a definition and of those it is derived from, by name."""
    found: dict[str, str] = {}
    for kind in reversed(definition.__mro__):
        if issubclass(kind, Definition):
            found |= dict(_own(kind))
    return found


def _own(kind: type) -> list[tuple[str, str]]:
    """Names and texts of the attributes of one class; none of a class typed at a prompt, which has no source."""
    try:
        source = inspect.getsource(kind)
    except (OSError, TypeError):
        return []
    (written,) = ast.parse(textwrap.dedent(source)).body
    assert isinstance(written, ast.ClassDef)
    return [
        (line.target.id, inspect.cleandoc(below.value.value))
        for line, below in pairwise(written.body)
        if isinstance(line, ast.AnnAssign)
        and isinstance(line.target, ast.Name)
        and isinstance(below, ast.Expr)
        and isinstance(below.value, ast.Constant)
        and isinstance(below.value.value, str)
    ]
