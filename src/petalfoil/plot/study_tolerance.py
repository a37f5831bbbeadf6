"""Scatter of results: histograms with limits, and what each parameter contributes."""

from __future__ import annotations

import json
from typing import Any, TypeAlias

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.labels import PlottedQuantity
from petalfoil.plot.study_views import Floats, count_fact, in_unit, of_cases, result, shown_results

Told: TypeAlias = dict[str, Any]
"""Numbers of a result or a limit, as the study tells them."""

_MOST_BARS = 12
"""Parameters in one panel of contributions."""
_WIDTH = 3.5
"""Standard deviations to each side over which the normal curve is drawn."""


def tolerance(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw the scatter of results beside what each parameter contributes.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a tolerance study.
    names : tuple of str
        Results to show; by default those with a limit, else the first few.

    Returns
    -------
    matplotlib.figure.Figure
        A row for each result: histogram with nominal value, limits and the normal curve of the first-order estimate,
        and the effect of one standard deviation of each parameter.

    Raises
    ------
    UsageError
        No result varies.
    """
    ds = of_cases(ds)
    told = json.loads(ds.attrs["tolerance"])
    limited = tuple(dict.fromkeys(limit["result"] for limit in told["limits"]))
    shown = shown_results(ds, names or limited)[:3]
    fig = style.figure(10.5, 3.6 * len(shown) + 0.4)
    axes = fig.subplots(len(shown), 2, squeeze=False)
    for (left, right), name in zip(axes, shown, strict=True):
        quantity = result(ds, name)
        limits = [limit for limit in told["limits"] if limit["result"] == name]
        _histogram(left, in_unit(ds, name, quantity), quantity, told["results"][name], limits)
        _contributions(right, quantity, told["results"][name])
    style.set_title(fig, ds, f"tolerance of {ds.attrs['asked']}", count_fact(ds))
    return fig


def _histogram(ax: Axes, values: Floats, quantity: PlottedQuantity, told: Told, limits: list[Told]) -> None:
    finite = values[np.isfinite(values)]
    ax.hist(finite, bins="auto", density=True, color=style.SKY, edgecolor=style.WHITE, linewidth=0.4)
    nominal, spread = told["nominal"], told["first_order_standard_deviation"]
    if nominal is not None:
        ax.axvline(nominal * quantity.factor, color=style.INK, linewidth=1.0, label="nominal")
    if nominal is not None and spread:
        reach, middle = _WIDTH * spread * quantity.factor, nominal * quantity.factor
        low, high = ax.get_xlim()
        x = np.linspace(min(low, middle - reach), max(high, middle + reach), 400)
        z = (x - middle) / (spread * quantity.factor)
        curve = np.exp(-0.5 * z**2) / (spread * quantity.factor * np.sqrt(2.0 * np.pi))
        ax.plot(x, curve, color=style.GREY, linestyle="--", label="normal, of first order")
    for limit in limits:
        kept = f"{limit['limit']}: {100.0 * limit['probability']:.1f} %"
        bounds = f" ({100.0 * limit['low']:.1f} to {100.0 * limit['high']:.1f} %)"
        ax.axvline(limit["value"] * quantity.factor, color=style.VERMILLION, linewidth=1.6, label=kept + bounds)
    style.dress(ax, quantity.axis, "probability density" + (f" [1/{quantity.unit}]" if quantity.unit else ""))
    ax.legend(fontsize=style.TICK, frameon=False, loc="lower left", bbox_to_anchor=(0.0, 1.0))


def _contributions(ax: Axes, quantity: PlottedQuantity, told: Told) -> None:
    """A bar for the effect of one standard deviation of each parameter, the largest first."""
    effects = {path: effect * quantity.factor for path, effect in told["effects"].items() if effect}
    if not effects:
        ax.set_axis_off()
        note = "no parameter has an effect of first order on it"
        ax.text(0.5, 0.5, note, transform=ax.transAxes, ha="center", fontsize=style.LABEL, color=style.GREY)
        return
    ranked = sorted(effects, key=lambda path: -abs(effects[path]))[:_MOST_BARS]
    bars = [effects[path] for path in ranked]
    ax.barh(range(len(bars)), bars, color=[style.BLUE if bar > 0.0 else style.ORANGE for bar in bars], height=0.6)
    ax.set_yticks(range(len(bars)), ranked, fontsize=style.TICK)
    ax.invert_yaxis()
    ax.axvline(0.0, color=style.GREY, linewidth=0.8)
    unit = f" [{quantity.unit}]" if quantity.unit else ""
    style.dress(ax, f"effect of one standard deviation{unit}")
