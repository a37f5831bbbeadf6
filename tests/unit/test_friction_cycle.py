"""Equivalent stiffness of friction over a cycle, against cycles that the law is led through."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.physics.dry_friction import Friction, equivalent_stiffness

Array = NDArray[np.float64]

STIFFNESS = np.array([2.0, 2.0, 0.5, 7.0, 3.0, 3.0, 1e3])
LIMIT = np.array([1.0, 1.0, 0.3, 2.0, 6.0, 0.0, 1e-3])
AMPLITUDE = np.array([0.51, 0.8, 4.0, 30.0, 1.9, 1.0, 1.0])
"""Just slipping, slipping by half and mostly, stuck, without a load, nearly without elasticity."""

STEPS = 8192
"""Steps of a cycle: the harmonics of a force with kinks are off by the square of a step."""


def cycle() -> tuple[Array, Array, Array]:
    """Phase, slip and friction (D2) over the second of two cycles of the slip, (steps, k)."""
    count = len(LIMIT)
    law = Friction(1.0, STIFFNESS, sp.csr_array((count, count)), sp.csr_array((count, count)), 1.0)
    phase = 2.0 * np.pi * np.arange(2 * STEPS) / STEPS
    slip = AMPLITUDE * np.cos(phase)[:, None]
    forces, before = [], (np.zeros(count), np.zeros(count))
    for s in slip:
        force, _ = law.force(s, before, LIMIT)
        forces.append(force)
        before = s, force
    return phase[STEPS:], slip[STEPS:], np.array(forces[STEPS:])


def test_equivalent_stiffness_is_the_first_harmonic() -> None:
    """Against the Fourier integral of a cycle of the law itself."""
    phase, _, force = cycle()
    harmonic = 2.0 / STEPS * np.exp(-1j * phase) @ force / AMPLITUDE
    found, _ = equivalent_stiffness(STIFFNESS, LIMIT, AMPLITUDE)
    assert_allclose(found, harmonic, rtol=0.0, atol=2e-6 * float(np.max(np.abs(found))))
    assert_allclose(found.imag[[4, 5]], 0.0, rtol=0.0, atol=0.0)
    assert found[4] == 3.0  # sticks
    assert found[5] == 0.0


def test_loss_is_the_area_of_the_loop() -> None:
    _, slip, force = cycle()
    area = np.sum(0.5 * (force + np.roll(force, 1, axis=0)) * (slip - np.roll(slip, 1, axis=0)), axis=0)
    closed_form = 4.0 * LIMIT * np.maximum(AMPLITUDE - LIMIT / STIFFNESS, 0.0)
    found, _ = equivalent_stiffness(STIFFNESS, LIMIT, AMPLITUDE)
    assert_allclose(area, closed_form, rtol=1e-4, atol=1e-12)
    assert_allclose(np.pi * found.imag * AMPLITUDE**2, closed_form, rtol=1e-14, atol=1e-14)


def test_derivative_by_the_amplitude() -> None:
    step = 1e-6
    ahead, behind = (equivalent_stiffness(STIFFNESS, LIMIT, AMPLITUDE * np.exp(s))[0] for s in (step, -step))
    _, slope = equivalent_stiffness(STIFFNESS, LIMIT, AMPLITUDE)
    assert_allclose(slope, (ahead - behind) / (2.0 * step), rtol=1e-6, atol=1e-8)


def test_a_cycle_that_just_slips_is_nearly_stuck() -> None:
    limit = np.array([1.0])
    found, _ = equivalent_stiffness(np.array([2.0]), limit, 0.5 * limit * (1.0 + 1e-10))
    assert_allclose(found, 2.0, rtol=1e-9)
