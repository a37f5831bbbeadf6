"""Stiffness of one bump of a bump foil, a circular arc on two feet under a line load on its crown.

A bump of half length `l`, half angle `t_0` and radius `R = l / sin t_0` has, at the angle `t` from its crown, the lever
`R (sin t_0 - sin t)` and the height `R (cos t - cos t_0)` over its feet. Castigliano's theorem with the bending moment
`M = F x / 2 - H y` of a line load `F` and the thrust `H` of the feet gives

    crown  w = (R^3 / D) (A F / 2 - B H)                                                          (B1)
    feet   u = (2 R^3 / D) (B F / 2 - C H)                                                        (B2)

    A = int (sin t_0 - sin t)^2 dt ,  B = int (sin t_0 - sin t) (cos t - cos t_0) dt ,
    C = int (cos t - cos t_0)^2 dt      from 0 to t_0                                             (B3)

`H = 0` on feet that slide freely, `u = 0` on feet that are held, `H = +-mu F / 2` on feet that slide with friction. The
shallow free bump has `6 D / l^3`, the stiffness of Walowit and Anno (1975). The membrane force of a held bump,
`N = H cos t + F/2 sin t`, adds `(t_f / R)^2 / 12` times its own integrals to (B3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class BumpStrip:
    """One bump, per unit of length along the shaft.

    Attributes
    ----------
    half_length : float
        `l`, half the chord between its feet [m].
    half_angle : float
        `t_0`, between crown and foot [rad].
    thickness : float
        Of its metal, `t_f` [m].
    rigidity : float
        `D = E t_f^3 / (12 (1 - nu^2))` [N m].
    """

    half_length: float
    half_angle: float
    thickness: float
    rigidity: float

    @property
    def radius(self) -> float:
        """`R` [m]."""
        return self.half_length / math.sin(self.half_angle)

    @property
    def height(self) -> float:
        """From the feet to the crown [m]."""
        return self.radius * (1.0 - math.cos(self.half_angle))

    @property
    def integrals(self) -> tuple[float, float, float]:
        """`A`, `B`, `C` (B3) of bending [1]."""
        t0, s, c = self.half_angle, math.sin(self.half_angle), math.cos(self.half_angle)
        squared = 0.5 * (t0 - s * c)  # int sin^2
        A = s**2 * t0 - 2.0 * s * (1.0 - c) + squared
        B = s**2 - s * c * t0 - 0.5 * s**2 + c * (1.0 - c)
        C = t0 - squared - 2.0 * c * s + c**2 * t0
        return A, B, C

    @property
    def membrane_integrals(self) -> tuple[float, float, float]:
        """What the membrane force adds to `A`, `-B` and `C` [1]."""
        t0, s, c = self.half_angle, math.sin(self.half_angle), math.cos(self.half_angle)
        slender = (self.thickness / self.radius) ** 2 / 12.0
        return slender * 0.5 * (t0 - s * c), slender * 0.5 * s**2, slender * 0.5 * (t0 + s * c)

    @property
    def free_stiffness(self) -> float:
        """Line load over deflection of the crown, the feet sliding freely (B1) [N/m per m]."""
        return self._stiffness(self.integrals[0])

    def held_stiffness(self, *, membrane: bool = True) -> float:
        """The same with both feet held (B2), with the strain of the metal along the arc or without [N/m per m]."""
        A, B, C = self.integrals
        if membrane:
            more = self.membrane_integrals
            A, B, C = A + more[0], B - more[1], C + more[2]
        return self._stiffness(A - B**2 / C)

    def sliding_stiffness(self, friction: float, *, loading: bool) -> float:
        """The same while the feet slide with a friction coefficient, under a growing or a falling load [N/m per m].

        Raises
        ------
        ValueError
            The feet stick: the friction coefficient is `sticking_friction` or more.
        """
        if not 0.0 <= friction < self.sticking_friction:
            raise ValueError(
                f"feet stick at a friction coefficient of {friction:g}: they slide below {self.sticking_friction:.4g}"
            )
        A, B, _ = self.integrals
        return self._stiffness(A - friction * B if loading else A + friction * B)

    @property
    def sticking_friction(self) -> float:
        """Friction coefficient of the feet from which on they stick, `B / C` [1]."""
        _, B, C = self.integrals
        return B / C

    def _stiffness(self, compliance: float) -> float:
        """`2 D / (R^3 compliance)`."""
        return 2.0 * self.rigidity / (self.radius**3 * compliance)
