"""Load capacity over speed, and over the direction of the load to the petals."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import ConvergenceError
from petalfoil.plot import labels, style
from petalfoil.plot.generic import quantities
from petalfoil.plot.labels import QUANTITIES, RPM

_MAIN = ("load_capacity", "load_coefficient", "load_coefficient_imperial")
"""Results that a table of one point begins with."""


def capacity(ds: xr.Dataset) -> Figure:
    """Draw the load capacity over speed, its coefficient, and the capacity over the direction of the load.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of `capacity`, of one speed or several.

    Returns
    -------
    matplotlib.figure.Figure
        Up to three axes: what there is only one value of is left out. Of one speed and direction a table.

    Raises
    ------
    ConvergenceError
        No load capacity was found.
    """
    points = ds if "point" in ds.dims else ds.expand_dims("point")
    points = points.isel(point=np.flatnonzero(points["converged"].to_numpy()))
    if not points.sizes["point"]:
        raise ConvergenceError(
            "there is no load capacity to draw", advice="give limits that a smaller load reaches, or a higher speed"
        )
    turned = points.sizes["load_orientation"] > 1
    over_speed = points.sizes["point"] > 1
    if not turned and not over_speed:
        first = points.isel(point=0)
        return quantities(first[[*_MAIN, *(name for name in first.data_vars if name not in _MAIN)]])
    columns = 2 * over_speed + turned
    fig = style.figure(5.0 * columns, 4.4)
    axes = list(np.atleast_1d(fig.subplots(1, columns)))
    if over_speed:
        _over_speed(axes[0], axes[1], points)
    if turned:
        _over_direction(axes[-1], points)
    style.set_title(fig, ds, *_limits(points))
    return fig


def _over_speed(left: Axes, right: Axes, points: xr.Dataset) -> None:
    rpm = points["speed"].to_numpy() * RPM
    left.plot(rpm, points["load_capacity"].to_numpy(), "o-", color=style.BLUE, label="in the direction given")
    if "least_load_capacity" in points:
        least = points["least_load_capacity"].to_numpy()
        left.plot(rpm, least, "s--", color=style.VERMILLION, label="least of all directions")
    right.plot(rpm, points["load_coefficient_imperial"].to_numpy(), "o-", color=style.BLUE)
    for ax, label in ((left, "load capacity [N]"), (right, "load coefficient [lbf/(in³ krpm)]")):
        style.dress(ax, QUANTITIES["speed"].axis, label)
        ax.set_ylim(0.0, 1.1 * ax.get_ylim()[1])
        ax.locator_params(axis="x", nbins=6)
    if "least_load_capacity" in points:
        style.legend(left, loc="lower right")


def _over_direction(ax: Axes, points: xr.Dataset) -> None:
    angle = np.degrees(points["load_orientation"].to_numpy())
    for number in range(points.sizes["point"]):
        point, place = points.isel(point=number), number % len(style.FAMILY)
        look: style.Look = {"color": style.FAMILY[place], "marker": style.FAMILY_MARKERS[place], "markersize": 4.5}
        label = f"{labels.grouped(float(point['speed']) * RPM)} rpm"
        ax.plot(angle, point["capacity_over_direction"].to_numpy(), label=label, **look)
    style.dress(ax, "direction of the load, from x toward y [deg]", "load capacity [N]")
    ax.set_ylim(0.0, 1.1 * ax.get_ylim()[1])
    style.legend(ax, loc="lower right")


def _limits(points: xr.Dataset) -> list[str]:
    """The limits in words."""
    units = {
        "min_film_limit": ("film over {:.4g} µm", 1e6),
        "contact_fraction_allowed": ("contact under {:.3g} %", 1e2),
    }
    units["stress_limit"] = ("stress under {:.4g} MPa", 1e-6)
    first = points.isel(point=0)
    return [text.format(factor * float(first[name])) for name, (text, factor) in units.items() if name in first]
