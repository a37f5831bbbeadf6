"""A study over its parameters: lines over one, contours over two, parallel coordinates over more, a scatter matrix."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from petalfoil.plot import style
from petalfoil.plot.labels import PlottedQuantity, plain
from petalfoil.plot.study_views import (
    Floats,
    count_fact,
    in_unit,
    of_cases,
    parameter,
    parameters,
    result,
    shown_results,
)

FAMILY = 6
"""Levels of a second parameter that are lines in one panel; more are contours."""
_LEVELS = 14
_EDGE = 0.02
"""Where the hatching of cases without an answer begins, from 0 at their neighbours to 1: nearly at the neighbours."""
_STACKED = 0.04
"""Part of the height of a panel between the crosses of one line and the next."""
_MATRIX = 6
"""Columns of a scatter matrix."""


def sweep(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw a study over what varies.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a sweep.
    names : tuple of str
        Results to show; by default the first few that vary.

    Returns
    -------
    matplotlib.figure.Figure
        Lines over one parameter (and a few levels of a second one), filled contours over two, parallel coordinates over
        more and of a sample. Cases without an answer are marked.

    Raises
    ------
    UsageError
        No result varies.
    """
    ds = of_cases(ds)
    dims = ds["converged"].dims
    if dims == ("case",) or len(dims) > 2:
        return parallel_coordinates(ds, names)
    if len(dims) == 1 or min(ds.sizes[dim] for dim in dims) <= FAMILY:
        return _lines(ds, names)
    return _contours(ds, names)


