"""Damped natural motions of a rigid rotor on film and petals: `det(m s^2 + Z(s)) = 0` with complex `s` (E7).

`Z` is known on the imaginary axis from the scan for the threshold. A rational function through these values (E8) gives
all modes near the axis at once; each is then solved for on the equations themselves, a factorisation a step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la
from numpy.typing import NDArray

from petalfoil.dynamics.critical_mass import SCAN, Complex, whirl_impedance
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.reduced_model import Rational

PEAK = 1.0 / math.sqrt(2.0)
"""Damping ratio from which on a mode shows no resonance: those are not told."""
PRECISION = 1e-9
"""Last relative step towards a mode."""
STEPS = 12
"""Steps after which what the rational function gave is no mode of the equations."""
APART = 1e-6
"""Relative distance below which two modes are one."""
FARTHER = 1.25
"""Factor between whirl ratios beyond the scan, for rotors that are light or turn slowly."""


@dataclass(frozen=True)
class Mode:
    """One natural motion `v exp(s tau)`.

    Attributes
    ----------
    s : complex
        Eigenvalue per radian of rotation, on the upper half plane [1].
    participation : float
        Participation of the rotor (E9): twice `|d ln s / d ln m|`. 1 on a spring, 0 for film and petals alone [1].
    direction : float
        1 for a circle with the rotation, -1 against it, 0 along a line [1].
    """

    s: complex
    participation: float
    direction: float

    @property
    def damping_ratio(self) -> float:
        """`-Re s / |s|`."""
        return -self.s.real / abs(self.s)


def natural_modes(motion: SmallMotion, inertia: float, scanned: Complex) -> list[Mode]:
    """Find the modes that show a resonance or grow, by frequency.

    Parameters
    ----------
    motion : SmallMotion
        Small motions about the operating point.
    inertia : float
        Rotor's mass times the square of the speed [N/m].
    scanned : (n, d, d) complex array
        Impedances of `whirl.scan` [N/m].
    """
    ratios, values = reaching(motion, inertia, scanned)
    points, both = np.concatenate([1j * ratios, -1j * ratios]), np.concatenate([values, values.conj()])
    found: list[Mode] = []
    for start in Rational.fit(points, both).modes(inertia):
        if start.imag < -APART * abs(start) or abs(start) > 2.0 * ratios[-1] or not shows(start):
            continue
        mode = polished(motion, inertia, complex(start))
        if mode is None:
            current_run().note("modes", outcome=f"no mode near {start:.4g}")
        elif abs(mode.s) <= ratios[-1] and shows(mode.s) and not any(same(mode, other) for other in found):
            found.append(mode)
    return sorted(found, key=lambda mode: mode.s.imag)


def shows(s: complex) -> bool:
    """Whether a mode grows or is damped so little that it has a resonance."""
    return -s.real < PEAK * abs(s)


def same(one: Mode, other: Mode) -> bool:
    """Whether two solutions are the same mode."""
    return abs(one.s - other.s) <= APART * abs(one.s)


def reaching(motion: SmallMotion, inertia: float, scanned: Complex) -> tuple[NDArray[np.float64], Complex]:
    """Whirl ratios and impedances of the scan, continued to 1.5 times where the rotor resonates at the latest."""
    ratios, values = list(SCAN), list(scanned)
    while ratios[-1] < 1.5 * math.sqrt(np.linalg.norm(values[-1], 2) / inertia):
        ratios.append(ratios[-1] * FARTHER)
        values.append(whirl_impedance(motion, ratios[-1]))
    return np.array(ratios), np.array(values)


def polished(motion: SmallMotion, inertia: float, s: complex) -> Mode | None:
    """The mode near `s`, by successive linear problems `D v = step D' v`, `D = m s^2 + Z`; None if they do not end."""
    scales, one = motion.problem.layout.scales, np.eye(motion.problem.layout.n_position)
    for _ in range(STEPS):
        response = motion.growing(s, current_run().probe_solver)
        D = inertia * s**2 * one - response.force_gradient * scales.force / scales.length
        slope = 2.0 * inertia * s * one - response.slope() * scales.force / scales.length
        steps, left, right = la.eig(D, slope, left=True)
        k = int(np.argmin(np.abs(steps)))
        s = complex(s - steps[k])
        if abs(steps[k]) <= PRECISION * abs(s):
            y, v = left[:, k].conj(), right[:, k]
            share = abs(2.0 * inertia * s * (y @ v) / (y @ slope @ v))
            return Mode(upper(s), float(share), orbit(v if s.imag >= 0.0 else v.conj()))
    return None


def upper(s: complex) -> complex:
    """Of a conjugate pair the one with a frequency; a motion without one as real."""
    return complex(s.real, abs(s.imag) if abs(s.imag) > APART * abs(s) else 0.0)


def orbit(v: Complex) -> float:
    """Direction of the ellipse `Re(v exp(i tau))`: areas with the rotation over those of circles of its size."""
    return float(-2.0 * (v[::2].conj() @ v[1::2]).imag / np.linalg.norm(v) ** 2)
