"""A film without ends fills and empties in all of its cells (F6d)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.tr_bdf2 import gained
from petalfoil.system.film_rows import ALONE
from petalfoil.system.time_step import StepProblem
from tests.cases import case
from tests.fuzz_verbs import drawn


def begun(number: int) -> Orbit:
    """The motion of a random bearing that ended when one cell had given all its gas for the others."""
    bearing, arguments = drawn(number, 20)
    return Orbit.begin(bearing, OrbitRequest(revolutions=0.1, load=arguments["load"]))


def test_a_cell_gains_for_all_others_in_small_motions_alone() -> None:
    """Up to a tenth of its gas in a unit of time the one cell has all; far beyond, every cell its part by its gas."""
    changes = {"model.cells_per_pitch": 8, "model.edges": "continuous", "rotor.mass": 3.0}
    orbit = Orbit.begin(case("paper_n8", **changes), OrbitRequest(revolutions=1.0, initial=(1e-6, -315e-6)))
    problem, m = orbit.system.problem, orbit.start.moving.stored
    assert isinstance(problem, StepProblem)
    inventory = problem.layout.film_rows.inventory
    assert inventory is not None
    own = m[0] / inventory.filling - m[1:].sum()
    rates = np.zeros_like(m)
    for sign in (1.0, -1.0):
        rates[0] = sign * ALONE * own * inventory.filling
        assert np.array_equal(problem.filled(m, 0.999 * rates), np.zeros_like(m))
        parts = problem.filled(m, 1e6 * rates)
        assert_allclose(parts[1:] / m[1:], 1e6 * rates[0] / m[0], rtol=2e-6)
        left = 1e6 * rates[0] / inventory.filling - parts.sum()  # what the one cell has of it
        assert left / own == pytest.approx(1e6 * rates[0] / m[0] + sign * ALONE, rel=1e-5)
        assert problem.filled(m, 2.0 * rates)[1:].sum() == pytest.approx(
            sign * ALONE * own * (1.0 - own / m[1:].sum()), rel=0.05
        )


@pytest.mark.slow
def test_stages_store_what_flows_in_and_the_part_of_each_cell() -> None:
    """Parts of the latest two instants go on in a straight line; what a stage stores is its flows and these parts."""
    orbit, problem = begun(158), None
    options = MarchOptions(tolerance=1e-7, first=1e-3, longest=1e-3, fixed=True)
    with orbit.run.active():
        before, last = list(march(orbit.system, orbit.start, 0.1, options))[-2:]
    now, problem = last.end, orbit.system.problem
    assert isinstance(problem, StepProblem)
    there = problem.at(displacement=now.e, bearing_number=orbit.system.rotor.bearing_number(now.tau))
    flows = -there.layout.film_rows.at(there.pressure(now.x), there.film(now.x), there.bearing_number).residual
    parts = gained(orbit.system, [before.end, last.inner], now.tau)
    assert parts is not None
    size = float(np.abs(parts).max())
    assert size > 0.0
    assert_allclose(now.change.stored[1:], (parts + flows)[1:], rtol=0.0, atol=1e-3 * size)
    assert_allclose(parts, problem.filled(now.moving.stored, now.change.stored), rtol=0.0, atol=0.1 * size)
    one = problem.filled(before.end.moving.stored, before.end.change.stored)
    assert_allclose(gained(orbit.system, [before.end], 1.0), one, rtol=1e-13)


def test_a_film_with_ends_gains_through_them() -> None:
    """There is nothing to share."""
    orbit = Orbit.begin(case("orbit_n8", **{"model.cells_per_pitch": 8}), OrbitRequest(revolutions=1.0))
    assert gained(orbit.system, [orbit.start], 0.0) is None


@pytest.mark.slow
@pytest.mark.parametrize("number", [91, 103, 158, 171])
def test_a_fast_motion_does_not_drain_a_cell(number: int) -> None:
    """The motion goes on to its end, and no gas is lost."""
    orbit = begun(number)
    for _ in orbit.advance():
        pass
    assert orbit.record().scalars["mass_balance_error"] < 1e-2
    assert orbit.trace.rows[-1]["shaft_angle"] == pytest.approx(0.2 * np.pi)
