"""A grid study: figures against the grid, and their distance from the limit."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot import style
from petalfoil.plot.reading import Floats, array, number

_DECLARED_ORDER = 2.0
"""Slope of the line that guides the eye."""


@dataclass(frozen=True)
class _Drawn:
    """A figure of the study as it is drawn: label with its unit, and what it is multiplied with."""

    label: str
    factor: float = 1.0


_FIGURES = {
    "bearing_force": _Drawn("load capacity [N]"),
    "min_film_thickness": _Drawn("smallest film [µm]", 1e6),
    "peak_pressure": _Drawn("largest pressure [kPa]", 1e-3),
    "friction_torque": _Drawn("friction torque [mN·m]", 1e3),
    "contact_normal_force": _Drawn("contact reactions [N]"),
    "max_bending_stress": _Drawn("largest stress [MPa]", 1e-6),
}


def convergence(ds: xr.Dataset) -> Figure:
    """Draw the main figures of a grid study against the cells of a pitch, and how far they are from their limits.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``converge``.

    Returns
    -------
    matplotlib.figure.Figure
        Values with limits and error bars on the left; on the right relative distances from the limits, with the slope
        of second order.

    Raises
    ------
    ConvergenceError
        The study has no figure that is more than its error bar.
    UsageError
        The dataset is not a grid study.
    """
    if "grid" not in ds.dims:
        raise UsageError("this figure needs the result of `converge`")
    names = [name for name in _FIGURES if f"{name}_limit" in ds and _is_more_than_its_bar(ds, name)]
    if not names:
        raise ConvergenceError("every figure of the study is smaller than its error bar", advice="choose finer grids")
    rows = (len(names) + 1) // 2
    fig = style.figure(12.0, 2.6 + 1.9 * rows)
    places = fig.add_gridspec(rows, 3, width_ratios=[1.0, 1.0, 1.4])
    for place, name in enumerate(names):
        _draw_values(fig.add_subplot(places[place // 2, place % 2]), ds, name, style.FAMILY[place])
    _draw_errors(fig.add_subplot(places[:, 2]), ds, names)
    first = ds.isel(grid=0)
    style.set_title(fig, ds, style.speed_fact(number(first, "speed")), style.displacement_fact(first), _grids_fact(ds))
    return fig


def _is_more_than_its_bar(ds: xr.Dataset, name: str) -> bool:
    return abs(number(ds, f"{name}_limit")) > number(ds, f"{name}_error")


def _cells(ds: xr.Dataset) -> Floats:
    return array(ds, "cells_per_pitch")


def _draw_values(ax: Axes, ds: xr.Dataset, name: str, colour: str) -> None:
    """One figure on each grid, its limit, and the band of the error bar."""
    drawn, cells = _FIGURES[name], _cells(ds)
    limit, error = (number(ds, f"{name}_{part}") * drawn.factor for part in ("limit", "error"))
    ax.axhspan(limit - error, limit + error, color=colour, alpha=0.15, linewidth=0)
    ax.axhline(limit, color=colour, linewidth=1.0, linestyle="--")
    ax.plot(cells, array(ds, name) * drawn.factor, "o-", color=colour, linewidth=1.6, markersize=5)
    style.dress(ax)
    name, _, unit = drawn.label.partition(" [")
    digits = max(0, 1 - math.floor(math.log10(error))) if error > 0.0 else 3
    text = f"{name} {limit:.{digits}f} ± {error:.{digits}f} {unit.rstrip(']')}"
    ax.set_title(text, fontsize=style.LABEL, color=style.INK)
    _axis_of_cells(ax, cells)


def _draw_errors(ax: Axes, ds: xr.Dataset, names: list[str]) -> None:
    """Distances from the limits, over the limits, and the error bars of the finest grid."""
    cells, largest = _cells(ds), 0.0
    for number_, name in enumerate(names):
        limit, error = number(ds, f"{name}_limit"), number(ds, f"{name}_error")
        distance = np.abs(array(ds, name) - limit) / abs(limit)
        shown = np.where(distance > 0.0, distance, np.nan)
        if not np.isfinite(shown).any():
            continue
        largest = max(largest, float(np.nanmax(shown)))
        look: style.Look = {"color": style.FAMILY[number_], "marker": style.FAMILY_MARKERS[number_], "markersize": 5}
        trusted = bool(ds[f"{name}_trusted"])
        label = _FIGURES[name].label.partition(" [")[0] + ("" if trusted else " (no credible order)")
        ax.plot(cells, shown, label=label, linewidth=1.6, linestyle="-" if trusted else ":", **look)
        ax.plot(cells[-1], error / abs(limit), "_", color=style.FAMILY[number_], markersize=14, markeredgewidth=2.0)
    if largest > 0.0:
        guide = largest * (cells / cells[0]) ** -_DECLARED_ORDER
        ax.plot(cells, guide, color=style.GREY, linewidth=1.0, linestyle="--", label="second order")
    ax.plot([], [], "_", color=style.GREY, markersize=14, markeredgewidth=2.0, label="error bar of the finest grid")
    ax.set_yscale("log")
    style.dress(ax, "cells along a pitch")
    ax.set_title("distance from the limit over the limit", fontsize=style.LABEL, color=style.INK)
    _axis_of_cells(ax, cells)
    ax.figure.legend(loc="outside lower center", ncols=4, fontsize=style.TICK, frameon=False)


def _axis_of_cells(ax: Axes, cells: Floats) -> None:
    ax.set_xscale("log", base=2)
    ax.set_xticks(cells, [f"{count:.0f}" for count in cells])
    ax.minorticks_off()


def _grids_fact(ds: xr.Dataset) -> str:
    cells = [f"{count:.0f}" for count in _cells(ds)]
    if "axial_cells" in ds:
        cells = [f"{one} × {axial:.0f}" for one, axial in zip(cells, array(ds, "axial_cells"), strict=True)]
    return f"grids {', '.join(cells)}"
