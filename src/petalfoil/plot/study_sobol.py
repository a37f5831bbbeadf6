"""Sobol' indices as bars with their intervals."""

from __future__ import annotations

import json

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.study_views import count_fact, of_cases, parameters, result, shown_results

_MOST_BARS = 12
"""Parameters in one panel."""
_THICK = 0.38


def sobol(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw Sobol' indices.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a global sensitivity study.
    names : tuple of str
        Results to show; by default the first few.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each result: first-order and total index of each parameter with its 95 % interval, the largest
        on top.

    Raises
    ------
    UsageError
        No result has indices.
    """
    ds = of_cases(ds)
    told = json.loads(ds.attrs["sobol"])
    has = [name for name in told if told[name]["parameters"]]
    if not has:
        raise UsageError("no result of this study has indices, too few cases have an answer: ask more base samples")
    shown = [name for name in names or shown_results(ds) if name in has] or has[:1]
    bars = min(len(parameters(ds)), _MOST_BARS)
    fig = style.figure(8.0, (0.42 * bars + 0.9) * len(shown) + 0.7)
    axes = fig.subplots(len(shown), 1, squeeze=False, sharex=True).ravel()
    for ax, name in zip(axes, shown, strict=True):
        _bars(ax, told[name]["parameters"])
        ax.set_title(result(ds, name).name, fontsize=style.LABEL, loc="left")
    axes[-1].set_xlabel("part of the variance", fontsize=style.LABEL)
    style.legend_below(axes[0], 2)
    style.set_title(fig, ds, f"Sobol' indices of {ds.attrs['asked']}", count_fact(ds))
    return fig


def _bars(ax: Axes, told: dict[str, dict[str, float]]) -> None:
    ranked = sorted(told, key=lambda path: -told[path]["ST"])[:_MOST_BARS]
    place = np.arange(len(ranked))
    for key, colour, shift, label in (("S1", style.BLUE, -1, "first order"), ("ST", style.SKY, 1, "total")):
        size = [told[path][key] for path in ranked]
        bar = [told[path][f"{key}_conf"] for path in ranked]
        error = {"ecolor": style.INK, "elinewidth": 0.9, "capsize": 2.5}
        ax.barh(place + 0.5 * shift * _THICK, size, _THICK, xerr=bar, color=colour, label=label, error_kw=error)
    style.dress(ax)
    ax.set_yticks(place, ranked, fontsize=style.TICK)
    ax.invert_yaxis()
