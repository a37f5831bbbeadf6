"""Motions in compiled loops: which they are, and that they are the same."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.dynamics import compiled_stages
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.compiled_stages import WORTH, worth_compiling
from petalfoil.dynamics.tr_bdf2 import AcceptedStep
from petalfoil.system.compiled_step import CompiledStepEquations
from tests.unit.dynamics.test_point_stage import begun


def steps(count: int) -> list[AcceptedStep]:
    """The first steps of the paper's 8 petals from their balance, the rotor's mass centre off the axis."""
    orbit = begun(**{"rotor.unbalance": "20 um"})
    with orbit.run.active():
        motion = march(orbit.system, orbit.start, 10.0, MarchOptions(first=0.05))
        return [next(motion) for _ in range(count)]


@pytest.mark.slow
def test_long_motions_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where numba is, and only with contact points that do not rub."""
    bearing = begun().system
    monkeypatch.setattr(compiled_stages, "numba_is_installed", lambda: True)
    assert worth_compiling(bearing, WORTH)
    assert not worth_compiling(bearing, 0.99 * WORTH)
    assert not worth_compiling(bearing.at_nodes, WORTH)
    rubbing = begun(**{"surface.petal_friction": 0.1}).system
    assert rubbing.friction is not None
    assert not worth_compiling(rubbing, WORTH)
    dragging = begun(**{"surface.journal_rubbing": "force", "surface.friction_coefficient": 0.1}).system
    assert dragging.points is None or not worth_compiling(dragging, WORTH)
    monkeypatch.setattr(compiled_stages, "numba_is_installed", lambda: False)
    assert not worth_compiling(bearing, WORTH)


@pytest.mark.slow
def test_a_compiled_motion_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Position, gas and contact points, to rounding."""
    plain = steps(4)
    monkeypatch.setattr("petalfoil.dynamics.adaptive_steps.worth_compiling", lambda *_: True)
    fast = steps(4)
    for mine, its in zip(fast, plain, strict=True):
        assert isinstance(mine.end.equations, CompiledStepEquations)
        assert not isinstance(its.end.equations, CompiledStepEquations)
        assert mine.end.tau == pytest.approx(its.end.tau, rel=1e-9)
        assert_allclose(mine.end.e, its.end.e, rtol=0.0, atol=1e-12)
        assert_allclose(mine.end.moving.stored, its.end.moving.stored, rtol=1e-11)
        places = [one.end.points.points.position for one in (mine, its) if one.end.points is not None]
        assert_allclose(*places, rtol=0.0, atol=1e-10)
    assert np.linalg.norm(plain[-1].end.e - plain[0].inner.e) > 1e-4
