"""Looks of the search for a threshold speed: two factors ahead where whirls are far, and to the same bracket."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import pytest

from petalfoil.analysis.threshold import FACTOR, NEVER, looked_ahead


@dataclass
class Margin:
    """A margin over speed that tells where it is far from whirling."""

    changes: float
    far: bool
    last: float = 1.0
    looks: list[float] = field(default_factory=list)

    @property
    def far_from_whirling(self) -> bool:
        return self.far

    def __call__(self, speed: float) -> float:
        self.looks.append(self.last)
        self.last = speed
        if speed < self.changes:
            return NEVER
        self.far = False
        return -1.0


def walked(margin: Any, end: float) -> tuple[float, float, int]:
    """The last speed at which the rotor is stable, the one after it, and the number of looks."""
    known = 1.0
    while True:
        ahead, there = looked_ahead(margin, known, FACTOR, (1.0, end))
        if there < 0.0:
            return known, ahead, len(margin.looks)
        known = ahead


@pytest.mark.parametrize("factors", [0.5, 1.5, 4.5, 5.5])
def test_the_bracket_is_that_of_looks_one_by_one(factors: float) -> None:
    """Odd or even; no more looks than two in vain."""
    far, near = (walked(Margin(FACTOR**factors, far=one), FACTOR**9) for one in (True, False))
    assert far[:2] == pytest.approx(near[:2], rel=1e-12)
    assert far[2] <= near[2] / 2 + 2


def test_an_unstable_look_is_no_start_for_the_one_between() -> None:
    """That is followed from the last stable speed."""
    margin = Margin(FACTOR**0.5, far=True)
    looked_ahead(margin, 1.0, FACTOR, (1.0, 9.0))  # type: ignore[arg-type]
    assert margin.looks == [1.0, 1.0]


def test_the_last_look_is_within_the_range() -> None:
    """One factor is left: one is taken."""
    ahead, _ = looked_ahead(Margin(math.inf, far=True), 1.0, FACTOR, (1.0, 1.4))  # type: ignore[arg-type]
    assert ahead == FACTOR
