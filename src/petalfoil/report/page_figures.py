"""Figures of the page: ratios of loads under every assumption, and maps of a petal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.film_fields import refined
from petalfoil.plot.views import array, number, one_point
from petalfoil.report.assumptions import ALMOST_TWOFOLD, TWO_TO_FOUR, AssumptionResult
from petalfoil.report.load_characteristics import COMPARED

ROW_HEIGHT = 0.24
"""Height of the line of one assumption [inch]."""


def load_ratios(rows: Sequence[AssumptionResult]) -> Figure:
    """Draw the ratio of the loads under every assumption, and the ranges that the paper states."""
    fig = style.figure(8.0, 1.4 + ROW_HEIGHT * len(rows))
    ax = fig.subplots()
    place = np.arange(len(rows))[::-1]
    bands = ((TWO_TO_FOUR, style.SKY, "2–4 times"), (ALMOST_TWOFOLD, style.GREEN, "almost two-fold"))
    for limits, colour, label in bands:
        ax.axvspan(*limits, color=colour, alpha=0.22, linewidth=0, label=label)
    for number_, e in enumerate(COMPARED):
        values = [row.ratios[number_] for row in rows]
        look: style.Look = {"color": style.FAMILY[number_], "marker": style.FAMILY_MARKERS[number_], "markersize": 5}
        ax.plot(values, place, linestyle="none", label=f"e = {e * 1e6:.0f} µm", **look)
    ax.axvline(1.0, color=style.GREY, linewidth=0.8)
    ax.set_xscale("log")
    style.logarithmic(ax.xaxis)
    few, many = (rows[0].packs[which].count for which in (0, -1))
    style.dress(ax, f"load with {many} petals / load with {few} petals", "")
    ax.set_yticks(place, [row.assumption.description for row in rows], fontsize=style.TICK, color=style.INK)
    ax.set_ylim(-0.7, len(rows) - 0.3)
    style.legend(ax, loc="upper center", bbox_to_anchor=(0.3, -0.5 / (ROW_HEIGHT * len(rows))), ncols=5, frameon=False)
    return fig


def petal_maps(family: Sequence[tuple[str, xr.Dataset]]) -> Figure:
    """Draw pressure and film thickness over the exposed part of the first petal and the length, for a 3-D family."""
    states = [(label, one_point(ds)) for label, ds in family]
    ratios = [array(ds, "pressure")[0] / number(ds, "ambient_pressure") for _, ds in states]
    films = [array(ds, "film_thickness")[0] * 1e6 for _, ds in states]
    fig = style.figure(8.0, 4.8)
    axes = fig.subplots(2, len(states), sharey=True, squeeze=False)
    scales = (
        (ratios, Normalize(min(r.min() for r in ratios), max(r.max() for r in ratios)), style.PRESSURE_MAP),
        (films, LogNorm(min(h.min() for h in films), max(h.max() for h in films)), style.FILM_MAP),
    )
    for number_, (line, (values, norm, colours)) in enumerate(zip(axes, scales, strict=True)):
        for ax, (label, ds), field in zip(line, states, values, strict=True):
            x, y, shade = refined(np.degrees(array(ds, "phi_exposed")), array(ds, "z") * 1e3, field)
            ax.pcolormesh(x, y, shade.T, norm=norm, cmap=colours, shading="nearest", rasterized=True)
            style.dress(ax, "", "z [mm]" if ax is line[0] else "")
            ax.grid(False)
            if number_ == 0:
                ax.set_title(label, fontsize=style.LABEL, color=style.INK)
    for line, name in zip(axes, ("p / p$_a$", "film thickness  h [µm]"), strict=True):
        bar = fig.colorbar(line[0].collections[0], ax=list(line), pad=0.01, aspect=14)
        bar.set_label(name, fontsize=style.LABEL)
        if name.startswith("film"):
            style.logarithmic(bar.ax.yaxis)
    fig.supxlabel("angle from the root of the petal  φ [deg]", fontsize=style.LABEL)
    return fig
