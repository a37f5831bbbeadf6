"""Natural modes and critical mass of a rotor while petals rub at a stated amplitude (E18), (E19)."""

from __future__ import annotations

import math
from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.stability import AT_AMPLITUDE, stability, whirl_parts
from petalfoil.case import Case, Rotor
from petalfoil.dynamics.critical_mass import Whirl, whirl_impedance
from petalfoil.dynamics.more_harmonics import bettered
from petalfoil.dynamics.natural_modes import Mode, natural_modes, tilt_of
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.dynamics.rubbing_modes import NeutralWhirls, RubbingRotor
from petalfoil.dynamics.rubbing_whirl import RubbingWhirl, half_axis
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import UsageError
from petalfoil.results.parts import RunOutcome
from tests.cases import case

MASS, LOAD, RUBS = 2.0, 20.0, 2e-6
"""Of the rotor [kg], on it [N]; an amplitude at which some of the petals slip and others stick [m]."""


def bearing(**changes: object) -> Case:
    """Eight petals with friction on a coarse grid."""
    return case("paper_n8", **{"surface.petal_friction": 0.3, "model.cells_per_pitch": 12, **changes})


@cache
def rotor_and_impedance() -> tuple[RotorOnBearings, Impedance]:
    """The rotor under its load, the impedance of petals that stick."""
    rotor = RotorOnBearings(bearing(), MASS)
    with running():
        return rotor, rotor.impedance(operating_point(rotor.case, (0.0, -LOAD)).answer)


def modes_at(amplitude: float) -> list[Mode]:
    """The modes at an amplitude [m]."""
    rotor, impedance = rotor_and_impedance()
    with running():
        return RotorOnBearings(rotor.case, MASS, amplitude).modes(impedance, rotor.case.operation.speed)


def values(modes: list[Mode]) -> NDArray[np.complex128]:
    """Eigenvalues, by frequency."""
    return np.array([mode.s for mode in modes])


def test_half_axis_of_a_line_a_circle_and_an_ellipse() -> None:
    turn = np.exp(0.3j)
    assert half_axis(turn * np.array([3.0, 4.0])) == pytest.approx(5.0)
    assert half_axis(turn * np.array([2.0, -2.0j])) == pytest.approx(2.0)
    assert half_axis(turn * np.array([3.0, 1.0j])) == pytest.approx(3.0)


@pytest.mark.slow
def test_small_cycles_stick_and_large_ones_hardly_rub() -> None:
    """Both linear limits, with their participation and direction."""
    rotor, impedance = rotor_and_impedance()
    with running():
        free = whirl_impedance(impedance.motion.frictionless)
        for amplitude, linear, within in ((1e-10, impedance, 1e-6), (1.0, free, 1e-2)):
            expected = natural_modes(linear, rotor.inertia, rotor.case.operation.speed)
            found = modes_at(amplitude)
            assert len(found) == len(expected)
            assert_allclose(values(found), values(expected), rtol=within)
            for name in ("participation", "direction"):
                told = ([getattr(mode, name) for mode in each] for each in (found, expected))
                assert_allclose(*told, atol=5e-2 if amplitude == 1.0 else 1e-5)


@pytest.mark.long
def test_modes_do_not_depend_on_the_axes() -> None:
    """Bearing and load turned by 0.4 rad: the same modes; columns of equivalent `K` and `C` would give others."""
    turn = 0.4
    first_root = bearing().petals.first_root
    turned = bearing(**{"petals.first_root": first_root + turn})
    load = (LOAD * math.sin(turn), -LOAD * math.cos(turn))
    record = stability.record(turned, load=load, mass=MASS, amplitude=RUBS)
    here = modes_at(RUBS)
    assert_allclose(record.fields["damping_ratio"], [mode.damping_ratio for mode in here], rtol=1e-5)
    assert_allclose(record.fields["whirl_direction"], [mode.direction for mode in here], atol=1e-5)
    assert record.scalars["whirl_amplitude"] == RUBS
    assert "no threshold speed at an amplitude" in str(record.scalars["status"])
    stuck = [mode.damping_ratio for mode in modes_at(1e-10)]
    assert np.max(np.abs(np.array(stuck) / record.fields["damping_ratio"] - 1.0)) > 1e-3  # some petals do slip


@pytest.mark.long
def test_a_rotor_of_the_critical_mass_whirls_on_at_the_amplitude() -> None:
    """Its mode neither grows nor dies out there; with half a per cent more mass it grows."""
    rotor, impedance = rotor_and_impedance()
    speed = rotor.case.operation.speed
    with running():
        whirl = RotorOnBearings(rotor.case, MASS, RUBS).whirl(impedance, speed)
        stuck = rotor.whirl(impedance, speed)
        assert whirl.mass != pytest.approx(stuck.mass, rel=1e-2)
        growth = []
        for part in (1.0, 1.005):
            modes = RotorOnBearings(rotor.case, part * whirl.mass, RUBS).modes(impedance, speed)
            nearest = min(modes, key=lambda mode: abs(mode.s - 1j * whirl.ratio))
            growth.append(nearest.s)
        assert growth[0] == pytest.approx(1j * whirl.ratio, abs=1e-6)
        assert growth[1].real > 1e-5


