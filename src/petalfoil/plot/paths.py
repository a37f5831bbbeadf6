"""The path of the journal's centre: in the circle in which it has room, and close up with its points once a turn."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.motion import MICRO, contact_circle, motion_facts, path_of, settled
from petalfoil.results.motion import Path

_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 361)


def orbit_path(ds: xr.Dataset) -> Figure:
    """Draw the path of the journal's centre, in the circle in which it has room and close up.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Left the circle of contact with the path in it; right the path alone, with its places once a turn.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(11.0, 5.8)
    wide, close = fig.subplots(1, 2)
    draw_room(wide, ds, path)
    draw_close(close, path)
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def draw_room(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the path in the circle of contact."""
    circle = contact_circle(ds)
    _draw_line(ax, path, named=False)
    ax.plot(0.0, 0.0, "+", color=style.INK, markersize=8, gid="centre")
    reach = 1.1 * MICRO * float(np.hypot(path.x, path.y).max())
    if circle is not None:
        room, label = circle[0] * MICRO, circle[1]
        look: style.Look = {"color": style.VERMILLION, "linewidth": 1.5, "linestyle": "--", "label": label}
        ax.plot(room * np.cos(_CIRCLE), room * np.sin(_CIRCLE), gid="circle of contact", **look)
        reach = max(reach, 1.08 * room)
    _frame(ax, (0.0, 0.0), reach)
    _legend_below(ax, 1)


def draw_close(ax: Axes, path: Path) -> None:
    """Draw the path close up, with its start, its end and its places once a turn."""
    _draw_line(ax, path)
    points = path.once_a_turn() * MICRO
    if points.size:
        look: style.Look = {"color": style.ORANGE, "markersize": 4.5, "markeredgecolor": style.INK}
        ax.plot(points.real, points.imag, "o", label="once a turn", markeredgewidth=0.5, zorder=4, **look)
    for place, marker, colour, label in ((0, "^", style.GREEN, "start"), (-1, "s", style.VERMILLION, "end")):
        where = (MICRO * path.x[place], MICRO * path.y[place])
        ax.plot(*where, marker, color=colour, markersize=8, markeredgecolor=style.WHITE, label=label, zorder=5)
    x, y = MICRO * path.x, MICRO * path.y
    middle = (0.5 * float(x.min() + x.max()), 0.5 * float(y.min() + y.max()))
    _frame(ax, middle, max(0.56 * float(max(np.ptp(x), np.ptp(y))), 1e-3))
    _legend_below(ax, 5)


def _draw_line(ax: Axes, path: Path, named: bool = True) -> None:
    """The whole path pale, its last turns over it."""
    _, z = path.evenly(float(path.time[0]))
    ax.plot(MICRO * z.real, MICRO * z.imag, color=style.SKY, linewidth=0.8, alpha=0.6, label="before" if named else "")
    x, y = settled(path)
    label = f"last {_last_turns(path):.3g} turns" if named else ""
    ax.plot(MICRO * x, MICRO * y, color=style.BLUE, linewidth=1.1, label=label)


def _last_turns(path: Path) -> float:
    since = float(np.interp(path.settled_since(), path.time, path.angle))
    return float(path.angle[-1] - since) / (2.0 * math.pi)


def _legend_below(ax: Axes, columns: int) -> None:
    below: style.Look = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.12), "frameon": False}
    style.legend(ax, ncols=columns, columnspacing=1.0, handletextpad=0.4, handlelength=1.4, **below)


def _frame(ax: Axes, middle: tuple[float, float], reach: float) -> None:
    style.dress(ax, "x [µm]", "y [µm]")
    ax.set_aspect("equal", adjustable="box")
    ax.set_xlim(middle[0] - reach, middle[0] + reach)
    ax.set_ylim(middle[1] - reach, middle[1] + reach)
