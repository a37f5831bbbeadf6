"""All problems of a definition → one error a user can act on.

Every problem is given with the key's dotted path, what was given, what is allowed, and the nearest known name.
"""

from __future__ import annotations

import re
import typing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from petalfoil.case.hints import nearest_key, nearest_word
from petalfoil.case.number_fields import UNIT_PROBLEM, VALUE_PROBLEM
from petalfoil.errors import DefinitionError, UnitError
from petalfoil.text import for_terminal
from petalfoil.units.reading import shown

MAX_KEY = 60  # longer keys are cut in messages

Location = tuple[int | str, ...]


@dataclass(frozen=True)
class Problem:
    """One thing wrong with a definition."""

    key: str
    text: str  # completes "<key>: …"
    given: object = None
    allowed: str = ""


def joined(problems: Sequence[Problem]) -> str:
    """Write one problem as a line, several as a list."""
    lines = [f"{problem.key}: {problem.text}" if problem.key else problem.text for problem in problems]
    return lines[0] if len(lines) == 1 else "\n".join([f"{len(lines)} problems", *(f"  - {line}" for line in lines)])


def definition_error(error: ValidationError, root: type[BaseModel], section: str = "") -> DefinitionError:
    """Translate pydantic's report on `root`, whose own dotted path is `section`."""
    details = error.errors(include_url=False)
    meant = {key for detail in details for key in _meant(detail, root)}
    told = [detail for detail in details if not (detail["type"] == "missing" and dotted(detail["loc"]) in meant)]
    problems = [_problem(detail, root, section) for detail in told]
    kind = UnitError if all(detail["type"] == UNIT_PROBLEM for detail in details) else DefinitionError
    return refusal(kind, problems)


def refusal(kind: type[DefinitionError], problems: Sequence[Problem]) -> DefinitionError:
    """The error that tells all problems, and what was given and is allowed at the first."""
    first, all_of_them = problems[0], [(problem.key, problem.text) for problem in problems]
    return kind(joined(problems), key=first.key, given=first.given, allowed=first.allowed, problems=all_of_them)


def _problem(detail: ErrorDetails, root: type[BaseModel], section: str) -> Problem:
    location = detail["loc"]
    key = dotted(location, section)
    match detail["type"]:
        case "missing":
            allowed = _allowed(root, location)
            return Problem(key, f"is missing; expected {allowed}", None, allowed)
        case "extra_forbidden":
            return _unknown_key(key, location, root, detail["input"])
        case "enum":
            return _unknown_word(key, detail)
        case kind if kind in (UNIT_PROBLEM, VALUE_PROBLEM):
            return Problem(key, detail["msg"], detail["input"], str(detail.get("ctx", {}).get("allowed", "")))
        case "model_type" | "model_attributes_type" | "dict_type":
            allowed = f"a table [{key}]"
        case "string_type":
            allowed = "a text"
        case "bool_type":
            allowed = "true or false"
        case _:
            allowed = detail["msg"]
    return Problem(key, f"{shown(detail['input'])} is not allowed; expected {allowed}", detail["input"], allowed)


def dotted(location: Location, section: str = "") -> str:
    """Write a location as a path: ``("operation", "load", 1)`` becomes ``"operation.load[1]"``."""
    path = section
    for part in location:
        if isinstance(part, int):
            path += f"[{part}]"
        else:
            name = for_terminal(part if len(part) <= MAX_KEY else f"{part[:MAX_KEY]}…")
            path += f".{name}" if path else name
    return path


def _unknown_key(key: str, location: Location, root: type[BaseModel], given: object) -> Problem:
    owner = _model_at(root, location[:-1])
    known = ", ".join([] if owner is None else owner.model_fields)
    parent = dotted(location[:-1])
    hint = nearest_key(str(location[-1]), parent, _paths(root))
    return Problem(key, f"is not a known key; known here: {known}.{hint}", given, known)


def _meant(detail: ErrorDetails, root: type[BaseModel]) -> list[str]:
    """Paths that an unknown key may have been meant for: where one of them is missing, that is one mistake, not two."""
    if detail["type"] != "extra_forbidden":
        return []
    parent = dotted(detail["loc"][:-1])
    hint = nearest_key(str(detail["loc"][-1]), parent, _paths(root))
    names = re.findall(r"Did you mean '([^']*)'", hint)
    return [*names, *(f"{parent}.{name}" for name in names)]


def _unknown_word(key: str, detail: ErrorDetails) -> Problem:
    allowed = str(detail.get("ctx", {}).get("expected", ""))
    hint = nearest_word(detail["input"], re.findall(r"'([^']*)'", allowed))
    text = f"{shown(detail['input'])} is not a known choice; allowed: {allowed}.{hint}"
    return Problem(key, text, detail["input"], allowed)


def _allowed(root: type[BaseModel], location: Location) -> str:
    owner = _model_at(root, location[:-1])
    field = None if owner is None else owner.model_fields.get(str(location[-1]))
    if field is None:
        return "a value"
    for declared in field.metadata:
        if hasattr(declared, "allowed"):
            return str(declared.allowed)
    kind = field.annotation
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return f"a table [{location[-1]}]"
    if isinstance(kind, type) and issubclass(kind, StrEnum):
        return " or ".join(repr(choice.value) for choice in kind)
    return "a value"


def _model_at(root: type[BaseModel], location: Location) -> type[BaseModel] | None:
    model: type[BaseModel] | None = root
    for part in location:
        model = None if model is None else _nested(model.model_fields).get(str(part))
    return model


def _nested(fields: Mapping[str, Any]) -> dict[str, type[BaseModel]]:
    found = {}
    for name, field in fields.items():
        for candidate in (field.annotation, *typing.get_args(field.annotation)):
            if isinstance(candidate, type) and issubclass(candidate, BaseModel):
                found[name] = candidate
    return found


def _paths(root: type[BaseModel]) -> list[str]:
    """Dotted paths of all tables and keys."""
    inner = [
        f"{section}.{name}" for section, model in _nested(root.model_fields).items() for name in model.model_fields
    ]
    return [*root.model_fields, *inner]
