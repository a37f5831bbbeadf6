"""A journal whose axis is not parallel to the bushing's: held at given slopes, or free to tilt about the centre.

The axis is at `(x, y) + (z - L/2) (a_x, a_y)` (G6). Slopes that are given change the film at rest; a shaft that is free
to tilt has a position of four coordinates, `q = (x, y, l a_x, l a_y)` with the lever `l = L/2`. The forces that belong
to them are the force on the journal and its moments about the bearing's centre over `l`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.walls.base import Wall

Array = NDArray[np.float64]


def misaligned(wall: Wall, tilt: tuple[float, float]) -> Wall:
    """`wall` under a journal whose axis has the slopes `tilt` [rad]; the position still has two coordinates.

    Raises
    ------
    ValueError
        The wall is that of half a length, or of a 2-D film.
    """
    film, slopes = wall.film, np.array(tilt)
    across = tilt[0] * np.cos(film.theta) + tilt[1] * np.sin(film.theta)
    contacts, rest = wall.contacts, wall.contacts.rest.copy()
    rest += tilt_columns(wall, 1.0) @ slopes
    return replace(
        wall,
        rest_film=wall.rest_film - across[:, :, None] * from_centre(wall),
        contacts=replace(contacts, rest=rest),
    )


def tilting(wall: Wall, lever: float) -> Wall:
    """`wall` under a journal that is free to tilt about the bearing's centre; `lever` [m] is the unit of its slopes.

    Raises
    ------
    ValueError
        The wall is that of half a length, or of a 2-D film.
    """
    by_e = np.hstack([wall.contacts.by_e, tilt_columns(wall, lever)])
    return replace(wall, contacts=replace(wall.contacts, by_e=by_e))


def tilt_columns(wall: Wall, lever: float) -> Array:
    """Derivative of all gaps by the slopes of the journal's axis times `lever` [m], (m, 2)."""
    arm, journal = np.zeros(len(wall.contacts.rest)), wall.contacts.journal
    arm[journal] = np.broadcast_to(from_centre(wall) / lever, wall.film.shape).ravel()
    columns: Array = arm[:, None] * wall.contacts.by_e[:, :2]
    return columns


def from_centre(wall: Wall) -> Array:
    """Distance of the axial stations from the bearing's centre, (axial,) [m]."""
    axial = wall.film.axial
    if axial.half or axial.is_2d:
        raise ValueError("half a length and a 2-D film cannot tilt")
    along: Array = axial.z - 0.5 * axial.length
    return along
