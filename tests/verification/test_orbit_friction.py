"""Friction between petals in motion: it takes energy, all of it accounted for, and damps what hardly damps itself."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.analysis.orbit_motion import Orbit, follow
from petalfoil.analysis.release import OrbitRequest
from petalfoil.case import Case
from petalfoil.results.dataset import to_dataset
from petalfoil.results.record import Record
from tests.cases import case


def rubbing(mu: float, **changes: object) -> Case:
    """Eight petals on 16 cells per pitch under a rotor of 3 kg."""
    grid = {"model.cells_per_pitch": 16, "surface.petal_friction": mu}
    return case("paper_n8", rotor={"mass": 3.0}, **grid, **changes)


def bounce(mu: float, **changes: object) -> Record:
    """Let go 20 um above its balance, two thirds of an oscillation long."""
    high = {"operation.eccentricity": (0.0, -260e-6), **changes}
    return follow(rubbing(mu, **high), OrbitRequest(revolutions=30.0))


def swing(record: Record) -> float:
    """Kinetic energy at its largest in the second half [J]."""
    energy = np.asarray(record.fields["kinetic_energy"])
    return float(energy[len(energy) // 2 :].max())


@pytest.mark.slow
def test_energy_that_friction_takes_is_accounted_for() -> None:
    """Loss grows only; gained by rotor and petals is what loads and film gave, less the loss."""
    record = bounce(0.2)
    lost = np.asarray(record.fields["petal_friction_work"])
    kinetic = np.asarray(record.fields["kinetic_energy"])
    assert int(record.scalars["failed_steps"]) <= 0.01 * int(record.scalars["steps"])
    assert np.all(np.diff(lost) >= 0.0)
    assert lost[-1] > 0.02 * kinetic.max()
    assert float(record.scalars["energy_balance_error"]) < 2e-2
    defect = float(record.scalars["energy_balance_error"])
    assert defect * (np.abs(np.asarray(record.fields["film_work"])).max() + kinetic.max()) < 0.2 * lost[-1]


@pytest.mark.slow
def test_friction_damps_the_swing() -> None:
    """The more of it, the less is left of the motion, where faces turn; petals that slide stick at once.

    Under friction of faces that only turn contacts of a motion are at nodes; they have to be without it too.
    """
    alike = {"petals.theory": "inextensible", "model.contacts": "nodes"}
    left = [swing(bounce(mu, **alike)) for mu in (0.0, 0.1, 0.2)]
    assert left[2] < left[1] < left[0]


def test_without_friction_nothing_is_lost() -> None:
    record = follow(rubbing(0.0), OrbitRequest(revolutions=1.0, initial="balance"))
    assert not np.any(np.asarray(record.fields["petal_friction_work"]))


@pytest.mark.slow
def test_the_motion_does_not_hang_on_the_width_of_the_stick() -> None:
    """Half the width, a loss that differs by a few per cent at most."""
    losses, turning = [], {"operation.eccentricity": (0.0, -260e-6), "petals.theory": "inextensible"}
    for width in (4e-9, 2e-9, 1e-9):
        record = follow(
            rubbing(0.2, **{"surface.friction_width": width, **turning}),
            OrbitRequest(revolutions=20.0),
        )
        losses.append(float(np.asarray(record.fields["petal_friction_work"])[-1]))
    assert abs(losses[1] / losses[2] - 1.0) < 0.05
    assert abs(losses[1] / losses[2] - 1.0) < abs(losses[0] / losses[2] - 1.0) + 1e-3


@pytest.mark.slow
def test_a_restart_goes_on_with_the_friction_that_was_there() -> None:
    bearing = rubbing(0.2, **{"operation.eccentricity": (0.0, -260e-6)})
    half, whole = OrbitRequest(revolutions=1.0), OrbitRequest(revolutions=2.0)
    first = to_dataset(follow(bearing, half))
    assert np.any(first["last_friction"].to_numpy())
    second, once = follow(bearing, half, first), follow(bearing, whole)
    begin = Orbit.begin(bearing, half, first).start
    assert begin.friction is not None
    assert np.array_equal(begin.friction.force, first["last_friction"].to_numpy())
    for name in ("x", "y"):
        assert np.asarray(second.fields[name])[-1] == pytest.approx(np.asarray(once.fields[name])[-1], abs=1e-8)
