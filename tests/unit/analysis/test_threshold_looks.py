"""Looks of the search for a threshold speed: several factors ahead where whirls are far, and to the same bracket."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from petalfoil.analysis.threshold import FACTOR, FARTHEST, NEVER, factors_ahead, looked_ahead


@dataclass
class Margin:
    """A margin over speed that tells where it is far from whirling."""

    changes: float
    factors: int
    last: float = 1.0
    unstable: float = math.inf
    looks: list[float] = field(default_factory=list)

    def __call__(self, speed: float) -> float:
        self.looks.append(self.last)
        self.last = speed
        return NEVER if speed < self.changes else -1.0


def walked(margin: Any, end: float) -> tuple[float, float, int]:
    """The last speed at which the rotor is stable, the one after it, and the number of looks."""
    known = 1.0
    while True:
        ahead, there = looked_ahead(margin, known, FACTOR, (1.0, end))
        if there < 0.0:
            return known, ahead, len(margin.looks)
        known = ahead


@pytest.mark.parametrize("ahead", [2, 3])
@pytest.mark.parametrize("factors", [0.5, 1.5, 2.5, 4.5, 5.5, 7.5])
def test_the_bracket_is_that_of_looks_one_by_one(factors: float, ahead: int) -> None:
    """However many factors ahead; one look is in vain, and all from the last stable speed on are made."""
    far, near = (walked(Margin(FACTOR**factors, one), FACTOR**11) for one in (ahead, 1))
    assert far[:2] == pytest.approx(near[:2], rel=1e-12)
    assert far[2] <= near[2] / ahead + ahead + 1


def test_an_unstable_look_is_no_start_for_the_one_between() -> None:
    """That is followed from the last stable speed."""
    margin: Any = Margin(FACTOR**0.5, FARTHEST)
    looked_ahead(margin, 1.0, FACTOR, (1.0, 9.0))
    assert margin.looks == [1.0, 1.0]


def test_the_last_look_is_within_the_range() -> None:
    """As many factors as are left are taken."""
    margin: Any = Margin(math.inf, FARTHEST)
    for left in (1, 2):
        ahead, _ = looked_ahead(margin, 1.0, FACTOR, (1.0, FACTOR**left * 1.1))
        assert ahead == pytest.approx(FACTOR**left)


@pytest.mark.parametrize(
    ("passed", "left", "ahead"), [(1, 0.9, 3), (1, 0.85, 2), (1, 0.75, 1), (2, 0.75, 3), (3, 0.62, 3), (3, 0.55, 2)]
)
def test_looks_go_as_far_as_two_fifths_of_a_loss_are_foretold_to_go(passed: int, left: float, ahead: int) -> None:
    """Losses fall evenly from look to look; the one that falls most counts, those of no whirl stay without end."""
    before, here = np.array([1e-5, 0.1, np.inf]), np.array([1e-5 * left, 0.2, np.inf])
    assert factors_ahead((1.0, before), (FACTOR**passed, here)) == ahead
