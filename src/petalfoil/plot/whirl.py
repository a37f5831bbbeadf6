"""Stability of a rigid rotor: the smallest mass that whirls and its whirl ratio, over speed for each load."""

from __future__ import annotations

import math

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.reading import Floats, array, number, unconverged

RPM = 30.0 / math.pi

WIDE = 5.0
"""Factor between masses past which they are drawn on a logarithmic axis."""


def stability(ds: xr.Dataset) -> Figure:
    """Draw critical mass and whirl ratio over speed, a line for each load; a single point as a marker.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``stability``: a point, or a table over load and speed.

    Returns
    -------
    matplotlib.figure.Figure
        Critical mass above, whirl ratio below; speeds at which no mass whirls are marked at the upper edge.

    Raises
    ------
    ConvergenceError
        No operating point was found.
    UsageError
        The dataset is of another verb.
    """
    if "critical_mass" not in ds:
        raise UsageError("this figure needs the result of `stability`")
    lines = _lines(ds)
    if not any(np.isfinite(mass).any() or np.isinf(mass).any() for _, _, mass, _ in lines):
        raise unconverged(str(np.ravel(ds["status"].values)[-1]))
    fig = style.figure(8.0, 6.4)
    above, below = fig.subplots(2, 1, sharex=True, height_ratios=[1.5, 1.0])
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, len(lines)))
    for (label, speed, mass, ratio), colour in zip(lines, colours, strict=True):
        look: style.Look = {"color": colour, "marker": "o", "markersize": 5, "linewidth": 1.8}
        above.plot(speed * RPM, np.where(np.isfinite(mass), mass, np.nan), label=label, **look)
        below.plot(speed * RPM, ratio, **look)
        _mark_calm(above, speed[np.isinf(mass)] * RPM, colour)
    _draw_rotor(above, ds)
    _frame(above, below, [mass for _, _, mass, _ in lines])
    style.legend(above, loc="best")
    style.set_title(fig, ds, *_facts(ds))
    return fig


def _lines(ds: xr.Dataset) -> list[tuple[str, Floats, Floats, Floats]]:
    """Label, speeds, masses and ratios of each load."""
    if "load" not in ds.dims:
        one = (np.atleast_1d(array(ds, name)) for name in ("speed", "critical_mass", "whirl_ratio"))
        speed, mass, ratio = one
        return [("critical mass", speed, mass, ratio)]
    order = np.argsort(array(ds, "speed"))
    speed, masses, ratios = array(ds, "speed")[order], array(ds, "critical_mass"), array(ds, "whirl_ratio")
    return [
        (f"load {load:.4g} N", speed, masses[row][order], ratios[row][order])
        for row, load in enumerate(array(ds, "load"))
    ]


def _mark_calm(ax: Axes, speeds: Floats, colour: Floats) -> None:
    if speeds.size:
        place: style.Look = {"transform": ax.get_xaxis_transform(), "clip_on": False, "markersize": 8, "gid": "calm"}
        ax.plot(speeds, np.full(speeds.size, 0.97), "^", color=colour, **place)


def _draw_rotor(ax: Axes, ds: xr.Dataset) -> None:
    """Mass of the rotor and threshold speed of a single point."""
    rotor = number(ds, "rotor_mass") if "load" not in ds.dims else math.nan
    if math.isnan(rotor):
        return
    ax.axhline(
        rotor, color=style.VERMILLION, linewidth=1.2, linestyle="--", label=f"rotor, {rotor:.4g} kg", gid="rotor"
    )
    threshold = number(ds, "threshold_speed") * RPM
    if not math.isnan(threshold):
        label = f"begins to whirl at {threshold:.0f} rpm"
        ax.plot(threshold, rotor, "s", color=style.VERMILLION, markersize=7, label=label)


def _frame(above: Axes, below: Axes, masses: list[Floats]) -> None:
    style.dress(above, "", "critical mass  m$_c$ [kg]")
    style.dress(below, "speed [rpm]", "whirl ratio  Ω/ω")
    below.set_ylim(0.0, 0.6)
    finite = np.concatenate([mass[np.isfinite(mass)] for mass in masses])
    if finite.size and finite.min() > 0.0 and finite.max() > WIDE * finite.min():
        above.set_yscale("log")
        style.logarithmic(above.yaxis)
    else:
        rotor = [float(np.max(np.asarray(line.get_ydata()))) for line in above.lines if line.get_gid() == "rotor"]
        heights = [*finite.tolist(), *rotor]
        above.set_ylim(0.0, 1.15 * max(heights, default=1.0))
    if any(np.isinf(mass).any() for mass in masses):
        above.plot([], [], "^", color=style.GREY, markersize=8, label="no mass whirls")


def _facts(ds: xr.Dataset) -> tuple[str, ...]:
    if "load" in ds.dims:
        return ("a rotor heavier than the critical mass whirls",)
    load = math.hypot(number(ds, "load_x"), number(ds, "load_y"))
    place = style.displacement_fact(ds) if math.isnan(load) else f"load {load:.4g} N"
    return style.speed_fact(number(ds, "speed")), place
