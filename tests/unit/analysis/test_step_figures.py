"""Figures of the steps of a motion."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from petalfoil.analysis import trace
from petalfoil.analysis.orbit_motion import follow
from petalfoil.analysis.release import OrbitRequest
from petalfoil.analysis.trace import FRAMES, StepFigures
from petalfoil.dynamics.speed_schedule import Schedule
from tests.cases import case


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


@pytest.mark.parametrize("contacts", ["points", "nodes"])
def test_results_of_many_steps_at_once_are_those_of_each(contacts: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """All histories, and the energy-balance error, whose terms come from one step and the next."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": 8, "model.contacts": contacts, "rotor.mass": 3.0})
    request = OrbitRequest(revolutions=0.2, initial=(0.0, -315e-6))
    monkeypatch.setattr(trace, "AT_ONCE", 1)
    each = follow(bearing, request)
    monkeypatch.setattr(trace, "AT_ONCE", 200)  # three steps of 8 petals with 9 nodes
    many = follow(bearing, request)
    assert len(each.coords["time"]) > 4
    for name in trace.AS_THEY_ARE:
        values = np.asarray(each.fields[name])
        assert_allclose(many.fields[name], values, rtol=1e-12, atol=1e-13 * np.abs(values).max(), err_msg=name)
    for name in ("energy_balance_error", "mass_balance_error"):
        assert many.scalars[name] == pytest.approx(each.scalars[name], rel=1e-6)


def test_speeds_and_angles_between_knots() -> None:
    """Straight lines through the knots and their exact integral, constant speeds before and behind."""
    schedule = Schedule.through([(1.0, 10.0), (2.0, 30.0), (4.0, 0.0)])
    fine = np.linspace(-1.0, 6.0, 70001)
    speeds = np.array([schedule.speed(t) for t in fine])
    assert_allclose(speeds, np.interp(fine, schedule.times, schedule.speeds), rtol=1e-13, atol=1e-12)
    turned = np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(fine))
    angles = np.array([schedule.angle(t) for t in fine])
    assert_allclose(angles[1:] - angles[0], turned, rtol=1e-9, atol=1e-9)
    assert schedule.angle(0.0) == 0.0
    assert [schedule.acceleration(t) for t in (0.5, 1.0, 1.5, 2.0, 4.0, 5.0)] == [0.0, 20.0, 20.0, -15.0, 0.0, 0.0]
