"""The orbit of the journal's centre, scaled to itself, with its points once per revolution; a motion in one figure."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.histories import draw_contact, draw_film_history, draw_tilt, draw_x, draw_y, tilts
from petalfoil.plot.labels import MICRO
from petalfoil.plot.orbit_views import clearance_circle, motion_facts, path_of, settled
from petalfoil.plot.spectra import draw_frequencies
from petalfoil.plot.views import number
from petalfoil.results.motion import TURN, Path

_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 721)
_MARGIN = 1.12
"""Width or height of the view over the extent of the path in it."""
_LEGEND = 0.22
"""Part of the view's height, above the path, that is kept for the legend."""
_NOTE = 0.07
"""The same below the path, for a note of what is outside the view."""


def orbit(ds: xr.Dataset) -> Figure:
    """Draw a motion: path, spectrum or waterfall, and histories.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Path on the left, spectrum on the right, histories below. The energy balance has a figure of its own,
        `orbit_energy`.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(14.0, 9.4)
    rows = fig.add_gridspec(3, 6, height_ratios=[2.6, 1.0, 1.0])
    draw_path(fig.add_subplot(rows[0, :3]), ds, path)
    draw_frequencies(fig.add_subplot(rows[0, 3:]), path)
    for place, draw in ((rows[1, :3], draw_x), (rows[1, 3:], draw_y)):
        ax = fig.add_subplot(place)
        draw(ax, ds, path)
        ax.set_xlabel("")
    lowest = [draw_film_history, draw_contact, *([draw_tilt] if tilts(ds) else [])]
    width = 6 // len(lowest)
    for number_, draw_lowest in enumerate(lowest):
        draw_lowest(fig.add_subplot(rows[2, number_ * width : (number_ + 1) * width]), ds, path)
    error = number(ds, "energy_balance_error")
    energy = "" if math.isnan(error) else f"energy-balance error {error:.1e}"
    style.set_title(fig, ds, *motion_facts(ds, path), energy)
    return fig


def orbit_path(ds: xr.Dataset) -> Figure:
    """Draw the path of the journal's centre.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        The path with its points once per revolution, on a scale that suits it.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(8.0, 6.4)
    draw_path(fig.subplots(), ds, path)
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def draw_path(ax: Axes, ds: xr.Dataset, path: Path, *, ratio: float = 1.35, columns: int = 3) -> None:
    """Draw the path with start, end and points once per revolution; the clearance circle where it is in view.

    Parameters
    ----------
    ax : Axes
        Axes to draw into.
    ds : xarray.Dataset
        Result of ``orbit``.
    path : Path
        Its path.
    ratio : float
        Width of the view over its height.
    columns : int
        Columns of the legend, which stands above the path.
    """
    _draw_line(ax, path)
    points = path.once_a_turn() * MICRO
    if points.size:
        look: style.Look = {"color": style.ORANGE, "markersize": 4.5, "markeredgecolor": style.INK}
        ax.plot(points.real, points.imag, "o", label="once per revolution", markeredgewidth=0.5, zorder=4, **look)
    for place, marker, colour, label in ((0, "^", style.GREEN, "start"), (-1, "s", style.VERMILLION, "end")):
        where = (MICRO * path.x[place], MICRO * path.y[place])
        ax.plot(*where, marker, color=colour, markersize=8, markeredgecolor=style.WHITE, label=label, zorder=5)
    _frame_path(ax, path, ratio)
    _draw_circle(ax, ds)
    style.legend(ax, loc="upper center", ncols=columns, columnspacing=1.0, handletextpad=0.4, handlelength=1.4)


def _frame_path(ax: Axes, path: Path, ratio: float) -> None:
    """A view with equal scales that suits the path, with space for the legend above it and a note below."""
    x, y = MICRO * path.x, MICRO * path.y
    free = 1.0 - _LEGEND - _NOTE
    height = max(_MARGIN * float(np.ptp(y)) / free, _MARGIN * float(np.ptp(x)) / ratio, 1e-3)
    left = 0.5 * (float(x.min() + x.max()) - ratio * height)
    low = 0.5 * (float(y.min() + y.max()) - free * height) - _NOTE * height
    style.dress(ax, "x [µm]", "y [µm]")
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlim(left, left + ratio * height)
    ax.set_ylim(low, low + height)


def _draw_circle(ax: Axes, ds: xr.Dataset) -> None:
    """The clearance circle where the view shows a part of it; else a note of its radius."""
    circle = clearance_circle(ds)
    if circle is None:
        return
    radius, label = circle[0] * MICRO, circle[1]
    x, y = radius * np.cos(_CIRCLE), radius * np.sin(_CIRCLE)
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    if np.any((left < x) & (x < right) & (low < y) & (y < high)):
        look: style.Look = {"color": style.VERMILLION, "linewidth": 1.5, "linestyle": "--", "label": label}
        ax.plot(x, y, gid="clearance circle", **look)
    else:
        note: style.Look = {"ha": "left", "va": "bottom", "fontsize": style.TICK, "color": style.GREY}
        box = {"facecolor": style.WHITE, "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
        ax.text(0.02, 0.02, f"outside this view: {label}", transform=ax.transAxes, bbox=box, zorder=6, **note)


def _draw_line(ax: Axes, path: Path) -> None:
    """The whole path pale, its last revolutions over it."""
    _, z = path.evenly(float(path.time[0]))
    ax.plot(MICRO * z.real, MICRO * z.imag, color=style.SKY, linewidth=0.8, alpha=0.6, label="before")
    x, y = settled(path)
    ax.plot(MICRO * x, MICRO * y, color=style.BLUE, linewidth=1.1, label=f"last {_last_turns(path):.3g} revolutions")


def _last_turns(path: Path) -> float:
    since = float(np.interp(path.settled_since(), path.time, path.angle))
    return float(path.angle[-1] - since) / TURN
