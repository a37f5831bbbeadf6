"""A name of the code has one meaning in the whole package."""

from __future__ import annotations

import ast
from collections import defaultdict

from tests.docs.texts import SOURCE, tree


def test_a_class_name_occurs_once() -> None:
    places = defaultdict(list)
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(str(path.relative_to(SOURCE)))
    assert len(places) > 300  # the walk has found the package
    assert {name: where for name, where in places.items() if len(where) > 1} == {}