@pytest.mark.slow
def test_two_bearings_that_share_a_rotor_rub_as_one_with_half_of_it() -> None:
    """A cylindrical mode of a rotor of twice the mass is found where that of one bearing is; a conical one is apart."""
    single, alone = rotor_and_impedance()
    both = bearing().replace(rotor=Rotor(mass=2.0 * MASS, span=0.2, transverse_inertia=0.05, polar_inertia=0.004))
    pair, speed = RotorOnBearings(both, 2.0 * MASS), both.operation.speed
    with running():
        joint = pair.impedance(operating_point(both, (0.0, -2.0 * LOAD)).answer)
        two = RubbingRotor(RubbingWhirl.of(joint.motion, RUBS), pair.inertia, speed)
        one = RubbingRotor(RubbingWhirl.of(alone.motion, RUBS), single.inertia, speed)
        known = one.near(next(one.starts(alone)))
        conical = next(start for start in two.starts(joint) if tilt_of(start[1]) > 0.5)
        assert known is not None
        found = two.near((known.number, np.append(known.v, [0.0, 0.0])))
        other = two.near(conical)
        assert found is not None
        (several, left), (single_one, _) = (
            bettered(of.whirl, at, of.near_in) for of, at in ((two, found), (one, known))
        )
    assert other is not None
    assert found.number == pytest.approx(known.number, rel=1e-6)
    assert left.told.friction_harmonics >= 8
    assert several.number != pytest.approx(found.number, rel=1e-4)
    assert several.number == pytest.approx(single_one.number, rel=1e-6)
    assert tilt_of(other.v) > 0.5


@pytest.mark.slow
def test_a_tilting_journal_rubs() -> None:
    """3-D, 4 by 4: stuck at no amplitude, as without friction at a large one, damped in between; forces by position are
    those of a journal that cannot tilt."""
    whole = {"model.cells_per_pitch": 8, "model.axial_cells": 4, "surface.petal_friction": 0.3}
    rubs = case("paper_n8_spatial", **{**whole, "model.contacts": "nodes"})
    smooth = rubs.replace(**{"surface.petal_friction": 0.0})
    blocks = ("stiffness", "stiffness_moment_tilt", "damping", "damping_moment_tilt")

    def told(one: Case, **asked: object) -> dict[str, NDArray[np.float64]]:
        fields = coefficients.record(one, [4000.0], load=(0.0, -10.0), tilt=True, **asked).fields
        return {name: np.asarray(fields[name], dtype=float)[0] for name in blocks}

    stuck, free, between = told(rubs), told(smooth), told(rubs, amplitude=1e-6)
    least, most = told(rubs, amplitude=1e-13), told(rubs, amplitude=1e3)
    for name in blocks:
        size = np.max(np.abs(stuck[name]))
        assert_allclose(least[name], stuck[name], atol=1e-5 * size)
        assert_allclose(most[name], free[name], atol=1e-3 * size)
    for name in ("damping", "damping_moment_tilt"):
        assert np.trace(between[name]) > max(np.trace(stuck[name]), np.trace(free[name]))
    straight = coefficients.record(
        rubs.replace(**{"model.symmetry": False}), [4000.0], load=(0.0, -10.0), amplitude=1e-6
    )
    assert_allclose(between["stiffness"], straight.fields["stiffness"][0], rtol=1e-6)


def test_an_amplitude_without_friction_is_refused() -> None:
    with pytest.raises(UsageError, match="how far petals rub, and here none do"):
        stability.record(case("paper_n8"), load=(0.0, -LOAD), amplitude=1e-6)
    with pytest.raises(UsageError, match="amplitude"):
        stability.records(bearing(), loads=[LOAD], amplitude=1e-6)


# ------------------------------------------------------------------------------------------ searches that go astray


def test_a_search_for_a_neutral_whirl_that_goes_astray_ends() -> None:
    """Stiffnesses that nearly cancel in the guess lead far beyond what numbers hold at first, and back to the whirl."""
    apart = np.diag([1.0, -1.0 + 1e-8])
    whirl = SimpleNamespace(at=lambda s: s, resistance=lambda _, v: apart @ v)
    inertia = SimpleNamespace(mass=np.eye(2), gyroscopic=np.zeros((2, 2)))
    search = NeutralWhirls(cast(RubbingWhirl, whirl), cast(Inertia, inertia), 1000.0)
    found = search.near(0.5, np.array([1.0, 1.0], dtype=complex))
    assert found is not None
    assert found.mass == pytest.approx(1.0 / 500.0**2)


@pytest.mark.parametrize(
    ("ended", "told"),
    [(AT_AMPLITUDE, "no whirl was found that goes on at the amplitude"), ("", "stable for any rotor mass")],
)
def test_a_search_that_finds_no_whirl_at_an_amplitude_excludes_none(ended: str, told: str) -> None:
    """Only small motions, of which all whirls are known, may be called stable for any mass."""
    rotor, _ = rotor_and_impedance()
    with running():
        found = operating_point(rotor.case, (0.0, -LOAD))
    outcome = whirl_parts(rotor.case, found, Whirl(math.inf, math.nan), ended)[-1]
    assert isinstance(outcome, RunOutcome)
    assert told in outcome.status
    assert ("stable" in outcome.status) == (not ended)
