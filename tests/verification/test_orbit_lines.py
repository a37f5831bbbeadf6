"""Motions in 3-D with contact lines between nodes: slopes of equilibria, balances, touching down and lifting off."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.analysis.impedance import elastic_and_sliding, impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.orbit import orbit
from petalfoil.analysis.orbit_motion import Orbit, follow
from petalfoil.analysis.release import OrbitRequest
from petalfoil.analysis.stability import stability
from petalfoil.analysis.trace import Trace
from petalfoil.case import Case
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.tr_bdf2 import take_step
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import ON_LINES
from petalfoil.errors import UsageError
from petalfoil.results.record import Record
from tests.cases import case
from tests.verification.test_orbit import WEIGHT, measured_impedance, under


def on_grid(cells: int, axial: int, name: str = "paper_n8_spatial", **changes: object) -> Case:
    """The paper's petals in 3-D, without friction between them."""
    grid = {"model.kind": "3d", "model.cells_per_pitch": cells, "model.axial_cells": axial}
    return case(name, **{**grid, "surface.petal_friction": 0.0, **changes})


@pytest.mark.long
@pytest.mark.parametrize("grid", [(16, 8), (32, 12)])
def test_forced_orbits_give_back_stiffness_and_damping_on_lines(grid: tuple[int, int]) -> None:
    """Small amplitudes: K to 1e-5 and C to 1 % of their size, where contacts at nodes are 4 and 13 % away on 16 x 8."""
    loaded, _ = under(on_grid(*grid, **{"model.axial_density": "uniform"}), 3.0, 3.0 * WEIGHT)
    omega = loaded.operation.speed
    modes = np.asarray(stability.record(loaded, mass=3.0).fields["natural_frequency"])
    course = OrbitRequest(revolutions=20.0, initial="balance", tolerance=1e-6, longest=0.1)
    found = measured_impedance(loaded, 0.01, omega, course, [float(f) for f in modes if f < 0.2 * omega])
    with running():
        motion, _ = elastic_and_sliding(loaded, operating_point(loaded, None).answer)
        K, C = impedance(motion, omega, omega)
    assert motion.contact_model == ON_LINES
    assert np.max(np.abs(found.real - K)) <= 1e-5 * np.max(np.abs(K))
    assert np.max(np.abs(found.imag / omega - C)) <= 1e-2 * np.max(np.abs(C))


def up_and_down(bearing: Case) -> Record:
    """From rest on its petals a light rotor is run up, and down."""
    ramp = ((0.0, 0.0), (10e-3, 2000.0), (20e-3, 100.0))
    return follow(bearing, OrbitRequest(speeds=ramp, initial="balance"))


@pytest.mark.slow
def test_a_ramp_lifts_off_and_a_rotor_comes_down_again() -> None:
    """Contact lines all the way, no step without an answer, and energy balanced as well as with contacts at nodes.

    Gaps that close between nodes gain contacts there: where only those at nodes did, 1e-2 of the energy was missing.
    """
    bearing = on_grid(16, 8, rotor={"mass": 1.0}, **{"operation.load": (0.0, -15.0)})
    record = up_and_down(bearing)
    share = np.asarray(record.fields["contact_fraction"])
    assert share[0] > 0.9
    assert share.min() < 0.01
    assert share[-1] > 0.5
    assert record.scalars["failed_steps"] == 0
    assert record.scalars["contact_model"] == ON_LINES
    assert record.scalars["point_share"] == 1.0
    assert float(str(record.scalars["energy_balance_error"])) <= 1e-4
    assert float(str(record.scalars["residual"])) <= 1e-3


@pytest.mark.slow
def test_a_thrown_journal_keeps_contact_lines() -> None:
    """Released off its balance with an unbalance of 30 um: stretches of contacts recede to points, which travel."""
    thrown = on_grid(16, 8, rotor={"mass": 3.0, "unbalance": 30e-6})
    record = follow(thrown, OrbitRequest(revolutions=1.0, initial=(0.0, -400e-6)))
    assert record.scalars["contact_model"] == ON_LINES
    assert int(str(record.scalars["failed_steps"])) <= 1
    assert float(str(record.scalars["energy_balance_error"])) <= 1e-3
    assert float(str(record.scalars["residual"])) <= 1e-3


@pytest.mark.slow
def test_a_swing_depends_less_on_the_grid_than_with_contacts_at_nodes() -> None:
    """Position after a turn off the balance on two grids: both are farther apart with contacts at nodes."""
    apart = {}
    for contacts in ("points", "nodes"):
        ends = []
        for grid in ((12, 6), (24, 6)):
            bearing = on_grid(*grid, rotor={"mass": 3.0}, **{"model.contacts": contacts})
            record = follow(bearing, OrbitRequest(revolutions=1.0, initial=(0.0, -315e-6), tolerance=1e-4))
            ends.append(float(np.asarray(record.fields["y"])[-1]))
        apart[contacts] = abs(ends[1] - ends[0])
    assert apart["points"] < apart["nodes"]


@pytest.mark.slow
def test_motions_pass_from_lines_to_nodes_and_back() -> None:
    """What is left of the energy apart from that of the steps between both is no more than an error of steps."""
    bearing = on_grid(16, 8, rotor={"mass": 3.0})
    motion = Orbit.begin(bearing, OrbitRequest(revolutions=1.0, initial=(0.0, -315e-6)))
    options = MarchOptions(tolerance=1e-4, first=0.01, longest=0.1)
    path = [motion.start]
    with running():
        path += [step.end for step in march(motion.system, path[-1], 0.5, options)]
        assert all(one.lines is not None for one in path)
        first = len(path)
        path += [step.end for step in march(motion.system.at_nodes, path[-1], 1.0, options)]
        assert all(one.lines is None for one in path[first:])
        for _ in range(8):
            back = take_step(motion.system, path[-1:], 0.05, None, StageOptions(accuracy=1e-6))
            assert back is not None
            assert back.end.lines is not None
            path.append(back.end)
    trace = Trace(motion.case, motion.system)
    for instant in path:
        trace.add(instant)
    audits = trace.audits(trace.histories()[1])
    assert audits.contact_model_energy is not None
    assert audits.contact_model_energy > 1e-6
    assert audits.energy_balance_error <= 1e-2


@pytest.mark.slow
def test_a_motion_goes_on_from_its_end_on_the_same_lines() -> None:
    """Halves of a turn end where the whole one does, within its tolerance."""
    bearing = on_grid(16, 8, rotor={"mass": 3.0, "unbalance": 2e-6})
    first = orbit(bearing, initial="balance", revolutions=0.5)
    second = orbit(bearing, restart=first, revolutions=0.5)
    whole = orbit(bearing, initial="balance", revolutions=1.0)
    assert str(second["contact_model"].item()) == ON_LINES
    for name in ("x", "y"):
        assert second[name].values[0] == pytest.approx(first[name].values[-1], rel=1e-12)
        assert second[name].values[-1] == pytest.approx(whole[name].values[-1], abs=1e-8)
    lines = first["last_lines"].to_numpy()
    for place, value in ((0, 1e6), (0, np.nan), (1, 7.0), (-1, -1.0), (len(lines) // 2, np.nan)):
        bad = first.copy(deep=True)
        bad["last_lines"].values[place] = value
        with pytest.raises(UsageError, match=r"no contact lines|out of balance"):
            orbit(bearing, restart=bad, revolutions=0.01)
