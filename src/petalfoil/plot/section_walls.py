"""What bounds the film in a section of the bearing: petals, or the top foil on its bumps, in the bushing."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Wedge

from petalfoil.plot import style
from petalfoil.plot.stretch import Stretch, petal_outline
from petalfoil.plot.views import array, journal_surface, number

_RING = 0.06
"""Thickness of the bushing's ring over its radius."""
BUMPS = 60
"""Bumps drawn round the bore, whatever their pitch."""
LEAST_ROOM = 0.06
"""Least drawn height of the foil over the bushing's radius."""
POINTS = 24
"""Points of a drawn bump."""
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 361)


def foil_room(ds: xr.Dataset, scale: float) -> float:
    """Drawn distance from the free top foil to the bushing behind it; 0 of other walls [m]."""
    if "max_deflection" not in ds:
        return 0.0
    return max(LEAST_ROOM * number(ds, "bushing_radius"), 1.25 * scale * number(ds, "max_deflection"))


def draw_solids(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw bushing and journal."""
    width = _RING * stretch.bore
    ring = Wedge((0.0, 0.0), stretch.bushing + width, 0.0, 360.0, width=width)
    ring.set(facecolor=style.PALE, edgecolor=style.GREY, hatch="////", linewidth=0.8, gid="bushing")
    ax.add_patch(ring)
    surface = stretch.points(journal_surface(ds, _CIRCLE), _CIRCLE)
    ax.fill(*surface.T, facecolor=style.STEEL, edgecolor="none", gid="journal")


def draw_petals(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw the petals of a result that has them, and their roots."""
    if "radius" not in ds:
        return
    half, phi = number(ds, "petal_thickness") / 2, array(ds, "phi")
    radius = array(ds, "radius")
    for petal, root in enumerate(array(ds, "root_angle")):
        outline = petal_outline(radius[petal], root + phi, half, stretch)
        look: style.Look = {
            "facecolor": style.PETALS[petal % 2],
            "edgecolor": style.INK,
            "linewidth": 0.5,
            "gid": f"petal {petal}",
        }
        ax.fill(*outline.T, **look)
    roots = stretch.points(np.full(ds.sizes["petal"], stretch.bore), array(ds, "root_angle"))
    ax.plot(*roots.T, "s", color=style.INK, markersize=5, label="root of a petal", gid="roots", zorder=4)


def draw_foil(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw top foil and bumps of a result that has them, in its mid-plane."""
    if not stretch.foil:
        return
    theta = (array(ds, "root_angle")[:, None] + array(ds, "phi_exposed"))[0]
    radius = stretch.radius(journal_surface(ds, theta) + array(ds, "film_thickness")[0])
    fine = np.linspace(theta[0], theta[-1], BUMPS * POINTS + 1)
    surface = np.interp(fine, theta, radius)
    wave = surface + (stretch.bushing - surface) * 0.5 * (1.0 + np.cos(BUMPS * (fine - fine[0])))
    ax.plot(wave * np.cos(fine), wave * np.sin(fine), color=style.GREY, linewidth=0.9, gid="bumps")
    look: style.Look = {"color": style.INK, "linewidth": 1.2, "gid": "top foil"}
    ax.plot(surface * np.cos(fine), surface * np.sin(fine), **look)
