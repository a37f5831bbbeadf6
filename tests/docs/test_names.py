"""A name of the code has one meaning in the whole package."""

from __future__ import annotations

import ast
from collections import defaultdict

from tests.docs.texts import SOURCE, tree

VERBS = {"reproduce"}
"""Files that may be called alike in two folders: each does, in its folder, what its name says."""


def test_a_class_name_occurs_once() -> None:
    places = defaultdict(list)
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(tree(path)):
            if isinstance(node, ast.ClassDef):
                places[node.name].append(str(path.relative_to(SOURCE)))
    assert len(places) > 300  # the walk has found the package
    assert {name: where for name, where in places.items() if len(where) > 1} == {}
    assert sorted(places.keys() & _aliases()) == []  # nor is it that of another kind of type


def _aliases() -> set[str]:
    """Names of types and annotations that modules give a short name."""
    names = set()
    for path in SOURCE.rglob("*.py"):
        for node in tree(path).body:
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            names |= {target.id for target in targets if isinstance(target, ast.Name)}
    return names


def test_a_file_name_occurs_in_one_folder() -> None:
    places = defaultdict(list)
    for path in SOURCE.rglob("*.py"):
        places[path.stem].append(str(path.relative_to(SOURCE)))
    assert len(places) > 300
    assert {name: where for name, where in places.items() if len(where) > 1 and name not in VERBS | {"__init__"}} == {}
