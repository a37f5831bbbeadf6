"""Equilibria of the two hundred random packs, with contacts at nodes."""

from __future__ import annotations

from functools import cache

import numpy as np

from petalfoil.analysis.operating_point import at_position
from petalfoil.case import Case
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.solution import Solution
from petalfoil.system.point_layout import PointLayout
from tests.random_packs import random_case
from tests.verification.test_random_bearings import SEED


def random_pack(number: int, **changes: object) -> Case:
    """One of the two hundred random packs."""
    rng = np.random.default_rng(SEED)
    return [random_case(rng, **changes) for _ in range(number + 1)][number]


@cache
def answer_of(number: int) -> tuple[PointLayout, Solution]:
    """Its elements, and its equilibrium with contacts at nodes."""
    with running():
        answer = at_position(random_pack(number)).answer
    assert answer.problem.layout.elements is not None
    return answer.problem.layout.elements, answer
