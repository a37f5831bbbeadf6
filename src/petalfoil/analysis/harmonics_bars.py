"""What harmonics of slips leave of the error bars of petals that rub at an amplitude (E22).

A result `f` tells as `f_harmonics_change` by how much it differs from that with half as many harmonics; nan with one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.grid_study import of_one_size
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS

Array = NDArray[np.float64]

BY_HARMONICS = 1.25
"""Part of a bar that comes from the harmonics of slips, over what half as many change. That halves with each doubling,
so that what is left is about as large; with 1 one of 80 bars of two bearings at five amplitudes is 15 % short."""


def is_matrix(name: str) -> bool:
    """Whether a field holds matrices over directions, whose bars are of one size."""
    return FIELDS[name].dims[-2:] == ("row", "column")


def harmonics_bar(name: str, record: Record) -> Array | None:
    """Part of the error bar of a field that comes from harmonics; None where it has no slips."""
    change = record.fields.get(f"{name}_harmonics_change")
    if change is None:
        return None
    size = np.abs(change.astype(np.float64))
    return BY_HARMONICS * (of_one_size(size) if is_matrix(name) else size)
