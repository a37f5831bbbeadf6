"""Motions with friction whose contacts pass from nodes to points: forces, the motion from there, energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import OrbitRequest
from petalfoil.case import Rotor
from petalfoil.dynamics import adaptive_steps
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.point_path import point_friction
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.equilibrium.contact_runs import nodes_of_curves
from petalfoil.equilibrium.run_context import running
from petalfoil.system.point_layout import PointLayout
from tests.verification.test_decay import rubbing
from tests.verification.test_friction_in_time import CELLS, RATIO, led

STEP = 2.0 * np.pi / RATIO / 60
"""A sixtieth of a cycle of a led journal [units of time]."""


def marched(bearing: RotorBearing, begin: Instant, steps: int) -> list[Instant]:
    """Ends of some equal steps."""
    options = MarchOptions(tolerance=1e-5, first=STEP, longest=STEP, fixed=True)
    with running():
        return [one.end for one in march(bearing, begin, begin.tau + steps * STEP, options)]


def at_nodes(friction: float, amplitude: float) -> tuple[RotorBearing, PointLayout, Instant, Instant]:
    """Eight petals round a led journal after a cycle and eight steps: contacts at points, and in these at nodes."""
    orbit, path, rotor = led(friction, amplitude, 60, 2)
    system = replace(orbit.system, rotor=rotor)
    assert system.points is not None
    return system, system.points, path[60], marched(system.at_nodes, path[60], 8)[-1]


@pytest.mark.slow
def test_forces_at_nodes_pass_to_the_points_of_their_curves() -> None:
    system, whole, _, begin = at_nodes(0.05, 4e-6)
    assert system.friction is not None
    assert begin.friction is not None
    law = point_friction(whole, system.friction, begin)
    at_gaps, points = system.friction.reaction_share.T @ begin.friction.force, law.begin.points
    for curve, gaps, _ in nodes_of_curves(whole):
        assert_allclose(law.force[points.every_curve == curve].sum(), at_gaps[gaps].sum(), atol=1e-12)
    assert np.abs(law.force).sum() > 0.1
    assert np.all(np.abs(law.force) <= law.limit(points) * (1.0 + 1e-12))


@pytest.mark.slow
def test_points_found_again_lead_on_as_if_they_had_never_been_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    """Friction forces after ten steps against those of a motion that never left points: within 6 % in their norm."""
    system, _, left, begin = at_nodes(0.0025, 8e-6)
    monkeypatch.setattr(adaptive_steps, "SELDOM", 2)
    found, always = marched(system, begin, 12), marched(system, left, 20)
    assert [one.points is not None for one in found] == [False] * 2 + [True] * 10
    apart = []
    for one, other in zip(found[2:], always[10:], strict=True):
        assert one.friction is not None
        assert other.friction is not None
        missed = one.friction.force - other.friction.force
        apart.append(float(np.linalg.norm(missed) / np.linalg.norm(other.friction.force)))
    assert apart[0] > 1.0  # what was stuck at nodes slips to where it is at points
    assert apart[-1] < 0.08


def from_assembled_pack(contacts: str) -> Orbit:
    """A motion of eight petals from a balance whose pack was assembled, with contacts as given."""
    bearing = rubbing("paper_n8", 0.0025, CELLS).replace(rotor=Rotor(mass=0.5, unbalance=2e-6))
    kept = bearing.replace(**{"surface.friction_history": "assembled", "model.contacts": contacts})
    return Orbit.begin(kept, OrbitRequest(initial="balance", revolutions=0.5))


def shares_of(orbit: Orbit) -> list[bool]:
    """Which steps of a motion have contact points."""
    shares = []
    for _ in orbit.advance():
        assert orbit.trace.last is not None
        shares.append(orbit.trace.last.points is not None)
    return shares


@pytest.mark.slow
def test_a_motion_from_an_assembled_pack_goes_on_with_its_points() -> None:
    orbit = from_assembled_pack("points")
    assert orbit.start.points is not None
    assert orbit.start.friction is not None
    assert np.abs(orbit.start.friction.force).sum() > 0.0
    assert all(shares_of(orbit))
    assert float(orbit.record().scalars["energy_balance_error"]) < 5e-3


@pytest.mark.slow
def test_a_motion_from_an_assembled_pack_at_nodes_finds_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its balance has friction forces at nodes; the energy of the passing step is told by itself, the rest closes."""
    monkeypatch.setattr(adaptive_steps, "SELDOM", 5)
    at_nodes = from_assembled_pack("nodes")
    orbit = replace(at_nodes, system=replace(at_nodes.system, points=from_assembled_pack("points").system.points))
    assert orbit.start.points is None
    assert orbit.start.friction is not None
    shares = shares_of(orbit)
    told = orbit.record().scalars
    assert not any(shares[:5])
    assert all(shares[5:])
    assert float(told["contact_model_energy"]) > 0.0
    assert float(told["energy_balance_error"]) < 5e-3
