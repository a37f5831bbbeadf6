"""A name of the code has one meaning in the whole package."""

from __future__ import annotations

import re
from collections import defaultdict

from tests.docs.texts import SOURCE, text

VERBS = {"reproduce"}
"""Files that may be called alike in two folders: each does, in its folder, what its name says."""

CLASS = re.compile(r"^ *class (\w+)[(:]", re.MULTILINE)
ALIAS = re.compile(r"^([A-Z]\w*)(?:: [\w.]+)? = ", re.MULTILINE)
"""A type, an annotation of an argument or a constant that a module gives a name."""


def test_a_class_name_occurs_once() -> None:
    places, aliases = defaultdict(list), set()
    for path in SOURCE.rglob("*.py"):
        aliases |= set(ALIAS.findall(text(path)))
        for name in CLASS.findall(text(path)):
            places[name].append(str(path.relative_to(SOURCE)))
    assert len(places) > 300  # the search has found the package
    assert {"Load", "Array"} <= aliases
    assert {name: where for name, where in places.items() if len(where) > 1} == {}
    assert sorted(places.keys() & aliases) == []


def test_a_file_name_occurs_in_one_folder() -> None:
    places = defaultdict(list)
    for path in SOURCE.rglob("*.py"):
        places[path.stem].append(str(path.relative_to(SOURCE)))
    assert len(places) > 300
    assert {name: where for name, where in places.items() if len(where) > 1 and name not in VERBS | {"__init__"}} == {}
