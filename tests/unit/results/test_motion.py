"""Places once a turn and spectra of made-up paths, whose frequencies are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.results.motion import Path, dominant_whirl_ratio, figures_of, settled_amplitude, spectrum, waterfall

from .paths import SPEED, ramped, whirling


def test_between_steps_the_path_is_smooth() -> None:
    path = whirling(2.0, (1.0, 1e-5))
    middles = 0.5 * (path.time[1:] + path.time[:-1])
    assert_allclose(path.at(middles), 1e-5 * np.exp(1j * SPEED * middles), rtol=1e-5, atol=0.0)


def test_once_a_turn_a_circle_with_the_shaft_is_one_point() -> None:
    points = whirling(5.0, (1.0, 1e-5)).once_a_turn()
    assert_allclose(points, np.full(6, 1e-5), rtol=1e-5, atol=1e-11)
    half = whirling(5.0, (0.5, 1e-5)).once_a_turn()
    assert_allclose(half, 1e-5 * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0]), rtol=1e-5, atol=1e-11)


def test_no_turn_no_point() -> None:
    assert whirling(0.9, (1.0, 1e-5)).once_a_turn().size == 0


def test_once_a_turn_while_the_shaft_speeds_up() -> None:
    path = ramped(2000.0, 0.05, 1.0, 1e-5)  # 50 rad: 7 whole turns
    assert_allclose(path.once_a_turn(), np.full(8, 1e-5), rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("ratio", [1.0, 0.47, 0.5, -1.0, 1.9])
def test_a_circle_is_a_peak_of_its_radius_at_its_frequency(ratio: float) -> None:
    frequency, radius = spectrum(whirling(24.0, (ratio, 3e-6))).peak()
    assert_allclose(frequency, ratio * SPEED, rtol=2e-3)
    assert_allclose(radius, 3e-6, rtol=1e-2)


def test_the_larger_of_two_circles_dominates_whatever_drifts() -> None:
    path = whirling(24.0, (0.48, 5e-6), (1.0, 2e-6), drift=4e-4 + 1e-4j)
    assert_allclose(dominant_whirl_ratio(path), 0.48, rtol=2e-3)


def test_an_ellipse_has_a_line_on_both_sides() -> None:
    found = spectrum(whirling(24.0, (1.0, 3e-6), (-1.0, 1e-6)))
    forward = float(np.interp(SPEED, found.frequency, found.amplitude))
    backward = float(np.interp(-SPEED, found.frequency, found.amplitude))
    assert_allclose([forward, backward], [3e-6, 1e-6], rtol=1e-2)


def test_a_few_turns_tell_no_frequency() -> None:
    assert math.isnan(dominant_whirl_ratio(whirling(3.0, (1.0, 1e-5))))


def test_the_amplitude_is_that_of_the_last_half() -> None:
    path = whirling(16.0, (1.0, 3e-6))
    early = path.angle < 0.4 * path.angle[-1]
    disturbed = Path(path.time, path.x + early * 1e-4, path.y, path.velocity_x, path.velocity_y, path.angle, path.speed)
    assert_allclose(settled_amplitude(disturbed), 3e-6, rtol=1e-2)


def test_a_start_alone_has_no_amplitude() -> None:
    one = {name: np.zeros(1) for name in ("x", "y", "velocity_x", "velocity_y", "shaft_angle", "shaft_speed")}
    found = figures_of(np.zeros(1), one)
    assert found["amplitude"] == 0.0
    assert math.isnan(found["dominant_whirl_ratio"])


@pytest.mark.parametrize("ratio", [1.0, 0.5])
def test_a_waterfall_follows_the_speed(ratio: float) -> None:
    found = waterfall(ramped(4000.0, 0.5, ratio, 2e-6))
    fast = found.speed > 1000.0
    peaks = found.frequency[np.argmax(found.amplitude, axis=1)]
    assert np.all(np.diff(found.speed) > 0.0)
    assert_allclose(peaks[fast], ratio * found.speed[fast], rtol=0.05)


def test_a_shaft_at_rest_has_spectra_too() -> None:
    time = np.linspace(0.0, 1.0, 400)
    z, v = 1e-6 * np.exp(200j * time), 200j * 1e-6 * np.exp(200j * time)
    path = Path(time, z.real, z.imag, v.real, v.imag, 0.0 * time, 0.0 * time)
    assert path.once_a_turn().size == 0
    assert_allclose(spectrum(path).peak(), (200.0, 1e-6), rtol=2e-2)
