"""Stiffness and damping over whirl frequency, at one speed or at several."""

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

_ENTRIES = {"xx": (0, 0), "xy": (0, 1), "yx": (1, 0), "yy": (1, 1)}
_MATRICES = {"stiffness": ("K", "N/m"), "damping": ("C", "N·s/m")}


def coefficients(ds: xr.Dataset) -> Figure:
    """Draw the entries of stiffness and damping over whirl frequency; over speed where there is a single frequency.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``coefficients``.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each matrix; at several speeds, a panel for each entry and a line for each speed.

    Raises
    ------
    ConvergenceError
        No operating point was found.
    UsageError
        The dataset has no coefficients.
    """
    if "stiffness" not in ds:
        raise UsageError("this figure needs the result of `coefficients`")
    points = _points(ds)
    several = len(points) > 1 and ds.sizes["whirl_frequency"] > 1
    fig = _entries(points) if several else _matrices(points)
    speeds = [style.speed_fact(number(point, "speed")) for point in (points[0], points[-1])]
    facts = [" to ".join(dict.fromkeys(speeds)), _place_fact(points)]
    style.set_title(fig, ds, *facts)
    return fig


def _points(ds: xr.Dataset) -> list[xr.Dataset]:
    points = [ds.isel(point=number_) for number_ in range(ds.sizes["point"])] if "point" in ds.dims else [ds]
    found = sorted((point for point in points if bool(point["converged"])), key=lambda point: float(point["speed"]))
    if not found:
        raise unconverged(str(points[-1]["status"].item()))
    return found


def _place_fact(points: list[xr.Dataset]) -> str:
    """The load where there is one, else the displacement."""
    first = points[0]
    load = math.hypot(number(first, "load_x"), number(first, "load_y"))
    return style.displacement_fact(first) if math.isnan(load) else f"load {load:.4g} N"


def _matrices(points: list[xr.Dataset]) -> Figure:
    """All entries of a matrix in one panel."""
    fig = style.figure(11.0, 4.8)
    over_speed = len(points) > 1
    x = np.array([number(point, "speed") for point in points]) if over_speed else array(points[0], "whirl_frequency")
    for ax, (name, (letter, unit)) in zip(fig.subplots(1, 2), _MATRICES.items(), strict=True):
        values = [array(point, name)[0] for point in points] if over_speed else list(array(points[0], name))
        for number_, (entry, (row, column)) in enumerate(_ENTRIES.items()):
            look: style.Look = {"color": style.FAMILY[number_], "marker": style.FAMILY_MARKERS[number_]}
            label = f"{letter}$_{{{entry}}}$"
            ax.plot(_rpm(x, over_speed), [value[row, column] for value in values], label=label, markersize=5, **look)
        _frame(ax, _axis(over_speed), f"{name} [{unit}]")
        if not over_speed:
            _mark_synchronous(ax, number(points[0], "speed"), x)
        style.legend(ax, loc="best")
    return fig


def _entries(points: list[xr.Dataset]) -> Figure:
    """One panel for each entry, one line for each speed."""
    fig = style.figure(13.0, 6.4)
    axes = fig.subplots(2, 4, sharex=True)
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.9, len(points)))
    for line, (name, (letter, unit)) in zip(axes, _MATRICES.items(), strict=True):
        for ax, (entry, (row, column)) in zip(line, _ENTRIES.items(), strict=True):
            for point, colour in zip(points, colours, strict=True):
                label = style.speed_fact(number(point, "speed"))
                values = array(point, name)[:, row, column]
                ax.plot(array(point, "whirl_frequency"), values, color=colour, label=label, linewidth=1.6)
            _frame(ax, _axis(False) if name == "damping" else "", f"{letter}$_{{{entry}}}$ [{unit}]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=style.TICK, frameon=False)
    return fig


def _frame(ax: Axes, xlabel: str, ylabel: str) -> None:
    style.dress(ax, xlabel, ylabel)
    ax.axhline(0.0, color=style.GREY, linewidth=0.8)
    ax.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)


def _mark_synchronous(ax: Axes, speed: float, frequencies: Floats) -> None:
    if frequencies.min() < speed <= 1.02 * frequencies.max():
        ax.axvline(speed, color=style.GREY, linewidth=1.0, linestyle=":", label="Ω = ω")


def _axis(over_speed: bool) -> str:
    return "speed [rpm]" if over_speed else "whirl frequency  Ω [rad/s]"


def _rpm(x: Floats, over_speed: bool) -> Floats:
    return x * 30.0 / math.pi if over_speed else x
