"""Stability of a rigid rotor on the bearing: `det(Z(i Omega) - m Omega^2) = 0` with a real mass `m` (E6).

In two bearings `det(Z(i Omega) - m Omega^2 (M - i G omega / Omega)) = 0`, with the inertias `M` and `G` over the mass:
the rotor that whirls has its inertias in the same proportion to its mass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.equilibrium.small_motion import JournalMotion

Complex = NDArray[np.complex128]
FloatArray = NDArray[np.float64]

SCAN = np.concatenate([[0.006, 0.012, 0.025], np.linspace(0.05, 1.2, 24), [1.5, 2.0, 3.0]])
"""Whirl ratios between which changes of sign are searched for. Gas bearings whirl near a ratio of a half and below, a
heavy rotor on soft petals far below."""

BEYOND = np.linspace(3.0, 12.0, 10)
"""Whirl ratios at which a whirl that grows at the last ratio of `SCAN` is followed to where it dies out. That of a pack
whose two natural frequencies nearly agree grew between 0.03 and 6; the masses beyond are a sixteenth of the last."""


@dataclass(frozen=True)
class Whirl:
    """A neutral whirl: neither grows nor dies out.

    Attributes
    ----------
    mass : float
        Critical mass of a rigid rotor [kg]: on one bearing, or the whole of one that tilts in two bearings; infinite if
        it is stable for any mass, zero if it whirls at any.
    ratio : float
        Whirl frequency over speed [1]; nan if there is none.
    """

    mass: float
    ratio: float


EVEN_FILM = Whirl(0.0, 0.5)
"""Of a film that is even all round: it exerts no force in a whirl at half the speed."""


def whirl_impedance(motion: JournalMotion) -> Impedance:
    """The impedance over the whirl ratios of `SCAN`."""
    return Impedance.over(motion, SCAN.tolist())


EVEN = 1e-9
"""Difference of the thickness of a film round the bearing, over the thickness, below which it is even."""

POLE = 1e-3
"""Imaginary part over the size of an eigenvalue beyond which a change of its sign is no zero: it passes infinity where
gyroscopic moments cancel inertia."""


NEUTRAL = 1e-3
"""Imaginary part over the size of an eigenvalue at the last whirl ratio within which it is called neutral: damping as
small as that has an error of its size on coarse grids."""


@dataclass(frozen=True)
class Balance:
    """Impedance against inertia at each whirl ratio.

    Attributes
    ----------
    impedance : Impedance
        The bearing, or both.
    inertia : Inertia or None
        That of a rotor that tilts; None for a mass alone.
    """

    impedance: Impedance
    inertia: Inertia | None = None

    def eigenvalues(self, nu: float) -> Complex:
        """Masses times the square of the whirl frequency that balance the impedance at whirl ratio `nu`, (d,) [N/m]."""
        return eigenvalues(self.impedance.at_ratio(nu), nu, self.inertia)

    @property
    def over_ratios(self) -> Complex:
        """The same at the whirl ratios that the impedance is made for, (k, d)."""
        return eigenvalues(self.impedance.over_ratios, self.impedance.ratios, self.inertia)


def eigenvalues(Z: Complex, nu: float | FloatArray, inertia: Inertia | None) -> Complex:
    """Masses times the square of the whirl frequency that balance an impedance, (..., d) [N/m].

    `Z` is (..., d, d), at whirl ratios `nu` (...).
    """
    if inertia is None:
        return np.asarray(np.linalg.eigvals(Z), dtype=np.complex128)
    shape = (inertia.mass - 1j * inertia.gyroscopic / np.asarray(nu)[..., None, None]) / inertia.mass[0, 0]
    inverse = np.linalg.eigvals(np.linalg.solve(Z, shape))
    return np.asarray(1.0 / np.where(inverse == 0.0, np.finfo(float).tiny, inverse), dtype=np.complex128)


def whirls_at_any_mass(motion: JournalMotion) -> bool:
    """Whether a rotor of any mass whirls at half the speed: the film is even all round, and no wall deflects.

    In the frame that turns at half the speed the two surfaces of such a film move equally fast in opposite directions:
    nothing is dragged into it, and it exerts no force.
    """
    H = motion.film_thickness
    return motion.problem.layout.n_wall == 0 and bool(np.ptp(H) <= EVEN * np.max(H))


def neutral_whirl(impedance: Impedance, speed: float, inertia: Inertia | None = None) -> Whirl:
    """Find the critical rotor mass; with `inertia` that of a rotor whose inertias are in the same proportion.

    At the threshold one eigenvalue of `Z(i Omega)` is real and equals `m Omega^2`. The branches of the imaginary parts
    are followed over whirl ratio, and their zeros bracketed. The mass is the smallest that whirls: where a branch with
    a positive mass still has a negative imaginary part at the last ratio, lighter rotors whirl, and the search goes on.
    """
    if whirls_at_any_mass(impedance.motion):
        return EVEN_FILM
    roots, last = neutral_whirls(Balance(impedance, inertia), speed)
    if grows(last):
        further = Impedance.over(impedance.motion, BEYOND.tolist())
        lighter, last = neutral_whirls(Balance(further, inertia), speed)
        roots += lighter
        if inertia is None and grows(last):
            return Whirl(0.0, np.nan)
    return min(roots, key=lambda root: root.mass, default=Whirl(np.inf, np.nan))


def least_damping(impedance: Impedance, inertia: Inertia | None = None) -> FloatArray:
    """Least loss of a whirl of any positive mass at each ratio of an impedance, (ratio,) [1]; infinite without one.

    The loss is the imaginary part of a mass that balances the impedance over its size.
    """
    values = Balance(impedance, inertia).over_ratios
    return np.asarray(np.min(values.imag / np.abs(values), axis=1, where=values.real > 0.0, initial=np.inf))


def grows(values: Complex) -> bool:
    """Whether a rotor of one of the masses that balance the impedance whirls ever wider."""
    return bool(np.any((values.imag < -NEUTRAL * np.abs(values)) & (values.real > 0.0)))


def neutral_whirls(balance: Balance, speed: float) -> tuple[list[Whirl], Complex]:
    """All neutral whirls between the whirl ratios of an impedance, and the eigenvalues at the last one, (d,)."""
    roots: list[Whirl] = []
    values, ratios = balance.over_ratios, balance.impedance.ratios
    for k in range(len(ratios) - 1):
        ahead = matched(values[k], values[k + 1])
        for branch in range(len(ahead)):
            if np.sign(values[k][branch].imag) != np.sign(ahead[branch].imag):
                roots += crossing(balance, (ratios[k], ratios[k + 1]), values[k][branch], speed)
        values[k + 1] = ahead
    return roots, values[-1]


def matched(before: Complex, after: Complex) -> Complex:
    """`after`, ordered so that each eigenvalue continues its own branch."""
    from scipy.optimize import linear_sum_assignment  # 0.2 s: only where it is needed

    out: Complex = after[linear_sum_assignment(np.abs(before[:, None] - after[None, :]))[1]]
    return out


def crossing(balance: Balance, between: tuple[float, float], start: complex, speed: float) -> list[Whirl]:
    """The neutral whirl in a bracket of whirl ratios, if it belongs to a positive mass.

    A branch whose imaginary part rises through zero at a negative stiffness has passed the imaginary axis below it,
    where its mass is zero and the whirl grows: a rotor of any mass whirls.
    """
    from scipy.optimize import brentq  # 0.2 s: only where it is needed

    nearest = start

    def imaginary(nu: float) -> float:
        values = balance.eigenvalues(nu)
        return float(values[np.argmin(np.abs(values - nearest))].imag)

    low, high = imaginary(between[0]), imaginary(between[1])
    if np.sign(low) == np.sign(high):
        return []
    nu = float(brentq(imaginary, *between, xtol=1e-6, rtol=1e-8))
    values = balance.eigenvalues(nu)
    neutral = values[np.argmin(np.abs(values.imag))]
    mass = float(neutral.real) / (nu * speed) ** 2
    if abs(neutral.imag) > POLE * abs(neutral):
        return []
    if mass <= 0.0:
        return [Whirl(0.0, nu)] if balance.inertia is None and low < 0.0 else []
    return [Whirl(mass, nu)]
