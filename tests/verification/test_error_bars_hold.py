"""Error bars contain what a fine grid gives: at least 95 % of them, on twenty random bearings."""

import numpy as np
import pytest

import petalfoil
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from tests.random_packs import random_case

NAMES = ("bearing_force", "min_film_thickness", "peak_pressure", "friction_torque", "max_bending_stress")
BEARINGS, SEEDS, FINE = 20, 40, 512

ROUNDING = 1e-9
"""Relative difference that is rounding: a film that stands on the contact film thickness has no bar."""


def solved(bearing: Case, **options: bool) -> Record | None:
    """The answer on a grid; None where there is none, as for a few of the random bearings."""
    try:
        return petalfoil.solve.record(bearing, **options)
    except ConvergenceError:
        return None


@pytest.mark.long
def test_nineteen_of_twenty_bars_hold_on_random_bearings() -> None:
    held: list[bool] = []
    seeds = iter(range(SEEDS))
    for _ in range(BEARINGS):
        record = fine = None
        while record is None or fine is None or not record.errors:
            bearing = random_case(np.random.default_rng(1000 + next(seeds)))
            record = solved(bearing.replace(**{"model.cells_per_pitch": 64}), error=True)
            fine = solved(bearing.replace(**{"model.cells_per_pitch": FINE}))
        for name in NAMES:
            value, there = float(record.scalars[name]), float(fine.scalars[name])
            held.append(abs(value - there) <= record.errors[name] + ROUNDING * abs(there))
    assert len(held) == BEARINGS * len(NAMES)
    assert np.mean(held) >= 0.95
