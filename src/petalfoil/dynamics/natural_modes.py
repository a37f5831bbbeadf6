"""Damped natural motions of a rigid rotor on film and petals (E7).

    det(omega^2 (M s^2 + G s) + Z(s)) = 0        with complex s

`M` is the mass, or masses and transverse inertias of a rotor in two bearings, `G` its gyroscopic matrix.

The reduced model of the bearing makes this a small linear eigenvalue problem (E8), which gives all modes at once. Each
mode is then refined.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from petalfoil.case import NEUTRAL_DAMPING
from petalfoil.dynamics.critical_mass import SCAN, Complex
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.equilibrium.run_context import current_run

PEAK = 1.0 / math.sqrt(2.0)
"""Damping ratio above which a mode shows no resonance; such modes are left out."""
PRECISION = 1e-9
"""Last relative step towards a mode."""
ROUNDING = 1e-7
"""Relative step that may be rounding of the impedance: 5e-9 for a clamped pack on 512 cells per pitch. The mode is
found where such steps no longer halve."""
STEPS = 12
"""Most steps of a refinement; a start that takes more is no mode."""
APART = 1e-6
"""Relative distance below which two modes are one."""
SHARE_DIGITS = 12
"""Digits to which the part of the tilt is told: what is beyond is rounding of modes that are purely cylindrical."""
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
        1 for a circular forward whirl, -1 for a circular backward whirl, 0 along a line [1].
    tilt : float
        Part of the tilt in the motion of the journals, by its square: 0 for a cylindrical, 1 for a conical mode [1].
    """

    s: complex
    participation: float
    direction: float
    tilt: float

    @property
    def damping_ratio(self) -> float:
        """`-Re s / |s|`."""
        return -self.s.real / abs(self.s)

    @property
    def is_neutral(self) -> bool:
        """Whether what damps shaft and petals beside film and contacts decides if it grows."""
        return abs(self.damping_ratio) < NEUTRAL_DAMPING

    @property
    def grows(self) -> bool:
        """Whether it grows by more than that."""
        return self.damping_ratio <= -NEUTRAL_DAMPING


def natural_modes(impedance: Impedance, inertia: Inertia, speed: float) -> list[Mode]:
    """Find the modes that show a resonance or grow, by frequency.

    Parameters
    ----------
    impedance : Impedance
        The bearing about the operating point, over the whirl ratios of `critical_mass.SCAN`.
    inertia : Inertia
        The rotor's.
    speed : float
        Angular speed of the shaft [rad/s].
    """
    impedance, farthest = reaching(impedance, inertia.least * speed**2)
    found: list[Mode] = []
    for start in impedance.free_motions(inertia, speed):
        if start.imag < -APART * abs(start) or abs(start) > 2.0 * farthest or not shows(start):
            continue
        mode = polished(impedance, (inertia, speed), complex(start))
        if mode is None:
            current_run().note("modes", outcome=f"no mode near {start:.4g}")
        elif abs(mode.s) <= farthest and shows(mode.s) and not any(same(mode, other) for other in found):
            found.append(mode)
    return sorted(found, key=lambda mode: mode.s.imag)


def shows(s: complex) -> bool:
    """Whether a mode grows or is damped so little that it has a resonance."""
    return -s.real < PEAK * abs(s)


def same(one: Mode, other: Mode) -> bool:
    """Whether two solutions are the same mode."""
    return abs(one.s - other.s) <= APART * abs(one.s)


def reaching(impedance: Impedance, inertia: float) -> tuple[Impedance, float]:
    """The impedance up to 1.5 times the highest whirl ratio at which the rotor can resonate, and that ratio.

    `inertia` is its least one times the square of the speed [N/m].
    """
    ratios = SCAN.tolist()
    while ratios[-1] < 1.5 * math.sqrt(np.linalg.norm(impedance.at_ratio(ratios[-1]), 2) / inertia):
        ratios.append(ratios[-1] * FARTHER)
    if len(ratios) == len(SCAN):
        return impedance, ratios[-1]
    return Impedance.over(impedance.motion, ratios), ratios[-1]


def polished(impedance: Impedance, rotor: tuple[Inertia, float], s: complex) -> Mode | None:
    """The mode near `s`, by successive linear problems `D v = step D' v`; None without convergence.

    `D = omega^2 (M s^2 + G s) + Z`.
    """
    inertia, speed = rotor
    M, G = inertia.mass * speed**2, inertia.gyroscopic * speed**2
    size = math.inf
    for _ in range(STEPS):
        Z, dZ = impedance.with_derivative(s)
        D, slope = s**2 * M + s * G + Z, 2.0 * s * M + G + dZ
        steps, left, right = la.eig(D, slope, left=True)
        k = int(np.argmin(np.abs(steps)))
        s = complex(s - steps[k])
        before, size = size, float(abs(steps[k])) / abs(s)
        if size <= PRECISION or 0.5 * before <= size <= ROUNDING:
            if s.imag < 0.0 and impedance.motion.loss is not None:
                return None  # a wall that loses energy is described for frequencies above zero
            y, v = left[:, k].conj(), right[:, k]
            share = abs(2.0 * (y @ (s * M + G) @ v) / (y @ slope @ v))
            return Mode(upper(s), float(share), orbit(v if s.imag >= 0.0 else v.conj()), tilt_of(v))
    return None


def upper(s: complex) -> complex:
    """The eigenvalue of a conjugate pair with a positive frequency; a motion without frequency as a real number."""
    return complex(s.real, abs(s.imag) if abs(s.imag) > APART * abs(s) else 0.0)


def tilt_of(v: Complex) -> float:
    """Part of the tilt in a motion, by its square; 0 where the shaft stays parallel."""
    return round(float(np.linalg.norm(v[2:]) ** 2 / np.linalg.norm(v) ** 2), SHARE_DIGITS)


def orbit(v: Complex) -> float:
    """Direction of the ellipse `Re(v exp(i tau))`: its signed area over that of a circle of its size."""
    return float(-2.0 * (v[::2].conj() @ v[1::2]).imag / np.linalg.norm(v) ** 2)
