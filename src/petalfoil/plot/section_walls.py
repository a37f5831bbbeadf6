"""What bounds the film in a section of the bearing: petals, or the top foil on its bumps, in the bushing.

Springs are drawn with some round number of bumps, whatever their pitch: what counts is where their crowns are.
"""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import Wedge

from petalfoil.plot import style
from petalfoil.plot.stretch import Floats, Stretch, petal_outline
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
    """Drawn distance from the free top foil, or the roots of backed petals, to the bushing behind; else 0 [m]."""
    if not {"max_deflection", "backing_deflection", "foundation_stiffness"} & set(ds.variables):
        return 0.0
    pressed = next((name for name in ("max_deflection", "max_backing_deflection") if name in ds), None)
    needed = 0.0 if pressed is None else 1.25 * scale * number(ds, pressed)
    inside = scale * number(ds, "backing_height") if "backing_height" in ds else 0.0
    return max(LEAST_ROOM * number(ds, "bushing_radius") - inside, needed - inside, 0.0)


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


def draw_backing(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw the backing springs of a result that has them, from their crowns to the bushing."""
    if "backing_deflection" not in ds:
        return
    roots, phi, bore = array(ds, "root_angle"), array(ds, "phi"), number(ds, "bushing_radius")
    start, end = number(ds, "backing_start") / bore, 2.0 * np.pi / len(roots)
    bumps = max(round(BUMPS * (end - start) / (2.0 * np.pi)), 1)
    fine = np.linspace(start, end, bumps * POINTS + 1)
    turns = np.linspace(0.0, bumps, len(fine))
    for petal, root in enumerate(roots):
        pressed = np.interp(fine, phi, array(ds, "backing_deflection")[petal])
        wave = bump_wave(stretch.radius(bore - number(ds, "backing_height") + pressed), stretch, turns)
        ax.plot(wave * np.cos(root + fine), wave * np.sin(root + fine), color=style.GREY, linewidth=0.9, gid="backing")


def bump_wave(crowns: Floats, stretch: Stretch, turns: Floats) -> Floats:
    """Drawn radius of a corrugated strip between its crowns and the bushing, `turns` bumps from a foot on [m]."""
    return crowns + (stretch.bushing - crowns) * 0.5 * (1.0 + np.cos(2.0 * np.pi * turns))


def draw_foil(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw top foil and bumps of a result that has them, in its mid-plane."""
    if "max_deflection" not in ds:
        return
    theta = (array(ds, "root_angle")[:, None] + array(ds, "phi_exposed"))[0]
    radius = stretch.radius(journal_surface(ds, theta) + array(ds, "film_thickness")[0])
    _draw_bumps(ax, theta, radius, stretch)


def draw_free_foil(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw top foil and bumps as they are without load, of a result of a bump foil that has no film."""
    if "foundation_stiffness" in ds and "radius" not in ds:
        _draw_bumps(ax, _CIRCLE, np.full(_CIRCLE.shape, stretch.bore), stretch)


def _draw_bumps(ax: Axes, theta: Floats, radius: Floats, stretch: Stretch) -> None:
    """Draw a top foil of the drawn `radius` over `theta`, and bumps between it and the bushing."""
    fine = np.linspace(theta[0], theta[-1], BUMPS * POINTS + 1)
    surface = np.interp(fine, theta, radius)
    wave = bump_wave(surface, stretch, BUMPS * (fine - fine[0]) / (2.0 * np.pi))
    ax.plot(wave * np.cos(fine), wave * np.sin(fine), color=style.GREY, linewidth=0.9, gid="bumps")
    look: style.Look = {"color": style.INK, "linewidth": 1.2, "gid": "top foil"}
    ax.plot(surface * np.cos(fine), surface * np.sin(fine), **look)
