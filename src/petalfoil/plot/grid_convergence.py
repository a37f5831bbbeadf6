"""A grid study: quantities against the grid, and their distance from the grid-converged value."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import ConvergenceError
from petalfoil.plot import labels, style
from petalfoil.plot.labels import QUANTITIES
from petalfoil.plot.views import Floats, array, needs_result_of, number

_DECLARED_ORDER = 2.0
"""Slope of the line that guides the eye."""


_BAR: style.Look = {"markersize": 14, "markeredgewidth": 2.0}
_SHOWN = (
    "bearing_force",
    "min_film_thickness",
    "peak_pressure",
    "friction_torque",
    "contact_normal_force",
    "max_bending_stress",
)
"""Quantities of a study, in the order of the panels."""


def convergence(ds: xr.Dataset) -> Figure:
    """Draw the main quantities of a grid study against the cells per pitch, and how far they are from convergence.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``converge``.

    Returns
    -------
    matplotlib.figure.Figure
        Values with grid-converged values and error bars on the left; on the right relative distances from these
        values, with the slope of second order.

    Raises
    ------
    ConvergenceError
        The study has no quantity that is larger than its error bar.
    UsageError
        The dataset is not a grid study.
    """
    if "grid" not in ds.dims:
        raise needs_result_of("converge", ds)
    names = [name for name in _SHOWN if f"{name}_limit" in ds and _is_more_than_its_bar(ds, name)]
    if not names:
        raise ConvergenceError("every quantity of the study is smaller than its error bar", advice="choose finer grids")
    rows = (len(names) + 1) // 2
    fig = style.figure(12.0, 2.6 + 2.0 * rows)
    places = fig.add_gridspec(rows, 3, width_ratios=[1.0, 1.0, 1.4])
    for place, name in enumerate(names):
        _draw_values(fig.add_subplot(places[place // 2, place % 2]), ds, name, style.FAMILY[place])
    _draw_errors(fig.add_subplot(places[:, 2]), ds, names)
    first = ds.isel(grid=0)
    style.set_title(
        fig, ds, labels.speed_fact(number(first, "speed")), labels.displacement_fact(first), _grids_fact(ds)
    )
    return fig


def _is_more_than_its_bar(ds: xr.Dataset, name: str) -> bool:
    return abs(number(ds, f"{name}_limit")) > number(ds, f"{name}_error")


def _cells(ds: xr.Dataset) -> Floats:
    return array(ds, "cells_per_pitch")


def _draw_values(ax: Axes, ds: xr.Dataset, name: str, colour: str) -> None:
    """One quantity on each grid, its grid-converged value, and the band of the error bar."""
    shown, cells = QUANTITIES[name], _cells(ds)
    limit, error = (number(ds, f"{name}_{part}") * shown.factor for part in ("limit", "error"))
    ax.axhspan(limit - error, limit + error, color=colour, alpha=0.15, linewidth=0)
    ax.axhline(limit, color=colour, linewidth=1.0, linestyle="--")
    ax.plot(cells, array(ds, name) * shown.factor, "o-", color=colour, linewidth=1.6, markersize=5)
    style.dress(ax)
    digits = max(0, 1 - math.floor(math.log10(error))) if error > 0.0 else 3
    text = f"{shown.name}\n{limit:.{digits}f} ± {error:.{digits}f} {shown.unit}"
    ax.set_title(text, fontsize=style.LABEL, color=style.INK)
    _axis_of_cells(ax, cells)


def _draw_errors(ax: Axes, ds: xr.Dataset, names: list[str]) -> None:
    """Relative distances from the grid-converged values, and the error bars of the finest grid."""
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
        label = QUANTITIES[name].name + ("" if trusted else " (no credible order)")
        ax.plot(cells, shown, label=label, linewidth=1.6, linestyle="-" if trusted else ":", **look)
        ax.plot(cells[-1], error / abs(limit), "_", color=style.FAMILY[number_], clip_on=False, **_BAR)
    if largest > 0.0:
        guide = largest * (cells / cells[0]) ** -_DECLARED_ORDER
        ax.plot(cells, guide, color=style.GREY, linewidth=1.0, linestyle="--", label="second order")
    ax.plot([], [], "_", color=style.GREY, label="error bar of the finest grid", **_BAR)
    ax.set_yscale("log")
    style.dress(ax, "cells per pitch")
    ax.set_title("relative distance from the grid-converged value", fontsize=style.LABEL, color=style.INK)
    _axis_of_cells(ax, cells)
    style.legend_below(ax, 4)


def _axis_of_cells(ax: Axes, cells: Floats) -> None:
    ax.set_xscale("log", base=2)
    ax.set_xticks(cells, [f"{count:.0f}" for count in cells])
    ax.minorticks_off()


def _grids_fact(ds: xr.Dataset) -> str:
    cells = [f"{count:.0f}" for count in _cells(ds)]
    if "axial_cells" in ds:
        cells = [f"{one} × {axial:.0f}" for one, axial in zip(cells, array(ds, "axial_cells"), strict=True)]
    return f"grids {', '.join(cells)} cells per pitch" if "axial_cells" not in ds else f"grids {', '.join(cells)} cells"
