"""Hysteresis of a package with friction between its petals: loading, unloading, loading again."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.curves import along
from petalfoil.plot.reading import Floats, array

LEGS = {"loading": (style.GREY, "--"), "unloading": (style.BLUE, "-"), "reloading": (style.VERMILLION, "-")}
"""Colour and line of each part of the way."""


def is_loop(ds: xr.Dataset) -> bool:
    """Whether a static curve goes there, back and there again."""
    return "leg" in ds and {"unloading", "reloading"} <= set(ds["leg"].to_numpy().tolist())


def hysteresis(ds: xr.Dataset) -> Figure:
    """Draw the reaction along a loop, and how far both ways stand from their mean.

    Parameters
    ----------
    ds : xarray.Dataset
        Static curve of a package with friction, made as a loop.

    Returns
    -------
    matplotlib.figure.Figure
        Reaction against displacement; the part of it that friction turns with the direction.

    Raises
    ------
    UsageError
        The dataset is no loop.
    """
    if not is_loop(ds):
        raise UsageError("a hysteresis needs a static curve with friction, made as a loop")
    fig = style.figure(8.0, 6.2)
    above, below = fig.subplots(2, 1, sharex=True)
    ways = {leg: way(ds, leg) for leg in LEGS}
    for leg, (e, force) in ways.items():
        colour, line = LEGS[leg]
        above.plot(e, force, color=colour, linestyle=line, linewidth=1.6, marker="o", markersize=3.5, label=leg)
    draw_apart(below, ways["unloading"], ways["reloading"])
    style.dress(above, "", "reaction against the displacement [N]")
    style.dress(below, "eccentricity  e [µm]", "less the mean of both ways [N]")
    style.legend(above, loc="upper left")
    style.set_title(fig, ds, "friction between petals", f"a cycle loses {cycle(ds):.3g} µJ", style.grid_fact(ds))
    return fig


def way(ds: xr.Dataset, leg: str) -> tuple[Floats, Floats]:
    """Displacement [µm] and reaction along it [N] of one leg, the turning point before it included."""
    legs = ds["leg"].to_numpy().tolist()
    chosen = [number for number, name in enumerate(legs) if name == leg]
    first = max(chosen[0] - 1, 0)
    points = np.arange(first, chosen[-1] + 1)
    e = np.stack([array(ds, "eccentricity_x"), array(ds, "eccentricity_y")])
    far = e[:, int(np.argmax(np.hypot(*e)))]
    against: Floats = -(far / np.hypot(*far)) @ np.stack([array(ds, "force_x"), array(ds, "force_y")])
    return along(ds)[points] * 1e6, against[points]


def draw_apart(ax: Axes, back: tuple[Floats, Floats], again: tuple[Floats, Floats]) -> None:
    """Draw both ways of a cycle less their mean."""
    e = np.sort(again[0])
    unloading, loading = np.interp(e, back[0][::-1], back[1][::-1]), np.interp(e, *again)
    mean = 0.5 * (loading + unloading)
    for leg, force in (("unloading", unloading), ("reloading", loading)):
        ax.plot(e, force - mean, color=LEGS[leg][0], linewidth=1.6, marker="o", markersize=3.5)
    ax.axhline(0.0, color=style.GREY, linewidth=0.6, zorder=0)


def cycle(ds: xr.Dataset) -> float:
    """Energy lost from the end of loading to the end of reloading [µJ]."""
    legs, lost = ds["leg"].to_numpy().tolist(), array(ds, "petal_friction_work")
    begin = max(number for number, name in enumerate(legs) if name == "loading")
    return float(lost[-1] - lost[begin]) * 1e6
