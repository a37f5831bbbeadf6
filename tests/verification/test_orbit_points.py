"""Motions with contact points between nodes: slopes of equilibria, balances, touching down and lifting off."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from petalfoil.analysis.impedance import elastic_and_sliding, impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.orbit import orbit
from petalfoil.analysis.orbit_motion import Orbit, follow
from petalfoil.analysis.release import OrbitRequest
from petalfoil.analysis.stability import stability
from petalfoil.analysis.trace import Audits, Trace
from petalfoil.case import Case
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.time_state import Instant
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_POINTS
from petalfoil.results.record import Record
from tests.cases import case
from tests.verification.test_orbit import WEIGHT, equal_steps, measured_impedance, petals, under


def on_grid(cells: int) -> Case:
    """The paper's 8 petals."""
    return case("paper_n8", **{"model.cells_per_pitch": cells})


@pytest.mark.long
@pytest.mark.parametrize("cells", [16, 32])
def test_forced_orbits_give_back_stiffness_and_damping_at_points(cells: int) -> None:
    """Small amplitudes: K to 1e-4 and C to 1 % of their size."""
    loaded, start = under(on_grid(cells), 3.0, 3.0 * WEIGHT)
    omega = loaded.operation.speed
    modes = np.asarray(stability.record(loaded, mass=3.0).fields["natural_frequency"])
    course = OrbitRequest(revolutions=20.0, initial=start, tolerance=1e-6, longest=0.1)
    found = measured_impedance(loaded, 0.01, omega, course, [float(f) for f in modes if f < 0.2 * omega])
    with running():
        motion, _ = elastic_and_sliding(loaded, operating_point(loaded, None).answer)
        K, C = impedance(motion, omega, omega)
    assert np.max(np.abs(found.real - K)) <= 1e-4 * np.max(np.abs(K))
    assert np.max(np.abs(found.imag / omega - C)) <= 1e-2 * np.max(np.abs(C))


def swung(contacts: str, cells: int) -> Record:
    """A turn of a rotor that is released at rest off its balance, in the same place on every grid."""
    bearing = on_grid(cells).replace(rotor={"mass": 3.0}, **{"model.contacts": contacts})
    return follow(bearing, OrbitRequest(revolutions=1.0, initial=(0.0, -315e-6), tolerance=1e-4))


@pytest.mark.slow
def test_a_swing_converges_with_the_grid_where_nodes_do_not() -> None:
    """Position after a turn on 16, 32, 64 cells: differences between grids fall, and are below those of nodes."""
    apart = {}
    for contacts in ("points", "nodes"):
        ends = [float(np.asarray(swung(contacts, cells).fields["y"])[-1]) for cells in (16, 32, 64)]
        apart[contacts] = [abs(b - a) for a, b in pairwise(ends)]
    assert apart["points"][1] < 0.4 * apart["points"][0]
    assert apart["points"][1] < 0.2 * apart["nodes"][1]


@pytest.mark.slow
def test_audits_close_to_second_order() -> None:
    """Gas and energy: a third of the defect at half the step, with elements that contacts bend further."""
    bearing, defects = petals(rotor={"mass": 1.0, "unbalance": 2e-6}), []
    for step in (0.04, 0.02):
        motion = equal_steps(bearing, step, 2.0)
        assert motion.trace.last is not None
        assert motion.trace.last.points is not None
        scalars = motion.record().scalars
        defects.append([scalars["mass_balance_error"], scalars["energy_balance_error"]])
    coarse, fine = np.array(defects, dtype=float)
    assert np.all((fine <= 0.35 * coarse) | (fine <= 1e-9)), (coarse, fine)
    assert np.all(fine <= 1e-3)


@pytest.mark.slow
def test_a_ramp_lifts_off_and_a_rotor_comes_down_again() -> None:
    """From rest on its petals a rotor is run up, and down: contact points all the way, no step without an answer."""
    bearing = petals(rotor={"mass": 1.0}, **{"operation.load": (0.0, -15.0)})
    up_and_down = ((0.0, 0.0), (10e-3, 2000.0), (20e-3, 100.0))
    record = orbit.record(bearing, speeds=up_and_down, initial="balance")
    share = np.asarray(record.fields["contact_fraction"])
    aloft = np.flatnonzero(share == 0.0)
    assert share[0] > 0.9
    assert len(aloft)
    assert share[-1] > 0.5
    assert record.scalars["failed_steps"] == 0
    assert record.scalars["contact_model"] == AT_POINTS
    assert record.scalars["point_share"] == 1.0
    assert np.asarray(record.fields["min_film_thickness"]).min() >= 1e-6


@pytest.mark.slow
def test_a_pack_without_points_goes_on_with_contacts_at_nodes_and_says_so() -> None:
    """Eight petals that a large unbalance throws together: residuals hold, and the steps at nodes are told."""
    record = follow(petals(rotor={"mass": 3.0, "unbalance": 30e-6}), OrbitRequest(revolutions=4.0))
    share = float(str(record.scalars["point_share"]))
    assert 0.1 < share < 1.0
    assert "contacts at nodes in the others" in str(record.scalars["contact_model"])
    assert float(str(record.scalars["residual"])) <= 1e-3


def audits(orbit: Orbit, path: list[Instant]) -> Audits:
    """Of a path of instants."""
    trace = Trace(orbit.case, orbit.system)
    for instant in path:
        trace.add(instant)
    return trace.audits(trace.histories()[1])


def test_a_rotor_that_rests_at_its_balance_has_no_error_of_energy() -> None:
    """The work of a journal that moves by rounding is no measure: its error would be of the order of one."""
    still, moving = (
        orbit(on_grid(16).replace(rotor={"mass": 3.0}), load=(0.0, -WEIGHT), initial=start, revolutions=0.1)
        for start in ("balance", (0.0, -315e-6))
    )
    assert float(still["amplitude"]) < 1e-12
    assert float(still["energy_balance_error"]) == 0.0
    assert 0.0 < float(moving["energy_balance_error"]) < 0.05


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.05])
def test_energy_of_a_step_from_points_to_nodes_is_told_and_not_counted(friction: float) -> None:
    """What is left is no more than the errors of both parts; together with what is told it is all that was missing."""
    bearing = on_grid(16).replace(rotor={"mass": 3.0}, **{"surface.petal_friction": friction})
    orbit = Orbit.begin(bearing, OrbitRequest(revolutions=1.0, initial=(0.0, -315e-6)))
    options = MarchOptions(tolerance=1e-4, first=0.01, longest=0.1)
    with running():
        first = [orbit.start, *(step.end for step in march(orbit.system, orbit.start, 1.0, options))]
        second = [step.end for step in march(orbit.system.at_nodes, first[-1], 2.0, options)]
    assert all(one.points is not None for one in first)
    assert all(one.points is None for one in second)
    whole, parts = audits(orbit, [*first, *second]), [audits(orbit, first), audits(orbit, second)]
    assert all(part.contact_model_energy is None for part in parts)
    assert whole.contact_model_energy is not None
    assert whole.contact_model_energy > 1e-6
    assert whole.energy_balance_error <= sum(part.energy_balance_error for part in parts)
