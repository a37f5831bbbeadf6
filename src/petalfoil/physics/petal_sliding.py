"""Sliding of curved petals along themselves, 2-D: the tangential displacement `V` and the membrane force `N`.

An arc of radius `R_p` that bends also moves along itself. With the arc length `s = r_m phi`

    V_s + W / R_p = N / B ,      B = E_y delta_0 / (1 - nu^2) = 12 D / delta_0^2 ,      V = 0 at the root    (M1)

`N` is an unknown of its own (Hellinger-Reissner) that is in equilibrium from the start: along a petal it changes only
where friction pulls. With tangential forces `F_d` at `s_d` on a petal of length `L` along the shaft

    V(s) = - (1 / R_p) int_0^s W ds + sum_d min(s, s_d) / (B L) F_d                                          (M2)

exactly. No strain of an element is forced to zero, so that nothing locks as a petal becomes thin. Without friction `N`
vanishes, and the petal is the inextensible one. The curvature is that of (S2), in which `V_s` stands for `- W / R_p`:
what is left out is a part `(delta_0 / R_p)^2 / 12` of the energy.

Cross-sections turn by `W_s - V / R_p`. A face, half a thickness from the mid-surface, moves along the petal by

    u_outer, u_inner = V -+ delta/2 (W_s - V / R_p)                                                          (M3)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.mesh import hermite

Array = NDArray[np.float64]
Index = NDArray[np.intp]

OUTER, INNER = 1.0, -1.0
"""Sides of a petal: toward the bushing, toward the journal."""


@dataclass(frozen=True)
class Faces:
    """Faces of petals, one value for each petal.

    Attributes
    ----------
    half_thickness : (count,) array
        `delta / 2`, coating included [m].
    metric_radius, bend_radius : (count,) array
        `r_m` and `R_p` [m].
    membrane : (count,) array
        Membrane stiffness `B` [N/m].
    slides : bool
        Petals also move along themselves (M1); otherwise their faces only turn.
    """

    half_thickness: Array
    metric_radius: Array
    bend_radius: Array
    membrane: Array
    slides: bool = True

    @property
    def arm(self) -> Array:
        """Slip on a face by the slope `W_phi`, (count,) [1]."""
        out: Array = self.half_thickness / self.metric_radius
        return out

    def share(self, petal: Index, side: Array) -> Array:
        """Part of `V` in the slip of faces on what they touch: `-side u` by `V` (M3), (f,)."""
        turned = (self.half_thickness / self.bend_radius)[petal]
        return np.asarray((-side - turned) * float(self.slides))


@dataclass(frozen=True)
class FacePlaces:
    """Places on faces of petals of Hermite elements.

    Attributes
    ----------
    petal, element : (f,) int array
        Petal, and its element from the root.
    place : (f,) array
        Place in the element.
    side : (f,) array
        `OUTER` or `INNER`.
    """

    petal: Index
    element: Index
    place: Array
    side: Array


def slide_by_integral(faces: Faces, petal: Index, side: Array) -> Array:
    """Slip of faces by the integral of `W` over the angle from the root, (f,) [1/rad]."""
    return np.asarray(-(faces.metric_radius / faces.bend_radius)[petal] * faces.share(petal, side))


def face_slip(faces: Faces, at: FacePlaces, angle: Array) -> Array:
    """Slip `-side u` without membrane force, from nodal (value, slope) pairs of each face's own petal.

    `angle` (n_element,) is that of the elements [rad]; shape (f, 2 n_node).
    """
    columns, turned = hermite.entries(at.element, at.place, angle, 1)
    arm = faces.arm[at.petal] / angle[at.element]
    out = slide_by_integral(faces, at.petal, at.side)[:, None] * hermite.integrals(at.element, at.place, angle)
    out[np.arange(len(arm))[:, None], columns] += arm[:, None] * turned
    return np.asarray(out)


def face_slip_by_place(faces: Faces, at: FacePlaces, angle: Array) -> Array:
    """Derivative of `face_slip` by the place in the element, (f, 2 n_node)."""
    columns, value = hermite.entries(at.element, at.place, angle)
    bend, own = hermite.entries(at.element, at.place, angle, 2)[1], angle[at.element]
    along, out = slide_by_integral(faces, at.petal, at.side) * own, np.zeros((len(own), 2 * len(angle) + 2))
    bent = (faces.arm[at.petal] / own)[:, None] * bend + along[:, None] * value
    out[np.arange(len(own))[:, None], columns] = bent
    return out


def face_compliance(faces: Faces, at: FacePlaces, angle: Array, length: float) -> Array:
    """Slip that friction forces on faces take back by stretching their petals (M2), (f, f) [m/N]."""
    nodes = np.append(0.0, np.cumsum(angle))
    arc = faces.metric_radius[at.petal] * (nodes[at.element] + at.place * angle[at.element])
    share, stretch = faces.share(at.petal, at.side), faces.membrane[at.petal] * length
    same = at.petal[:, None] == at.petal
    return np.where(same, np.minimum.outer(arc, arc) / stretch * np.multiply.outer(share, share), 0.0)


def face_compliance_by_place(faces: Faces, at: FacePlaces, angle: Array, length: float) -> Array:
    """Derivative of `face_compliance` by the place in the element of the first face of each pair, (f, f) [m/N].

    It jumps where two faces are at the same place, and has the mean there.
    """
    nodes = np.append(0.0, np.cumsum(angle))
    along = faces.metric_radius[at.petal] * angle[at.element]
    arc = faces.metric_radius[at.petal] * (nodes[at.element] + at.place * angle[at.element])
    share, stretch = faces.share(at.petal, at.side), faces.membrane[at.petal] * length
    before, same = 0.5 - 0.5 * np.sign(arc[:, None] - arc), at.petal[:, None] == at.petal
    return np.where(same, before * (along / stretch)[:, None] * np.multiply.outer(share, share), 0.0)
