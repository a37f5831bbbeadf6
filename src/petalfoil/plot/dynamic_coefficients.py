"""Stiffness and damping over whirl frequency, at one speed or at several."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import labels, style
from petalfoil.plot.labels import HERTZ, QUANTITIES, RPM
from petalfoil.plot.views import Floats, array, needs_result_of, number, unconverged

_ENTRIES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1)}
_MATRICES = {"stiffness": ("K", "N/m"), "damping": ("C", "N·s/m")}
_SYNCHRONOUS = "synchronous, Ω = ω"
_LEAST_SPAN = 0.1
"""Height of a panel over the values in it: what changes less than this looks constant."""


def coefficients(ds: xr.Dataset) -> Figure:
    """Draw the entries of stiffness and damping over whirl frequency; over speed where there is a single frequency.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``coefficients``.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each matrix, with bars where there is a single speed and frequency; at several speeds and
        frequencies, a panel for each entry and a line for each speed.

    Raises
    ------
    ConvergenceError
        No operating point was found.
    UsageError
        The dataset has no coefficients.
    """
    if "stiffness" not in ds:
        raise needs_result_of("coefficients", ds)
    points = _points(ds)
    frequencies = array(points[0], "whirl_frequency")
    if len(points) == 1:
        fig = _bars(points[0]) if frequencies.size == 1 else _matrices(points, over_speed=False)
    else:
        fig = _matrices(points, over_speed=True) if frequencies.size == 1 else _entries(points)
    speeds = [labels.speed_fact(number(point, "speed")) for point in (points[0], points[-1])]
    single = f"whirl frequency {frequencies[0] * HERTZ:.4g} Hz" if frequencies.size == 1 else ""
    place = labels.load_fact(points[0]) or labels.displacement_fact(points[0])
    style.set_title(fig, ds, " to ".join(dict.fromkeys(speeds)), single, place)
    return fig


def _points(ds: xr.Dataset) -> list[xr.Dataset]:
    points = [ds.isel(point=number_) for number_ in range(ds.sizes["point"])] if "point" in ds.dims else [ds]
    found = sorted((point for point in points if bool(point["converged"])), key=lambda point: float(point["speed"]))
    if not found:
        raise unconverged(str(points[-1]["status"].item()))
    return found


def _bars(point: xr.Dataset) -> Figure:
    """The entries of both matrices at one speed and frequency, with their values."""
    fig = style.figure(10.0, 3.6)
    for ax, (name, (letter, unit)) in zip(fig.subplots(1, 2), _MATRICES.items(), strict=True):
        values = [float(array(point, name)[0][place]) for place in _ENTRIES.values()]
        names = [_entry(letter, entry) for entry in _ENTRIES]
        ax.barh(names, values, height=0.6, color=style.FAMILY[: len(names)])
        for height, value in enumerate(values):
            look: style.Look = {"va": "center", "fontsize": style.TICK, "color": style.INK, "gid": "value"}
            ax.text(max(value, 0.0), height, f" {value:.3g}".replace("-", "−"), ha="left", **look)
        ax.axvline(0.0, color=style.GREY, linewidth=0.8)
        style.dress(ax, f"{name} [{unit}]")
        low, high = min(*values, 0.0), max(*values, 0.0)
        spread = high - low or 1.0
        ax.set_xlim(low - 0.05 * spread, high + 0.25 * spread)
        ax.ticklabel_format(axis="x", scilimits=(-3, 4), useMathText=True)
        ax.invert_yaxis()
    return fig


def _matrices(points: Sequence[xr.Dataset], over_speed: bool) -> Figure:
    """All entries of a matrix in one panel, over the speed or over the whirl frequency of one point."""
    fig = style.figure(11.0, 4.8)
    if over_speed:
        x, axis = np.array([number(point, "speed") for point in points]) * RPM, QUANTITIES["speed"].axis
    else:
        x, axis = array(points[0], "whirl_frequency") * HERTZ, QUANTITIES["whirl_frequency"].axis
    for ax, (name, (_, unit)) in zip(fig.subplots(1, 2), _MATRICES.items(), strict=True):
        values = [array(point, name)[0] for point in points] if over_speed else list(array(points[0], name))
        for number_, (entry, place) in enumerate(_ENTRIES.items()):
            look: style.Look = {"color": style.FAMILY[number_], "marker": style.FAMILY_MARKERS[number_]}
            ax.plot(x, [value[place] for value in values], label=_entry("K, C", entry), markersize=5, **look)
        _frame(ax, axis, f"{name} [{unit}]")
        ax.axhline(0.0, color=style.GREY, linewidth=0.8)
        if not over_speed:
            _mark_synchronous(ax, number(points[0], "speed") * HERTZ, x)
    style.legend_below(fig.axes[0], 5)
    return fig


def _entries(points: Sequence[xr.Dataset]) -> Figure:
    """One panel for each entry, one line for each speed, with a dot where the whirl is synchronous."""
    fig = style.figure(13.0, 6.4)
    axes = fig.subplots(2, 4, sharex=True)
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, len(points)))
    for line, (name, (letter, unit)) in zip(axes, _MATRICES.items(), strict=True):
        for ax, (entry, place) in zip(line, _ENTRIES.items(), strict=True):
            for point, colour in zip(points, colours, strict=True):
                _draw_entry(ax, point, array(point, name)[(slice(None), *place)], colour)
            axis = QUANTITIES["whirl_frequency"].axis if name == "damping" else ""
            _frame(ax, axis, f"{_entry(letter, entry)} [{unit}]")
            _widen(ax)
    if any(item.get_gid() == "synchronous" for item in axes[0, 0].lines):
        axes[0, 0].plot([], [], "o", color=style.GREY, markersize=4.5, label=_SYNCHRONOUS)
    style.legend_below(axes[0, 0], 6)
    return fig


def _draw_entry(ax: Axes, point: xr.Dataset, values: Floats, colour: Floats) -> None:
    hertz, speed = array(point, "whirl_frequency") * HERTZ, number(point, "speed")
    ax.plot(hertz, values, color=colour, label=labels.speed_fact(speed), linewidth=1.6)
    if hertz.min() <= speed * HERTZ <= hertz.max():
        synchronous = float(np.interp(speed * HERTZ, hertz, values))
        ax.plot(speed * HERTZ, synchronous, "o", color=colour, markersize=4.5, gid="synchronous")


def _entry(letter: str, entry: str) -> str:
    return f"{letter}$_{{{entry}}}$"


def _frame(ax: Axes, xlabel: str, ylabel: str) -> None:
    style.dress(ax, xlabel, ylabel)
    ax.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True, useOffset=False)


def _widen(ax: Axes) -> None:
    """Give a panel at least its least span, so that rounding does not look like a change."""
    low, high = ax.dataLim.ymin, ax.dataLim.ymax
    span = max(1.15 * (high - low), _LEAST_SPAN * max(abs(low), abs(high)))
    if span > 0.0:
        ax.set_ylim(0.5 * (low + high - span), 0.5 * (low + high + span))


def _mark_synchronous(ax: Axes, speed: float, frequencies: Floats) -> None:
    if frequencies.min() < speed <= 1.02 * frequencies.max():
        ax.axvline(speed, color=style.GREY, linewidth=1.0, linestyle=":", label=_SYNCHRONOUS)
