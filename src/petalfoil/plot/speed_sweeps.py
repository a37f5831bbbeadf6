"""Figures over speed under a load: a run-up with its coast-down; lift-off and touchdown speed over the load."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import labels, style
from petalfoil.plot.labels import MICRO, QUANTITIES, RPM
from petalfoil.plot.views import Flags, Floats, array, number, unconverged
from petalfoil.units import format_percent

_RUNUP = ("friction_torque", "contact_fraction", "min_film_thickness", "eccentricity")
_HOT = ("shaft_temperature", "pack_temperature")
"""What a bearing with a heat network shows too."""
_LEGS: dict[str, style.Look] = {
    "up": {"color": style.SKY, "marker": "o", "markersize": 9, "linestyle": "-", "linewidth": 5.0, "zorder": 2},
    "down": {
        "color": style.VERMILLION,
        "marker": "v",
        "markersize": 4,
        "linestyle": "-",
        "linewidth": 1.3,
        "zorder": 3,
    },
}
"""A broad pale line below a narrow dark one: where they coincide, both are seen."""


def runup(ds: xr.Dataset) -> Figure:
    """Draw friction torque, contact fraction, minimum film thickness and eccentricity over speed, up and down.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``runup``.

    Returns
    -------
    matplotlib.figure.Figure
        Four panels, six with a heat network; a point that did not converge leaves a gap and a cross on the axis.

    Raises
    ------
    ConvergenceError
        No point converged.
    """
    converged = _converged(ds)
    names = (*_RUNUP, *(name for name in _HOT if name in ds))
    rows = len(names) // 2
    fig = style.figure(10.0, 3.5 * rows)
    axes = fig.subplots(rows, 2, sharex=True).ravel()
    for ax, name in zip(axes, names, strict=True):
        shown = QUANTITIES[name]
        _draw_legs(ax, ds, np.where(converged, _value(ds, name), np.nan) * shown.factor)
        style.dress(ax, QUANTITIES["speed"].axis if ax in axes[-2:] else "", shown.axis)
        ax.set_xlim(0.0, float(array(ds, "speed").max()) * RPM * 1.03)
    _draw_contact_film(axes[2], ds)
    for ax in axes[: len(_RUNUP)]:
        ax.set_ylim(bottom=0.0)
    style.legend(axes[0], loc="best")
    style.set_title(fig, ds, _load_fact(ds), labels.grid_fact(ds))
    return fig


def _draw_legs(ax: Axes, ds: xr.Dataset, value: Floats) -> None:
    speed, leg = array(ds, "speed") * RPM, ds["leg"].values
    turn = np.flatnonzero(leg == "up")
    for name, look in _LEGS.items():
        points = np.flatnonzero(leg == name)
        if not points.size:
            continue
        if name == "down" and turn.size:
            points = np.concatenate([turn[-1:], points])  # the coast-down begins at the highest speed
        ax.plot(speed[points], value[points], label=f"speed {name}", clip_on=False, **look)
    failed = ~np.isfinite(value)
    if failed.any():
        place: style.Look = {"transform": ax.get_xaxis_transform(), "clip_on": False, "gid": "failed"}
        ax.plot(speed[failed], np.full(failed.sum(), 0.02), "x", color=style.GREY, label="did not converge", **place)


def _draw_contact_film(ax: Axes, ds: xr.Dataset) -> None:
    thickness = number(ds, "contact_film_thickness") * MICRO
    if not math.isnan(thickness):
        label = f"contact film thickness, {thickness:.3g} µm"
        line = ax.axhline(thickness, color=style.GREY, linewidth=1.0, linestyle=":", label=label)
        ax.legend([line], [label], fontsize=style.TICK, frameon=False)


def liftoff(ds: xr.Dataset) -> Figure:
    """Draw lift-off and touchdown speed over the load; of a single load as bars.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``liftoff``.

    Returns
    -------
    matplotlib.figure.Figure
        Both speeds; loads that do not lift off are marked at the upper edge, of a single load it is written.

    Raises
    ------
    ConvergenceError
        No load has an answer.
    """
    converged = _converged(ds)
    load = np.hypot(array(ds, "load_x"), array(ds, "load_y"))
    speeds = {
        "lift-off": np.where(converged, array(ds, "liftoff_speed"), np.nan) * RPM,
        "touchdown": np.where(converged, array(ds, "touchdown_speed"), np.nan) * RPM,
    }
    single = len(load) == 1
    fig = style.figure(8.0, 2.6 if single else 5.0)
    ax = fig.subplots()
    if single:
        _draw_bars(ax, {name: float(values[0]) for name, values in speeds.items()}, str(ds["status"].values[0]))
    else:
        _draw_over_load(ax, load, speeds)
    fraction = float(np.nanmax(array(ds, "contact_fraction_limit")))
    criterion = f"lift-off: contact fraction below {format_percent(fraction, digits=3)}"
    style.set_title(fig, ds, f"load {load[0]:.4g} N" if single else "", criterion)
    return fig


def _draw_bars(ax: Axes, speeds: dict[str, float], status: str) -> None:
    """A bar for each speed; the status of the load in place of one that there is not."""
    fastest = max((speed for speed in speeds.values() if math.isfinite(speed)), default=0.0)
    for place, ((name, speed), look) in enumerate(zip(speeds.items(), _LEGS.values(), strict=True)):
        there = math.isfinite(speed)
        end = speed if there else 0.0
        ax.barh(-place, end, height=0.6, color=look["color"], gid=name)
        text = f" {labels.grouped(speed)} rpm" if there else f" none: {status}"
        ax.text(end, -place, text, ha="left", va="center", fontsize=style.LABEL, color=style.INK)
    style.dress(ax, QUANTITIES["speed"].axis if fastest else "")
    ax.set_yticks([0, -1], list(speeds), fontsize=style.LABEL)
    ax.set_ylim(-1.4, 0.4)
    ax.set_xlim(0.0, 1.25 * fastest or 1.0)
    if not fastest:
        ax.set_xticks([])


def _draw_over_load(ax: Axes, load: Floats, speeds: dict[str, Floats]) -> None:
    order, up = np.argsort(load), speeds["lift-off"]
    for (name, speed), look in zip(speeds.items(), _LEGS.values(), strict=True):
        ax.plot(load[order], np.where(np.isfinite(speed), speed, np.nan)[order], label=name, **look)
    for marked, mark, label in ((np.isinf(up), "^", "no lift-off"), (np.isnan(up), "x", "did not converge")):
        if marked.any():
            height = 0.97 if mark == "^" else 0.03
            place: style.Look = {"transform": ax.get_xaxis_transform(), "clip_on": False, "markersize": 8}
            ax.plot(load[marked], np.full(marked.sum(), height), mark, color=style.GREY, label=label, **place)
    style.dress(ax, QUANTITIES["load"].axis, QUANTITIES["speed"].axis)
    ax.set_xlim(0.0, 1.05 * float(load.max()))
    fastest = max((float(speed[np.isfinite(speed)].max(initial=0.0)) for speed in speeds.values()), default=0.0)
    ax.set_ylim(0.0, 1.15 * fastest or 1.0)
    if not fastest:
        ax.set_yticks([])  # no load lifts off: there is no speed to be read
    style.legend(ax, loc="lower right")


def _converged(ds: xr.Dataset) -> Flags:
    converged = np.asarray(ds["converged"].values, dtype=np.bool_)
    if not converged.any():
        raise unconverged(str(ds["status"].values[-1]) if "status" in ds else "nothing says that it did")
    return converged


def _value(ds: xr.Dataset, name: str) -> Floats:
    if name != "eccentricity":
        return array(ds, name)
    distance: Floats = np.hypot(array(ds, "eccentricity_x"), array(ds, "eccentricity_y"))
    return distance


def _load_fact(ds: xr.Dataset) -> str:
    load = np.hypot(array(ds, "load_x"), array(ds, "load_y"))
    return f"load {float(np.nanmax(load)):.4g} N"
