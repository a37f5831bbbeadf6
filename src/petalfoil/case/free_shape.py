"""Free shape of a petal: the radius of its unloaded mid-surface over the angle from its root.

A petal made to a bend radius is a circular arc (equations (14)–(17) of the paper). In the petal's own frame, root on
the x-axis, its centre and radius are (G3)::

    C = (r_m − R_p cos ψ, −R_p sin ψ)
    r0(φ) = c + sqrt(c² − |C|² + R_p²),     c = C·(cos φ, sin φ)

with `r_m` the metric radius, `R_p` the bend radius and `ψ` the root tilt, turned inward from the tangent of the bore.
A measured free shape is a table instead: `measured_shape`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


def chordal_tilt(metric_radius: float, bend_radius: float, petal_angle: float) -> float:
    """Return the root tilt that lays the free edge on the bore, ``r0(φ1) = r_m`` [rad].

    Root and free edge are then the ends of a chord of the bore. The chord makes the angle ``φ1/2`` with the tangent of
    the bore and ``asin(r_m sin(φ1/2) / R_p)`` with the tangent of the arc; the tilt is the difference (G4)::

        ψ = φ1/2 − asin(r_m sin(φ1/2) / R_p)

    Parameters
    ----------
    metric_radius : float
        `r_m` [m].
    bend_radius : float
        `R_p` [m], at least ``r_m sin(φ1/2)``; it exceeds `r_m` where the arc is to stand off the bore.
    petal_angle : float
        `φ1` [rad], below π.
    """
    half = petal_angle / 2.0
    return half - math.asin(metric_radius * math.sin(half) / bend_radius)


def arc_radius(phi: ArrayLike, *, metric_radius: float, bend_radius: float, tilt: float) -> FloatArray:
    """Return the mid-surface radius of a free arc, `r0` of the module's docstring [m].

    Parameters
    ----------
    phi : array_like
        Angles from the root [rad], inside `arc_reach`.
    metric_radius, bend_radius : float
        `r_m`, `R_p` [m].
    tilt : float
        `ψ` [rad].
    """
    angle = np.asarray(phi, dtype=np.float64)
    x, y = _centre(metric_radius, bend_radius, tilt)
    c = x * np.cos(angle) + y * np.sin(angle)
    # R_p² − |C|², written so that it does not cancel where R_p is far larger than r_m
    excess = metric_radius * (2.0 * bend_radius * math.cos(tilt) - metric_radius)
    root = np.sqrt(c**2 + excess)
    # For c < 0 the sum c + root cancels; its conjugate does not.
    with np.errstate(divide="ignore", invalid="ignore"):
        radius: FloatArray = np.where(c < 0.0, excess / (root - c), c + root)
    return radius


def pulled_down_radius(phi: ArrayLike, *, metric_radius: float, bend_radius: float, tilt: float) -> FloatArray:
    """Return the radius of the free mid-surface in a theory that is linear about the bore [m].

    Its curvature `1/r_m − (w'' + w)/r_m²`, ``w = r0 − r_m``, is that of the bend radius, whatever it stands off (G7)::

        r0 = r_m + r_m (1 − r_m/R_p) (1 − cos φ) − r_m ψ sin φ

    Parameters
    ----------
    phi : array_like
        Angles from the root [rad].
    metric_radius, bend_radius : float
        `r_m`, `R_p` [m].
    tilt : float
        `ψ` [rad].
    """
    angle = np.asarray(phi, dtype=np.float64)
    flatter = metric_radius * (1.0 - metric_radius / bend_radius)
    return np.asarray(metric_radius + flatter * (1.0 - np.cos(angle)) - metric_radius * tilt * np.sin(angle))


def pulled_down_tilt(metric_radius: float, bend_radius: float, petal_angle: float) -> float:
    """Return the root tilt that lays the free edge of `pulled_down_radius` on the bore [rad]."""
    return (1.0 - metric_radius / bend_radius) * math.tan(0.5 * petal_angle)


def arc_reach(*, metric_radius: float, bend_radius: float, tilt: float) -> float:
    """Return the angle at which a free arc turns back on the angle [rad]; infinite where it goes round the axis.

    The ray at angle `φ` meets the arc's circle while ``|sin(φ − β)| < R_p / |C|`` with `β` the direction of `C`.
    """
    x, y = _centre(metric_radius, bend_radius, tilt)
    distance = math.hypot(x, y)
    if distance < bend_radius:
        return math.inf
    return math.atan2(y, x) + math.asin(bend_radius / distance)


def _centre(metric_radius: float, bend_radius: float, tilt: float) -> tuple[float, float]:
    """Centre `C` of the arc in the petal's frame [m]."""
    return metric_radius - bend_radius * math.cos(tilt), -bend_radius * math.sin(tilt)
