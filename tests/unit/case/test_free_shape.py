import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq

from petalfoil.case.free_shape import arc_radius, arc_reach, chordal_tilt

R_M, R_P = 25.912e-3, 40e-3  # the paper's flat study
PHI_1 = 45e-3 / R_M


def radius(phi: float, tilt: float, bend_radius: float = R_P) -> float:
    return float(arc_radius(phi, metric_radius=R_M, bend_radius=bend_radius, tilt=tilt))


def test_the_arc_is_the_circle_of_the_bend_radius() -> None:
    tilt = 0.3
    phi = np.linspace(0.0, PHI_1, 41)
    r0 = arc_radius(phi, metric_radius=R_M, bend_radius=R_P, tilt=tilt)
    centre = R_M - R_P * math.cos(tilt), -R_P * math.sin(tilt)
    distance = np.hypot(r0 * np.cos(phi) - centre[0], r0 * np.sin(phi) - centre[1])
    np.testing.assert_allclose(distance, R_P, rtol=1e-14)


@pytest.mark.parametrize("tilt", [-0.2, 0.0, 0.35])
def test_the_arc_leaves_the_root_at_the_tilt(tilt: float) -> None:
    assert radius(0.0, tilt) == pytest.approx(R_M, rel=1e-14)
    step = 1e-6
    slope = (radius(step, tilt) - radius(-step, tilt)) / (2 * step)
    assert slope / R_M == pytest.approx(-math.tan(tilt), abs=1e-9)  # inward is negative


def test_the_chordal_tilt_solves_its_equation() -> None:
    found = brentq(lambda tilt: radius(PHI_1, tilt) - R_M, 0.05, 1.0, xtol=1e-15, rtol=1e-14)
    assert chordal_tilt(R_M, R_P, PHI_1) == pytest.approx(found, rel=1e-12)


def test_the_paper_s_petal_stands_off_the_bore() -> None:
    tilt = chordal_tilt(R_M, R_P, PHI_1)
    inner = arc_radius(np.linspace(0.0, PHI_1, 101)[1:-1], metric_radius=R_M, bend_radius=R_P, tilt=tilt)
    assert tilt > 0.0
    assert np.all(inner < R_M)
    # sagitta of the chord in the bore less the sagitta in the arc
    half_chord = R_M * math.sin(PHI_1 / 2)
    bore = R_M - math.sqrt(R_M**2 - half_chord**2)
    arc = R_P - math.sqrt(R_P**2 - half_chord**2)
    assert R_M - radius(PHI_1 / 2, tilt) == pytest.approx(bore - arc, rel=1e-12)


@given(st.floats(0.3, 2.4), st.floats(1.0, 1e4))
def test_a_chordal_petal_ends_on_the_bore(petal_angle: float, ratio: float) -> None:
    bend_radius = ratio * R_M
    tilt = chordal_tilt(R_M, bend_radius, petal_angle)
    assert radius(petal_angle, tilt, bend_radius) == pytest.approx(R_M, rel=1e-9)
    assert radius(petal_angle / 2, tilt, bend_radius) <= R_M * (1 + 1e-12)
    assert arc_reach(metric_radius=R_M, bend_radius=bend_radius, tilt=tilt) > petal_angle


def test_a_petal_bent_to_the_bore_lies_on_it() -> None:
    phi = np.linspace(0.0, PHI_1, 11)
    tilt = chordal_tilt(R_M, R_M, PHI_1)
    assert tilt == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(arc_radius(phi, metric_radius=R_M, bend_radius=R_M, tilt=tilt), R_M, rtol=1e-14)


def test_a_nearly_straight_petal_keeps_its_digits() -> None:
    tilt, far = PHI_1 / 2, 1e4
    straight = R_M * math.cos(PHI_1 / 2)  # the chord's distance from the axis
    tilt = chordal_tilt(R_M, far, PHI_1)
    assert radius(PHI_1 / 2, tilt, far) == pytest.approx(straight + half_sagitta(far), rel=1e-10)


def half_sagitta(bend_radius: float) -> float:
    half_chord = R_M * math.sin(PHI_1 / 2)
    return half_chord**2 / (2 * bend_radius)


def test_an_arc_around_the_axis_reaches_everywhere() -> None:
    assert arc_reach(metric_radius=R_M, bend_radius=R_P, tilt=0.0) == math.inf


def test_a_tight_arc_turns_back() -> None:
    tight, tilt = 8e-3, 0.2
    reach = arc_reach(metric_radius=R_M, bend_radius=tight, tilt=tilt)
    assert 0.0 < reach < math.pi / 2
    inside = arc_radius(reach * (1 - 1e-6), metric_radius=R_M, bend_radius=tight, tilt=tilt)
    assert np.isfinite(inside)
    with np.errstate(invalid="ignore"):
        outside = arc_radius(reach * (1 + 1e-6), metric_radius=R_M, bend_radius=tight, tilt=tilt)
    assert np.isnan(outside)