def _panels(ds: xr.Dataset, names: list[str]) -> tuple[Figure, list[Axes]]:
    columns = 1 if len(names) == 1 else 2
    rows = -(-len(names) // columns)
    fig = style.figure(7.0 if columns == 1 else 10.5, 4.4 if rows == 1 else 3.5 * rows)
    axes = list(fig.subplots(rows, columns, squeeze=False).ravel())
    for ax in axes[len(names) :]:
        ax.remove()
    style.set_title(fig, ds, f"{ds.attrs['analysis']} of {ds.attrs['asked']}", count_fact(ds))
    return fig, axes


def _lines(ds: xr.Dataset, names: tuple[str, ...]) -> Figure:
    """A line for each level of the second parameter."""
    shown = shown_results(ds, names)
    dims = sorted((str(dim) for dim in ds["converged"].dims), key=lambda dim: -ds.sizes[dim])
    along, family = dims[0], dims[1] if len(dims) == 2 else None
    fig, axes = _panels(ds, shown)
    horizontal = parameter(ds, along)
    x = in_unit(ds, along, horizontal)
    order = np.argsort(x)
    for ax, name in zip(axes, shown, strict=False):
        vertical = result(ds, name)
        for number in range(ds.sizes[family] if family else 1):
            line = ds.isel({family: number}) if family else ds
            look: dict[str, Any] = {
                "color": style.FAMILY[number % 7],
                "marker": style.FAMILY_MARKERS[number % 7],
                "markersize": 4.0,
            }
            label = _level(ds, family, number) if family else None
            y = in_unit(line, name, vertical)
            ax.plot(x[order], y[order], label=label, **look)
            _mark_failed(ax, x[~line["converged"].values], number, str(look["color"]) if family else style.VERMILLION)
        style.dress(ax, horizontal.axis, style.folded(vertical.axis))
    if axes[0].get_legend_handles_labels()[1]:
        style.legend_below(axes[0], FAMILY)
    return fig


def _level(ds: xr.Dataset, name: str, number: int) -> str:
    shown = parameter(ds, name)
    return f"{shown.name} {float(ds[name].values[number]) * shown.factor:.6g} {shown.unit}".strip()


def _mark_failed(ax: Axes, x: Floats, number: int, colour: str) -> None:
    """A cross where a case has no answer: on the upper edge of the panel, beyond it for further lines."""
    if x.size:
        look: dict[str, Any] = {
            "color": colour,
            "markersize": 7.0,
            "markeredgewidth": 2.0,
            "clip_on": False,
            "zorder": 5,
        }
        told = "no answer" in ax.get_legend_handles_labels()[1]
        label = "_no answer" if told else "no answer"
        ax.plot(
            x, np.full_like(x, 1.0 + _STACKED * number), "x", label=label, transform=ax.get_xaxis_transform(), **look
        )


def _contours(ds: xr.Dataset, names: tuple[str, ...]) -> Figure:
    """Filled contours; hatched where there is no answer."""
    shown = shown_results(ds, names)
    fig, axes = _panels(ds, shown)
    down, across = (str(dim) for dim in ds["converged"].dims)
    horizontal, vertical = parameter(ds, across), parameter(ds, down)
    for ax, name in zip(axes, shown, strict=False):
        told = result(ds, name)
        _contour(ax, ds, name, told)
        style.dress(ax, horizontal.axis, vertical.axis)
    style.legend_below(axes[0], 2)
    return fig


def _contour(ax: Axes, ds: xr.Dataset, name: str, told: PlottedQuantity) -> None:
    down, across = (str(dim) for dim in ds["converged"].dims)
    ds = ds.sortby([down, across])
    x, y = in_unit(ds, across, parameter(ds, across)), in_unit(ds, down, parameter(ds, down))
    values = in_unit(ds.transpose(down, across), name, told)
    filled = ax.contourf(x, y, np.ma.masked_invalid(values), levels=_LEVELS, cmap=style.PRESSURE_MAP)
    ax.figure.colorbar(filled, ax=ax, pad=0.02).set_label(style.folded(told.axis), fontsize=style.LABEL)
    for label, hatch, marker, where in _without_answer(ds.transpose(down, across)):
        ax.contourf(x, y, where.astype(float), levels=[_EDGE, 1.0], colors="none", hatches=[hatch], extend="max")
        at_y, at_x = np.nonzero(where)
        look: dict[str, Any] = {"color": style.VERMILLION, "markersize": 5.0, "clip_on": False, "linestyle": "none"}
        ax.plot(x[at_x], y[at_y], marker, label=label, **look)


def _without_answer(ds: xr.Dataset) -> list[tuple[str, str, str, NDArray[np.bool_]]]:
    """Regions without an answer: label, hatch, marker and cases of those that there are."""
    invalid = ds["status"].values == "invalid case"
    regions = [
        ("cannot be built", "....", "s", invalid),
        ("no answer", "////", "x", ~ds["converged"].values & ~invalid),
    ]
    return [region for region in regions if region[-1].any()]


def _columns(ds: xr.Dataset, names: tuple[str, ...]) -> list[tuple[PlottedQuantity, Floats]]:
    """Parameters and results of every case, one column each."""
    varied, shown = parameters(ds), shown_results(ds, names)
    told = [(parameter(ds, name), name) for name in varied] + [(result(ds, name), name) for name in shown]
    return [(quantity, _of_each_case(ds, in_unit(ds, name, quantity), ds[name].dims)) for quantity, name in told]


def _of_each_case(ds: xr.Dataset, values: Floats, dims: tuple[Hashable, ...]) -> Floats:
    """Values over some of the dimensions of a study for all its cases, (case,)."""
    cases = xr.DataArray(ds["converged"].values, dims=ds["converged"].dims)  # an index would not be broadcast
    whole = xr.DataArray(values, dims=dims).broadcast_like(cases).transpose(*cases.dims)
    return np.asarray(whole.values, dtype=np.float64).ravel()


def parallel_coordinates(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw each case as a line over its parameters and results, coloured by the last result.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a study.
    names : tuple of str
        Results to show; by default the first few that vary.

    Returns
    -------
    matplotlib.figure.Figure
        One axis for each parameter and result; cases without an answer are dashed and end at their parameters.
    """
    ds = of_cases(ds)
    columns, converged = _columns(ds, names), ds["converged"].values.ravel()
    fig = style.figure(1.7 * len(columns) + 1.5, 4.8)
    ax = fig.subplots()
    scaled = np.array([_scaled(values) for _, values in columns])
    colour = scaled[-1]
    for case in range(scaled.shape[1]):
        look: dict[str, Any] = {"color": style.VERMILLION, "linestyle": ":", "alpha": 0.8}
        if converged[case] and np.isfinite(colour[case]):
            look = {"color": _colour(colour[case]), "alpha": 0.6}
        ax.plot(range(len(columns)), scaled[:, case], linewidth=0.9, **look)
    for number, (told, values) in enumerate(columns):
        ax.axvline(number, color=style.GREY, linewidth=0.8)
        for level, edge in ((np.nanmin(values), -0.04), (np.nanmax(values), 1.02)):
            ax.text(number, edge, plain(level), ha="center", va="top" if edge < 0 else "bottom", fontsize=style.TICK)
        ax.text(number, -0.13, style.folded(told.axis, 18), ha="center", va="top", fontsize=style.TICK)
    ax.set_ylim(-0.02, 1.02)
    ax.set_axis_off()
    style.set_title(fig, ds, f"{ds.attrs['analysis']} of {ds.attrs['asked']}", count_fact(ds))
    return fig


def scatter_matrix(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw results against parameters, one panel for each pair.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a study.
    names : tuple of str
        Results to show; by default the first few that vary.

    Returns
    -------
    matplotlib.figure.Figure
        A row for each result, a column for each parameter.
    """
    ds = of_cases(ds)
    columns, varied = _columns(ds, names), parameters(ds)
    given, told = columns[: len(varied)][:_MATRIX], columns[len(varied) :]
    fig = style.figure(2.3 * len(given) + 1.2, 2.1 * len(told) + 0.8)
    axes = fig.subplots(len(told), len(given), squeeze=False, sharex="col", sharey="row")
    for row, (vertical, y) in enumerate(told):
        for column, (horizontal, x) in enumerate(given):
            ax = axes[row, column]
            ax.plot(x, y, ".", color=style.BLUE, markersize=3.0, alpha=0.6)
            last = row == len(told) - 1
            label = style.folded(vertical.axis, 18) if column == 0 else ""
            style.dress(ax, style.folded(horizontal.axis, 20) if last else "", label)
    style.set_title(fig, ds, f"{ds.attrs['analysis']} of {ds.attrs['asked']}", count_fact(ds))
    return fig


def _scaled(values: Floats) -> Floats:
    low, high = np.nanmin(values), np.nanmax(values)
    return np.full_like(values, 0.5) if high == low else (values - low) / (high - low)


def _colour(part: float) -> Any:
    from matplotlib import colormaps

    return colormaps[style.PRESSURE_MAP](0.9 * part)
