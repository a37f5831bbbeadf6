"""Stability of a rigid rotor on the bearing: `det(Z(i Omega) - m Omega^2) = 0` with a real mass `m` (E6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, linear_sum_assignment

from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.equilibrium.linear_response import SmallMotion

Complex = NDArray[np.complex128]

SCAN = np.concatenate([[0.006, 0.012, 0.025], np.linspace(0.05, 1.2, 24), [1.5, 2.0, 3.0]])
"""Whirl ratios between which changes of sign are searched for. Gas bearings whirl near a ratio of a half and below, a
heavy rotor on soft petals far below."""


@dataclass(frozen=True)
class Whirl:
    """A neutral whirl: neither grows nor dies out.

    Attributes
    ----------
    mass : float
        Mass of the rigid rotor on this bearing [kg]; infinite if it is stable for any mass.
    ratio : float
        Whirl frequency over speed [1]; nan if there is none.
    """

    mass: float
    ratio: float


def whirl_impedance(motion: SmallMotion) -> Impedance:
    """The impedance over the whirl ratios of `SCAN`."""
    return Impedance.over(motion, SCAN.tolist())


def neutral_whirl(impedance: Impedance, speed: float) -> Whirl:
    """Find the critical rotor mass.

    At the threshold one eigenvalue of `Z(i Omega)` is real and equals `m Omega^2`. The branches of the imaginary parts
    are followed over whirl ratio, and their zeros bracketed.
    """
    roots: list[Whirl] = []
    values = [eigenvalues(impedance, nu) for nu in SCAN]
    for k in range(len(SCAN) - 1):
        ahead = matched(values[k], values[k + 1])
        for branch in range(len(ahead)):
            if np.sign(values[k][branch].imag) != np.sign(ahead[branch].imag):
                roots += crossing(impedance, (SCAN[k], SCAN[k + 1]), values[k][branch], speed)
        values[k + 1] = ahead
    return min(roots, key=lambda root: root.mass, default=Whirl(np.inf, np.nan))


def eigenvalues(impedance: Impedance, nu: float) -> Complex:
    """Eigenvalues of the impedance at whirl ratio `nu`, (d,) [N/m]."""
    return np.asarray(np.linalg.eigvals(impedance.at_ratio(nu)), dtype=np.complex128)


def matched(before: Complex, after: Complex) -> Complex:
    """`after`, ordered so that each eigenvalue continues its own branch."""
    out: Complex = after[linear_sum_assignment(np.abs(before[:, None] - after[None, :]))[1]]
    return out


def crossing(impedance: Impedance, between: tuple[float, float], start: complex, speed: float) -> list[Whirl]:
    """The neutral whirl in a bracket of whirl ratios, if it belongs to a positive mass."""
    nearest = start

    def imaginary(nu: float) -> float:
        values = eigenvalues(impedance, nu)
        return float(values[np.argmin(np.abs(values - nearest))].imag)

    low, high = imaginary(between[0]), imaginary(between[1])
    if np.sign(low) == np.sign(high):
        return []
    nu = float(brentq(imaginary, *between, xtol=1e-6, rtol=1e-8))
    values = eigenvalues(impedance, nu)
    mass = float(values[np.argmin(np.abs(values.imag))].real) / (nu * speed) ** 2
    return [Whirl(mass, nu)] if mass > 0.0 else []
