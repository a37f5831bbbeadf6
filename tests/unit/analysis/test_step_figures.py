"""Figures of the steps of a motion."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from petalfoil.analysis.trace import FRAMES, StepFigures


def filled(count: int) -> StepFigures:
    """Steps `k` with the figures `k` and `k**2`."""
    rows = StepFigures()
    for k in range(count):
        rows.append({"square": float(k**2), "number": float(k)} if k % 2 else {"number": float(k), "square": k**2})
    return rows


@pytest.mark.parametrize("count", [1, FRAMES, FRAMES + 1, 5 * FRAMES])
def test_steps_come_back_as_they_were(count: int) -> None:
    rows = filled(count)
    assert len(rows) == count
    assert rows[0] == {"number": 0.0, "square": 0.0}
    assert rows[-1] == {"number": count - 1.0, "square": (count - 1.0) ** 2}
    assert_array_equal(rows.column("square"), np.arange(count) ** 2.0)


def test_a_column_does_not_change_with_the_steps_after_it() -> None:
    rows = filled(3)
    before = rows.column("number")
    before[0] = 7.0
    rows.append({"number": 3.0, "square": 9.0})
    assert_array_equal(before, [7.0, 1.0, 2.0])
    assert rows[0]["number"] == 0.0


def test_a_step_beyond_the_last_or_without_a_figure_is_refused() -> None:
    rows = filled(3)
    with pytest.raises(IndexError):
        rows[3]
    with pytest.raises(KeyError):
        rows.append({"number": 3.0})
