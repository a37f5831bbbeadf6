"""Points past a jump: how often others are looked for beside their branch."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from petalfoil.analysis import past_jump
from petalfoil.analysis.operating_point import OperatingPoint
from petalfoil.analysis.past_jump import PastJump
from petalfoil.results.parts import Branch


def test_others_are_looked_for_where_contacts_or_stability_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Once at first, then where a contact or the stability is another; every point tells the last number."""
    found = iter([2, 3, 4])
    monkeypatch.setattr(past_jump, "count", lambda case, answer: next(found))
    monkeypatch.setattr(past_jump, "contacts_of", lambda answer: answer.contacts)
    past, told, case = PastJump(), [], SimpleNamespace()
    for contacts, stable in [("a", True), ("a", True), ("b", True), ("b", True), ("b", False), ("b", False)]:
        answer: Any = SimpleNamespace(contacts=contacts)
        point = past.told(case, OperatingPoint(answer, Branch(stable=stable, solution_path="followed")))  # type: ignore[arg-type]
        told.append(point.branch.known_equilibria)
        assert point.branch.solution_path == "followed, past a jump"
    assert told == [2, 2, 3, 3, 4, 4]
