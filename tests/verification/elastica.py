"""A hinged petal between bore and journal as an elastica: an inextensible arc of any rotation, by `solve_bvp`.

The petal, bent to the curvature `1/R_p`, has its root on the bore, free to turn, and its free edge on the bore, free to
slide. The journal presses its middle outward. Every outer force passes through the axis, so that the petal is
symmetric; half of it is solved. With the force `F` at its end under the angle `a`, and two contacts with the journal
under `+-b` with `N = F cos a / cos b` each, the bending moment at `(x, y)` is

    M = F (x sin a - y cos a) - N (x sin b - y cos b) within the contacts ,      theta' = 1/R_p + M/D

Units: the metric radius and `D` over the length of the bearing are 1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_bvp

from petalfoil.case import Case
from petalfoil.physics.petal_elements import PetalElements
from petalfoil.solvers.lcp import solve_lcp

Array = NDArray[np.float64]
Start = tuple[Array, Array, Array]
"""Mesh, states and parameters."""

STEPS, TOLERANCE = 40, 1e-8
"""Steps from the free petal to the pressed one; relative residual of the boundary value problems."""


def lever(x: Array, y: Array, angle: float) -> Array:
    """Distance of a place from the line through the axis under an angle."""
    return np.asarray(x * np.sin(angle) - y * np.cos(angle))


@dataclass(frozen=True)
class PressedPetal:
    """An arc of a length and a bend radius.

    Attributes
    ----------
    length, bend_radius : float
        Of the petal, over the metric radius.
    """

    length: float
    bend_radius: float

    def free(self) -> tuple[float, Start]:
        """Radius of the middle of the free petal, and its shape as a start."""
        half = 0.5 * self.length / self.bend_radius
        inward, beside = self.bend_radius * (1.0 - np.cos(half)), self.bend_radius * np.sin(half)
        middle = float(np.sqrt(1.0 - beside**2) + inward)
        s = np.linspace(0.0, 1.0, 41)
        x = middle - self.bend_radius * (1.0 - np.cos(half * s))
        y = self.bend_radius * np.sin(half * s)
        return middle, (s, np.array([x, y, 0.5 * np.pi + half * s]), np.array([1e-3, np.arctan2(y[-1], x[-1])]))

    def one_contact(self, radius: float, start: Start) -> Start:
        """The half petal whose middle lies on a journal of `radius`; parameters `F`, `a`."""
        half = 0.5 * self.length

        def rates(_: Array, u: Array, p: Array) -> Array:
            x, y, angle = u
            bent = 1.0 / self.bend_radius + p[0] * lever(x, y, p[1])
            return half * np.array([np.cos(angle), np.sin(angle), bent])

        def ends(a: Array, b: Array, p: Array) -> Array:
            return np.array([a[0] - radius, a[1], a[2] - 0.5 * np.pi, b[0] - np.cos(p[1]), b[1] - np.sin(p[1])])

        return solved(rates, ends, start)

    def two_contacts(self, radius: float, start: Start) -> Start:
        """The half petal, from its middle to the contact and on to its end; `F`, `a`, `b`, arc to the contact."""
        half = 0.5 * self.length

        def rates(_: Array, u: Array, p: Array) -> Array:
            F, a, b, c = p
            within = F * lever(u[0], u[1], a) - F * np.cos(a) / np.cos(b) * lever(u[0], u[1], b)
            beyond = F * lever(u[3], u[4], a)
            inner = c * np.array([np.cos(u[2]), np.sin(u[2]), 1.0 / self.bend_radius + within])
            outer = (half - c) * np.array([np.cos(u[5]), np.sin(u[5]), 1.0 / self.bend_radius + beyond])
            return np.concatenate([inner, outer])

        def ends(u: Array, v: Array, p: Array) -> Array:
            _, a, b, _ = p
            touching = [v[0] - radius * np.cos(b), v[1] - radius * np.sin(b), v[2] - b - 0.5 * np.pi]
            return np.array([
                u[1], u[2] - 0.5 * np.pi, *(v[:3] - u[3:]), *touching, v[3] - np.cos(a), v[4] - np.sin(a)
            ])  # fmt: skip

        return solved(rates, ends, start)

    def normal_force(self, radius: float) -> float:
        """Force of the journal of a mid-surface `radius` on the petal, the sum of both contacts."""
        middle, start = self.free()
        contacts = 1
        for here in np.linspace(middle, radius, STEPS + 1)[1:]:
            start = self.one_contact(here, start) if contacts == 1 else self.two_contacts(here, start)
            F, a = start[2][:2]
            if (
                contacts == 1 and (1.0 / self.bend_radius + F * here * np.sin(a)) * here > 1.0
            ):  # more curved than the journal
                contacts, start = 2, self.two_contacts(here, self.split(here, start))
        F, a, *contact = start[2]
        return float(2.0 * F * np.cos(a) / (np.cos(contact[0]) if contact else 1.0))

    def split(self, radius: float, start: Start) -> Start:
        """The petal of one contact as a start for two."""
        s, u, p = start
        half, apart = 0.5 * self.length, 0.05
        t = np.linspace(0.0, 1.0, 21)
        arcs = apart * radius * t, apart * radius + t * (half - apart * radius)
        parts = [np.interp(arc, half * s, row) for arc in arcs for row in u]
        return t, np.array(parts), np.array([*p, apart, apart * radius])


def solved(rates: object, ends: object, start: Start) -> Start:
    """The boundary value problem from a start."""
    found = solve_bvp(rates, ends, start[0], start[1], p=start[2], tol=TOLERANCE, max_nodes=20_000)
    if not found.success:
        raise ArithmeticError(found.message)
    return found.x, found.y, found.p


NODES = 128
"""Elements of the linear petal; its gaps are looked at on their nodes."""


def pressed_radius(of: Case) -> float:
    """Radius of the mid-surface of a petal on the centred journal [m]."""
    assert of.pack is not None
    return of.bearing.journal_radius + 0.5 * of.pack.thickness + of.surface.contact_film_thickness


def linear_force(of: Case, radius: float) -> float:
    """Force of the journal on one hinged petal whose free edge lies on the bore [N]."""
    assert of.pack is not None
    assert of.petals is not None
    pack, D = of.pack, of.petals.bending_stiffness
    phi = np.linspace(0.0, pack.petal_angle, NODES + 1)
    petal = PetalElements(phi, of.bearing.length, pack.metric_radius, pack.reference_radius, D, clamped=False)
    K = petal.stiffness.toarray()
    free = np.delete(np.arange(len(K)), len(K) - 2)  # the free edge lies on the bore
    inner = np.searchsorted(free, 1 + 2 * np.arange(NODES - 1))
    compliance = np.linalg.inv(K[np.ix_(free, free)])[np.ix_(inner, inner)]
    gaps = pack.free_radius(phi[1:-1]) - radius
    scale = float(np.max(compliance))
    lam = solve_lcp(compliance / scale, gaps, gaps < 0.0)
    assert lam is not None
    return float(lam.sum()) / scale


def elastica_force(of: Case, radius: float) -> float:
    """The same of an elastica of the petal's length [N]."""
    assert of.pack is not None
    assert of.petals is not None
    r_m = of.pack.metric_radius
    petal = PressedPetal(of.petals.arc_length / r_m, of.pack.bend_radius / r_m)
    return petal.normal_force(radius / r_m) * of.petals.bending_stiffness * of.bearing.length / r_m**2
