"""Figures for results of an analysis that brings none of its own: a point, a series, a grid."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.labels import QUANTITIES, PlottedQuantity, quantity
from petalfoil.plot.views import Floats, array, one_point, unconverged
from petalfoil.results.rounding import values_without_rounding
from petalfoil.results.schema import COORDINATES, SCALARS
from petalfoil.results.variable import Role
from petalfoil.text import for_terminal

_MOST_LINES = 24
"""Quantities that one table of a point has space for."""
_MOST_PANELS = 6
_LEVELS = 16
"""Colours of a contour."""


def quantities(ds: xr.Dataset) -> Figure:
    """Draw what a result holds: of a point its quantities, of a series lines, of a grid filled contours.

    Parameters
    ----------
    ds : xarray.Dataset
        Any result. Values of states that did not converge are left out.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each quantity that varies; a table where none does.

    Raises
    ------
    ConvergenceError
        No state converged.
    UsageError
        There is no quantity that can be drawn.
    """
    if "converged" in ds and not ds["converged"].values.any():
        raise unconverged(str(np.ravel(ds["status"].values)[-1]) if "status" in ds else "nothing says that it did")
    if ds.sizes.get("point") == 1:
        ds = ds.isel(point=0)
    for rank, draw in ((2, _contours), (1, _lines)):
        found = [name for name in ds.data_vars if _is_drawn(ds, str(name), rank)]
        if found:
            return draw(ds, _in_order([str(name) for name in found])[:_MOST_PANELS])
    return _table(ds)


def _in_order(names: list[str]) -> list[str]:
    """Quantities that figures have a label for first: the main ones."""
    return sorted(names, key=lambda name: name not in QUANTITIES)


def _is_drawn(ds: xr.Dataset, name: str, rank: int) -> bool:
    """Whether a variable is an answer that varies over `rank` axes along which numbers stand."""
    values = ds[name]
    if values.ndim != rank or values.dtype.kind not in "fi" or min(values.shape) < 2:
        return False
    if name in SCALARS and SCALARS[name].role is not Role.ANSWER:
        return False
    numbered = all(dim == "point" or (dim in ds.coords and ds[dim].dtype.kind in "fi") for dim in values.dims)
    fields = {"petal", "phi", "phi_exposed", "z", "row", "column"}
    return numbered and not fields & set(values.dims) and bool(np.isfinite(_masked(ds, name)).any())


def _masked(ds: xr.Dataset, name: str) -> Floats:
    """Values with those of states that did not converge left out."""
    values = ds[name].where(ds["converged"]) if "converged" in ds else ds[name]
    masked: Floats = np.asarray(values.transpose(*ds[name].dims).values, dtype=np.float64)
    return masked


def _lines(ds: xr.Dataset, names: list[str]) -> Figure:
    dim = str(ds[names[0]].dims[0])
    names = [name for name in names if ds[name].dims == (dim,)]
    swept, label, factor = _swept(ds, dim)
    rows, columns = -(-len(names) // 2), min(len(names), 2)
    fig = style.figure(5.5 * columns, 2.9 * rows + 0.7)
    axes = fig.subplots(rows, columns, squeeze=False).ravel()
    for place, (ax, name) in enumerate(zip(axes, names, strict=False)):
        shown = quantity(ds, name)
        look: style.Look = {"color": style.FAMILY[place % len(style.FAMILY)], "linewidth": 1.6}
        marker = "o" if len(swept) <= 60 else ""
        ax.plot(swept * factor, _masked(ds, name) * shown.factor, marker=marker, markersize=5, **look)
        style.dress(ax, label, style.folded(shown.axis))
    for ax in axes[len(names) :]:
        ax.remove()
    style.set_title(fig, ds, _analysis_fact(ds))
    return fig


def _swept(ds: xr.Dataset, dim: str) -> tuple[Floats, str, float]:
    """What a series is drawn over: its own axis, or the input that changes from point to point."""
    if dim in ds.coords and dim != "point":
        shown = quantity(ds, dim)
        return array(ds, dim), shown.axis, shown.factor
    given = [str(name) for name in ds.data_vars if ds[name].dims == (dim,) and _is_given(str(name))]
    changing = [name for name in given if np.ptp(array(ds, name)) > 0.0]
    if changing:
        widest = max(changing, key=lambda name: len(np.unique(array(ds, name))))
        return array(ds, widest), quantity(ds, widest).axis, quantity(ds, widest).factor
    return np.arange(ds.sizes[dim], dtype=np.float64), "number of the point", 1.0


def _is_given(name: str) -> bool:
    return name in SCALARS and SCALARS[name].role is Role.GIVEN and SCALARS[name].kind.value == "float"


def _contours(ds: xr.Dataset, names: list[str]) -> Figure:
    across, along = (str(dim) for dim in ds[names[0]].dims)
    names = [name for name in names if ds[name].dims == (across, along)]
    horizontal, vertical = (quantity(ds, dim) for dim in (along, across))
    rows, columns = -(-len(names) // 2), min(len(names), 2)
    fig = style.figure(6.0 * columns, 4.0 * rows + 0.7)
    axes = fig.subplots(rows, columns, squeeze=False).ravel()
    for ax, name in zip(axes, names, strict=False):
        shown = quantity(ds, name)
        values = np.ma.masked_invalid(_masked(ds, name) * shown.factor)
        x, y = array(ds, along) * horizontal.factor, array(ds, across) * vertical.factor
        filled = ax.contourf(x, y, values, levels=_LEVELS, cmap=style.PRESSURE_MAP)
        ax.figure.colorbar(filled, ax=ax, pad=0.02).set_label(style.folded(shown.axis), fontsize=style.LABEL)
        style.dress(ax, horizontal.axis, vertical.axis)
    for ax in axes[len(names) :]:
        ax.remove()
    style.set_title(fig, ds, _analysis_fact(ds))
    return fig


def _table(ds: xr.Dataset) -> Figure:
    """Name, value and unit of the answers of a point; of a result without any, as that of `check`, its geometry."""
    ds = one_point(ds)
    names = [str(name) for name in ds.data_vars]
    told = [name for name in names if _is_told(ds, name, Role.ANSWER)] or [
        name for name in names if _is_told(ds, name, Role.GEOMETRY)
    ]
    lines = [(quantity(ds, name), float(values_without_rounding(ds, name))) for name in told]
    if not lines:
        raise UsageError("this result holds no quantity that a figure could show")
    lines = lines[:_MOST_LINES]
    fig = style.figure(8.0, 0.9 + 0.28 * len(lines))
    ax = fig.subplots()
    ax.set_axis_off()
    cells = [[shown.name, _written(shown, value), shown.unit] for shown, value in lines]
    table = ax.table(cells, colWidths=[0.62, 0.14, 0.24], loc="center", edges="horizontal")
    table.auto_set_font_size(False)
    table.set_fontsize(style.TICK)
    for (_, column), cell in table.get_celld().items():
        cell.set_text_props(ha=("left", "right", "left")[column])
        cell.set_edgecolor(style.PALE)
    style.set_title(fig, ds, _analysis_fact(ds))
    return fig


def _is_told(ds: xr.Dataset, name: str, role: Role) -> bool:
    of_role = SCALARS[name].role is role if name in SCALARS else role is Role.ANSWER
    numeric = ds[name].ndim == 0 and ds[name].dtype.kind in "fi" and name not in COORDINATES
    return of_role and numeric and bool(np.isfinite(float(ds[name])))


def _written(shown: PlottedQuantity, value: float) -> str:
    return f"{value * shown.factor + 0.0:.4g}".replace("-", "−")


def _analysis_fact(ds: xr.Dataset) -> str:
    return for_terminal(str(ds.attrs.get("analysis", "")))
