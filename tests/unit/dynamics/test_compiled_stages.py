"""Motions in compiled loops: which they are, and that they are the same."""

from __future__ import annotations

import sys
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.dynamics import compiled_stages
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.compiled_stages import LOOPS, TO_COMPILE, TO_LOAD, StepsBefore, worth_compiling
from petalfoil.dynamics.tr_bdf2 import AcceptedStep
from petalfoil.system.compiled_step import CompiledStepEquations
from tests.unit.dynamics.test_point_stage import begun


def steps(count: int) -> list[AcceptedStep]:
    """The first steps of the paper's 8 petals from their balance, the rotor's mass centre off the axis."""
    orbit = begun(**{"rotor.unbalance": "20 um"})
    with orbit.run.active():
        motion = march(orbit.system, orbit.start, 10.0, MarchOptions(first=0.05))
        return [next(motion) for _ in range(count)]


@pytest.fixture
def unpaid(monkeypatch: pytest.MonkeyPatch) -> StepsBefore:
    """A process with numba that has loaded nothing, and no steps before."""
    monkeypatch.setattr(compiled_stages, "numba_is_installed", lambda: True)
    monkeypatch.setattr(compiled_stages, "compiled_before", lambda: False)
    monkeypatch.delitem(sys.modules, LOOPS, raising=False)
    monkeypatch.setattr(compiled_stages, "BEFORE", StepsBefore())
    return compiled_stages.BEFORE


@pytest.mark.slow
def test_motions_are_compiled_by_what_is_still_to_be_paid(unpaid: StepsBefore, monkeypatch: pytest.MonkeyPatch) -> None:
    """Long ones; shorter ones with loops on disk, or after others; all of them where the loops are loaded."""
    bearing = begun().system
    assert worth_compiling(bearing, TO_COMPILE)
    assert not worth_compiling(bearing, 0.6 * TO_COMPILE)
    assert unpaid.steps == 0.6 * TO_COMPILE
    assert worth_compiling(bearing, 0.4 * TO_COMPILE)
    unpaid.steps = 0.0
    monkeypatch.setattr(compiled_stages, "compiled_before", lambda: True)
    assert worth_compiling(bearing, TO_LOAD)
    assert not worth_compiling(bearing, 0.99 * TO_LOAD)
    unpaid.steps = 0.0
    assert not worth_compiling(bearing, 1.0)
    monkeypatch.setitem(sys.modules, LOOPS, ModuleType(LOOPS))
    assert worth_compiling(bearing, 1.0)


@pytest.mark.slow
def test_only_contact_points_that_do_not_rub_are_compiled(unpaid: StepsBefore, monkeypatch: pytest.MonkeyPatch) -> None:
    """Others are not, however long, nor do their steps count; none are without numba."""
    bearing = begun().system
    assert not worth_compiling(bearing.at_nodes, TO_COMPILE)
    rubbing = begun(**{"surface.petal_friction": 0.1}).system
    assert rubbing.friction is not None
    assert not worth_compiling(rubbing, TO_COMPILE)
    dragging = begun(**{"surface.journal_rubbing": "force", "surface.friction_coefficient": 0.1}).system
    assert dragging.points is None or not worth_compiling(dragging, TO_COMPILE)
    monkeypatch.setattr(compiled_stages, "numba_is_installed", lambda: False)
    assert not worth_compiling(bearing, TO_COMPILE)
    assert unpaid.steps == 0.0


@pytest.mark.slow
def test_a_compiled_motion_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Position, gas and contact points, to rounding."""
    monkeypatch.setattr("petalfoil.dynamics.adaptive_steps.worth_compiling", lambda *_: False)
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
