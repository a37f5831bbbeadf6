"""Error bars contain what a fine grid gives: at least 95 % of them, on twenty random bearings each."""

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

import petalfoil
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from tests.random_packs import random_case

NAMES = ("bearing_force", "min_film_thickness", "peak_pressure", "friction_torque", "max_bending_stress")
BEARINGS, SEEDS, FINE = 20, 40, 512

ROUNDING = 1e-9
"""Relative difference that is rounding: a film that stands on the contact film thickness has no bar."""


Ask = Callable[..., Record]


def pairs_of_records(ask: Ask, **options: object) -> Iterator[tuple[Record, Record]]:
    """Answers with error bars on 64 cells, and on a fine grid, of twenty random bearings that have both."""
    found = 0
    for seed in range(SEEDS):
        bearing = random_case(np.random.default_rng(1000 + seed))
        try:
            record = ask(bearing.replace(**{"model.cells_per_pitch": 64}), error=True, **options)
            fine = ask(bearing.replace(**{"model.cells_per_pitch": FINE}), **options)
        except ConvergenceError:
            continue
        if record.errors:
            found += 1
            yield record, fine
        if found == BEARINGS:
            return


@pytest.mark.long
def test_nineteen_of_twenty_bars_hold_on_random_bearings() -> None:
    held: list[bool] = []
    for record, fine in pairs_of_records(petalfoil.solve.record):
        for name in NAMES:
            value, there = float(record.scalars[name]), float(fine.scalars[name])
            if name not in record.errors:  # a film that contact holds is given, on any grid
                assert name == "min_film_thickness"
                assert value == pytest.approx(there, rel=ROUNDING)
                continue
            held.append(abs(value - there) <= record.errors[name] + ROUNDING * abs(there))
    assert len(held) >= BEARINGS * (len(NAMES) - 1)
    assert np.mean(held) >= 0.95


@pytest.mark.long
@pytest.mark.parametrize("name", ["stiffness", "damping"])
def test_bars_of_stiffness_and_damping_hold_on_random_bearings(name: str) -> None:
    held: list[NDArray[np.bool_]] = []
    for record, fine in pairs_of_records(petalfoil.coefficients.record):
        value, there, bar = record.fields[name], fine.fields[name], record.fields[f"{name}_error"]
        held.append(np.abs(value - there).ravel() <= bar.ravel() + ROUNDING * np.max(np.abs(there)))
    assert len(held) == BEARINGS
    assert np.mean(held) >= 0.95
