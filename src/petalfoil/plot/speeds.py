"""Figures over speed under a load: lift-off over the load, and a run-up with its coast-down."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.reading import Flags, Floats, array, number, unconverged

RPM = 30.0 / math.pi


@dataclass(frozen=True)
class _Drawn:
    """A figure as it is drawn: label with its unit, and what it is multiplied with."""

    label: str
    factor: float = 1.0


_RUNUP = {
    "friction_torque": _Drawn("friction torque  M [mN·m]", 1e3),
    "contact_fraction": _Drawn("share of the contacts [%]", 100.0),
    "min_film_thickness": _Drawn("smallest film  min h [µm]", 1e6),
    "eccentricity": _Drawn("displacement  e [µm]", 1e6),
}
_LEGS: dict[str, style.Look] = {
    "up": {"color": style.BLUE, "marker": "o", "markersize": 5, "linestyle": "-", "linewidth": 1.8},
    "down": {
        "color": style.VERMILLION,
        "marker": "s",
        "markersize": 8,
        "markerfacecolor": "none",
        "linestyle": "--",
        "linewidth": 1.4,
    },
}


def runup(ds: xr.Dataset) -> Figure:
    """Draw torque, contact share, film and displacement over speed, on the way up and on the way down.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``runup``.

    Returns
    -------
    matplotlib.figure.Figure
        Four panels; a point that did not converge leaves a gap and a cross on the axis.

    Raises
    ------
    ConvergenceError
        No point converged.
    """
    converged = _converged(ds)
    fig = style.figure(10.0, 7.0)
    axes = fig.subplots(2, 2, sharex=True).ravel()
    for ax, (name, drawn) in zip(axes, _RUNUP.items(), strict=True):
        _draw_legs(ax, ds, np.where(converged, _value(ds, name), np.nan) * drawn.factor)
        style.dress(ax, "speed [rpm]" if ax in axes[2:] else "", drawn.label)
        ax.set_xlim(0.0, float(array(ds, "speed").max()) * RPM * 1.03)
        ax.set_ylim(bottom=0.0)
    _draw_floor(axes[2], ds)
    style.legend(axes[0], loc="upper right")
    style.set_title(fig, ds, _load_fact(ds), style.grid_fact(ds))
    return fig


def _draw_legs(ax: Axes, ds: xr.Dataset, value: Floats) -> None:
    speed, leg = array(ds, "speed") * RPM, ds["leg"].values
    turn = np.flatnonzero(leg == "up")
    for name, look in _LEGS.items():
        points = np.flatnonzero(leg == name)
        if not points.size:
            continue
        if name == "down" and turn.size:
            points = np.concatenate([turn[-1:], points])  # the way down begins at the top
        ax.plot(speed[points], value[points], label=f"{name}", clip_on=False, zorder=3, **look)
    failed = ~np.isfinite(value)
    if failed.any():
        place: style.Look = {"transform": ax.get_xaxis_transform(), "clip_on": False, "gid": "failed"}
        ax.plot(speed[failed], np.full(failed.sum(), 0.02), "x", color=style.GREY, label="did not converge", **place)


def _draw_floor(ax: Axes, ds: xr.Dataset) -> None:
    floor = number(ds, "contact_film_thickness") * 1e6
    if not math.isnan(floor):
        ax.axhline(floor, color=style.GREY, linewidth=1.0, linestyle=":", label=f"film floor, {floor:.3g} µm")
        ax.legend(*([items[-1]] for items in ax.get_legend_handles_labels()), fontsize=style.TICK, frameon=False)


def liftoff(ds: xr.Dataset) -> Figure:
    """Draw the speeds of lift-off and touch-down over the load.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``liftoff``.

    Returns
    -------
    matplotlib.figure.Figure
        Both speeds; loads that do not lift off are marked at the upper edge.

    Raises
    ------
    ConvergenceError
        No load has an answer.
    """
    converged = _converged(ds)
    load = np.hypot(array(ds, "load_x"), array(ds, "load_y"))
    order = np.argsort(load)
    fig = style.figure(8.0, 5.0)
    ax = fig.subplots()
    for leg, name, label in (("up", "liftoff_speed", "lift-off"), ("down", "touchdown_speed", "touch-down")):
        speed = np.where(converged & np.isfinite(array(ds, name)), array(ds, name), np.nan) * RPM
        ax.plot(load[order], speed[order], label=label, **_LEGS[leg])
    for marked, mark, label in (
        (converged & np.isinf(array(ds, "liftoff_speed")), "^", "does not lift off"),
        (~converged, "x", "did not converge"),
    ):
        if marked.any():
            height = 0.98 if mark == "^" else 0.02
            place: style.Look = {"transform": ax.get_xaxis_transform(), "clip_on": False, "markersize": 8}
            ax.plot(load[marked], np.full(marked.sum(), height), mark, color=style.GREY, label=label, **place)
    style.dress(ax, "load [N]", "speed [rpm]")
    ax.set_xlim(0.0, 1.05 * float(load.max()))
    ax.set_ylim(bottom=0.0)
    style.legend(ax, loc="best")
    share = float(np.nanmax(array(ds, "share")))
    style.set_title(fig, ds, f"floats where contacts carry less than {100.0 * share:.3g} %")
    return fig


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
