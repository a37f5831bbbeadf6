"""Half of an arch on a flat, its crown held: what tests of sliding and stretching petals share.

The arch is a petal clamped at its crown. Its foot stands on a frictional flat at right angles to the axis of the crown;
the foot's forces `V` (up) and `H` (inward) act along and across the petal there. Units: `R = D = L = 1`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh import hermite
from petalfoil.physics.petal_elements import PetalElements
from petalfoil.physics.petal_sliding import OUTER, FacePlaces, Faces, face_compliance, face_slip

Array = NDArray[np.float64]


def mid_surface(membrane: float) -> Faces:
    """Faces that have no thickness: their slip is `-V`."""
    one = np.ones(1)
    return Faces(0.0 * one, one, one, membrane * one)


@dataclass(frozen=True)
class HalfArch:
    """An arch of half angle `t0` and slenderness `R / t`, in Hermite elements.

    All motions are those of the foot seen from the crown: `up` and `out` of the chord, linear in the loads.
    """

    t0: float
    slenderness: float
    elements: int = 32

    @cached_property
    def petal(self) -> PetalElements:
        """Its bending."""
        return PetalElements(np.linspace(0.0, self.t0, self.elements + 1), 1.0, 1.0, 1.0, 1.0, clamped=True)

    @property
    def foot(self) -> FacePlaces:
        """The foot as a place on a face."""
        return FacePlaces(np.zeros(1, dtype=int), np.array([self.elements - 1]), np.ones(1), np.array([OUTER]))

    @cached_property
    def rows(self) -> tuple[Array, Array, Array]:
        """`W` and `V` at the foot and `int W ds` from the unknowns, without membrane force."""
        angle, nodal, at = self.petal.element_angle, self.petal.nodal, self.foot
        W = hermite.rows(at.element, at.place, angle) @ nodal
        V = -(face_slip(mid_surface(self.membrane), at, angle) @ nodal)
        area = hermite.integrals(at.element, at.place, angle) @ nodal
        return W.toarray()[0], V[0], area[0]

    @property
    def membrane(self) -> float:
        """`B = 12 D / t^2`."""
        return 12.0 * self.slenderness**2

    @cached_property
    def compliance(self) -> Array:
        """(out, up) of the foot and the area swept by a pressure, by (V, H, q); what turns the foot as a last row."""
        (W, V, area), c, s = self.rows, math.cos(self.t0), math.sin(self.t0)
        stretch = face_compliance(mid_surface(self.membrane), self.foot, self.petal.element_angle, 1.0)[0, 0]
        loads = np.column_stack([c * W - s * V, -s * W - c * V, -area])
        w = np.linalg.solve(self.petal.stiffness.toarray(), loads)
        along = np.array([-s, -c, 0.0])  # tangential forces
        radial, tangential = W @ w, V @ w + stretch * along
        out, up = s * radial + c * tangential, c * radial - s * tangential
        slope = np.zeros(len(W))
        slope[-1] = 1.0 / self.petal.slope_angle
        turn = slope @ w - tangential
        return np.vstack([out, up, -(area @ w) + s * up, turn])

    @cached_property
    def tip_compliance(self) -> tuple[Array, Array, Array]:
        """(W, -V) of the tip across and along itself, by a reaction inward, by a pull against `-V`, and by a pressure.

        Signs are such that reaction and friction lessen what the pressure does: `(W, s) = q by_q - N by_N - T by_T`.
        """
        W, V, area = self.rows
        stretch = face_compliance(mid_surface(self.membrane), self.foot, self.petal.element_angle, 1.0)[0, 0]
        w = np.linalg.solve(self.petal.stiffness.toarray(), np.column_stack([W, -V, area]))
        both = np.vstack([W @ w, -V @ w])
        both[1, 1] += stretch
        return both[:, 0], both[:, 1], both[:, 2]

    def loss(self, mu: float, gap: float, ends: tuple[float, float]) -> float:
        """Energy lost in a closed cycle of pressure between `ends` by the leaf on its tip, a `gap` before the wall.

        It slips along `T = +-mu N`, and sticks in between.
        """
        by_V, by_H, by_q = self.tip_compliance  # (W, -V) of the tip by -N, -T, q
        give = np.column_stack([by_V, by_H])

        def forces(q: float, slip: float | None, sign: float) -> tuple[float, float, float]:
            """Reaction, friction and slip at a pressure, sticking at a slip or slipping with a sign."""
            if slip is None:
                N = (by_q[0] * q - gap) / (give[0, 0] + sign * mu * give[0, 1])
                T = sign * mu * N
            else:
                N, T = np.linalg.solve(give, by_q * q - np.array([gap, slip]))
            return float(N), float(T), float(by_q[1] * q - give[1] @ [N, T])

        def leaves(slip: float, sign: float, a: float, b: float) -> float:
            """Pressure at which the stuck tip begins to slip with `sign`: where `T = sign mu N`, linear in pressure."""
            miss = [T - sign * mu * N for N, T, _ in (forces(q, slip, 0.0) for q in (a, b))]
            return float(a + (b - a) * miss[0] / (miss[0] - miss[1]))

        low, high = ends
        top, bottom = forces(high, None, 1.0), forces(low, None, -1.0)
        back = forces(leaves(top[2], -1.0, high, low), None, -1.0)
        forth = forces(leaves(bottom[2], 1.0, low, high), None, 1.0)
        return sum(0.5 * abs(a[1] + b[1]) * abs(a[2] - b[2]) for a, b in ((back, bottom), (forth, top)))

    def under(self, V: float, H: float, q: float) -> Array:
        """(out, up, area swept, turn of the foot) under forces of the foot and a pressure on the arch."""
        return np.asarray(self.compliance @ np.array([V, H, q]))

    def pressed(self, q: float = 1.0, friction: float = 0.0) -> Array:
        """The same under a pressure, which its foot carries, the foot slipping outward against `friction`."""
        V = q * math.sin(self.t0)
        return self.under(V, friction * V, q)

    def held(self, V: float, q: float) -> Array:
        """The same with a foot that does not slip."""
        free, unit = self.under(V, 0.0, q), self.under(0.0, 1.0, 0.0)
        return self.under(V, -free[0] / unit[0], q)
