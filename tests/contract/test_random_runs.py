"""The script of random bearings for every verb tells what it is there to find."""

from __future__ import annotations

from typing import NoReturn

import pytest

from petalfoil.analysis.known_verbs import summaries
from petalfoil.errors import UsageError
from petalfoil.studies.run import KINDS
from tests.fuzz_verbs import GIVEN, OF_MANY, RUNS, in_rounds, ran


def test_every_verb_is_run() -> None:
    assert set(GIVEN) == set(summaries())
    assert set(OF_MANY) == {*KINDS, "report"} - {"sobol"}
    assert set(RUNS) == {*GIVEN, *OF_MANY}
    runs = list(in_rounds(0, 60, ["check", "solve"]))
    assert len(set(runs)) == len(runs) == 120


def mistaken(*_: object) -> NoReturn:
    raise KeyError("speed")


def refused(*_: object) -> NoReturn:
    raise UsageError("no such argument")


def endless(*_: object) -> NoReturn:
    while True:
        pass


@pytest.mark.parametrize(
    ("run", "outcome", "text"),
    [(mistaken, "UNTYPED", "KeyError"), (refused, "UsageError", "no such argument"), (endless, "slow", "")],
)
def test_what_becomes_of_a_run(run: object, outcome: str, text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(RUNS, "check", run)  # type: ignore[arg-type]
    done = ran(1, "check", 0.05)
    assert done.outcome == outcome
    assert text in done.text
