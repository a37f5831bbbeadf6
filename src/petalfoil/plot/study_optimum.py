"""An optimisation: how the best design was found, and the front of several objectives."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from petalfoil.plot import style
from petalfoil.plot.labels import plain
from petalfoil.plot.study_views import Floats, in_unit, of_cases, parameter, parameters, result

_MARGIN = 0.15
"""Space beside the designs of a front, over their span."""


def optimum(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw an optimisation.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of an optimisation.
    names : tuple of str
        Results to show against the design's number instead of objectives and limits.

    Returns
    -------
    matplotlib.figure.Figure
        Of one objective: it, the limited results and the parameters over the number of the design. Of several: the
        designs in the plane of the first two, with the front.
    """
    ds = of_cases(ds)
    told = json.loads(ds.attrs["optimum"])
    if len(told["objectives"]) > 1 and not names:
        return _front(ds, told)
    return _history(ds, told, names)


def _fact(told: dict[str, Any]) -> str:
    exact = f", {told['with_derivatives']} with exact derivatives" if told["with_derivatives"] else ""
    return f"{told['designs']} designs{exact} · {told['ended']}"


def _history(ds: xr.Dataset, told: dict[str, Any], names: tuple[str, ...]) -> Figure:
    """A panel for the objective and each limited result, and one for the parameters over their ranges."""
    objectives = [name for name, _ in told["objectives"]]
    shown = list(names) or list(dict.fromkeys([*objectives, *(limit["result"] for limit in told["limits"])]))
    fig = style.figure(8.0, 2.3 * (len(shown) + 1) + 0.6)
    axes = fig.subplots(len(shown) + 1, 1, sharex=True)
    number, feasible = ds["case"].values, ds["feasible"].values.astype(bool)
    for ax, name in zip(axes, shown, strict=False):
        quantity = result(ds, name)
        values = in_unit(ds, name, quantity)
        ax.plot(
            number[~feasible], values[~feasible], "x", color=style.VERMILLION, markersize=4.5, label="misses a limit"
        )
        ax.plot(number[feasible], values[feasible], "o", color=style.BLUE, markersize=3.5, label="keeps every limit")
        for limit in told["limits"]:
            if limit["result"] == name:
                ax.axhline(limit["value"] * quantity.factor, color=style.VERMILLION, linewidth=1.0, linestyle="--")
        _mark_best(ax, ds, number, values)
        style.dress(ax, "", style.folded(quantity.axis, 24))
    _parameters(axes[-1], ds, number)
    style.legend_below(axes[0], 3)
    style.set_title(fig, ds, _fact(told))
    return fig


def _mark_best(ax: Axes, ds: xr.Dataset, number: Floats, values: Floats) -> None:
    best = ds["on_front"].values.astype(bool)
    look: dict[str, Any] = {"markerfacecolor": "none", "markeredgecolor": style.INK, "markersize": 10.0}
    ax.plot(number[best], values[best], "o", label="best", **look)


def _parameters(ax: Axes, ds: xr.Dataset, number: Floats) -> None:
    """Each parameter over the range that the designs span."""
    for index, name in enumerate(parameters(ds)):
        quantity = parameter(ds, name)
        values = in_unit(ds, name, quantity)
        low, high = float(values.min()), float(values.max())
        label = f"{quantity.name}: {plain(low)} to {plain(high)} {quantity.unit}".strip()
        part = (values - low) / (high - low) if high > low else np.full_like(values, 0.5)
        look: dict[str, Any] = {"color": style.FAMILY[index % 7], "marker": style.FAMILY_MARKERS[index % 7]}
        ax.plot(number, part, linewidth=0.8, markersize=3.0, label=label, **look)
    style.dress(ax, "design", "parameters over\ntheir span")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.legend(fontsize=style.TICK - 1.0, frameon=False, loc="upper left", bbox_to_anchor=(0.0, -0.25), ncols=2)


def _front(ds: xr.Dataset, told: dict[str, Any]) -> Figure:
    """Designs in the plane of the first two objectives."""
    (first, _), (second, _) = told["objectives"][:2]
    across, up = result(ds, first), result(ds, second)
    x, y = in_unit(ds, first, across), in_unit(ds, second, up)
    feasible, best = (ds[name].values.astype(bool) for name in ("feasible", "on_front"))
    fig = style.figure(7.0, 5.2)
    ax = fig.subplots()
    ax.plot(x[~feasible], y[~feasible], "x", color=style.GREY, markersize=4.0, label="misses a limit")
    ax.plot(x[feasible & ~best], y[feasible & ~best], "o", color=style.SKY, markersize=3.5, label="keeps every limit")
    order = np.argsort(x[best])
    ax.plot(x[best][order], y[best][order], "o-", color=style.VERMILLION, markersize=5.0, linewidth=1.0, label="front")
    _around(ax, x[feasible], y[feasible])
    style.dress(ax, across.axis, up.axis)
    style.legend(ax)
    style.set_title(fig, ds, _fact(told))
    return fig


def _around(ax: Axes, x: Floats, y: Floats) -> None:
    """Limit axes to the designs that keep every limit, and a margin about them: others may lie far away."""
    for values, limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
        finite = values[np.isfinite(values)]
        if finite.size and (span := float(np.ptp(finite))) > 0.0:
            limits(float(finite.min()) - _MARGIN * span, float(finite.max()) + _MARGIN * span)
