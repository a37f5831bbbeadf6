"""What harmonics of slips leave in the error bars of petals that rub at an amplitude (E22).

A result `f` tells as `f_harmonics_change` by how much it differs from that with half as many harmonics; nan with one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.grid_study import of_one_size
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS

Array = NDArray[np.float64]

BY_HARMONICS = 1.25
"""Part of a bar that comes from the harmonics of slips, over what half as many change. That halves with each doubling,
so that what is left is about as large; with 1 one of 80 bars of two bearings at five amplitudes is 15 % short."""


EIGENVALUE = ("natural_frequency", "mode_growth_rate")
"""Parts of one number: neither has a bar by harmonics below the root mean square of both, as one change may be small by
accident."""


def harmonics_bars(record: Record, errors: Mapping[str, float]) -> dict[str, float]:
    """Error bars of results, from those of the grids: with the part of harmonics; without those that it leaves unknown.

    A number has no slips where it tells no change, and an unknown part with one harmonic.
    """
    bars = {name: error + scalar_harmonics_bar(name, record) for name, error in errors.items()}
    return {name: bar for name, bar in bars.items() if not math.isnan(bar)}


def scalar_harmonics_bar(name: str, record: Record) -> float:
    """Part of the error bar of a number that comes from harmonics: 0 without slips, nan with one harmonic."""
    return BY_HARMONICS * abs(float(record.scalars.get(f"{name}_harmonics_change", 0.0)))


def is_matrix(name: str) -> bool:
    """Whether a field holds matrices over directions, whose bars are of one size."""
    return FIELDS[name].dims[-2:] == ("row", "column")


def harmonics_bar(name: str, record: Record) -> Array | None:
    """Part of the error bar of a field that comes from harmonics; None where it has no slips."""
    change = record.fields.get(f"{name}_harmonics_change")
    if change is None:
        return None
    size = np.abs(change.astype(np.float64))
    if name in EIGENVALUE:
        both = [record.fields[f"{part}_harmonics_change"].astype(np.float64) for part in EIGENVALUE]
        size = np.fmax(size, np.sqrt(np.mean(np.square(both), axis=0)))
    return BY_HARMONICS * (of_one_size(size) if is_matrix(name) else size)
