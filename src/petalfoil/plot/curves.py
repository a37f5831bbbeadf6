"""Characteristics against the displacement of the journal: the figure 8 of the paper, and the package at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.reading import Flags, Floats, array, unconverged


def load_characteristic(family: Sequence[tuple[str, xr.Dataset]]) -> Figure:
    """Draw load capacity against eccentricity for a family of curves.

    A point that did not converge leaves a gap and a cross on the axis; an unstable one is hollow; a jump to another
    branch is a dotted step.

    Parameters
    ----------
    family : sequence of (str, xarray.Dataset)
        Label and curve.

    Returns
    -------
    matplotlib.figure.Figure
        One line for each curve.

    Raises
    ------
    ConvergenceError
        No point of a curve converged.
    UsageError
        No curve is given, or a dataset is not a curve.
    """
    if not family:
        raise UsageError("a load characteristic needs at least one curve")
    fig = style.figure(8.0, 5.0)
    ax = fig.subplots()
    for number, (label, ds) in enumerate(family):
        draw_characteristic(ax, ds, "bearing_force", number, label)
    style.dress(ax, "eccentricity  e [µm]", "load capacity  |F| [N]")
    finish(ax)
    style.set_title(fig, _common_title([ds for _, ds in family]), *_family_facts([ds for _, ds in family]))
    return fig


def static(ds: xr.Dataset) -> Figure:
    """Draw the reaction of the package at rest against the displacement of the journal, and the torque that starts it.

    Parameters
    ----------
    ds : xarray.Dataset
        Curve of static points.

    Returns
    -------
    matplotlib.figure.Figure
        Reaction, and starting torque where the result has it.

    Raises
    ------
    ConvergenceError
        No point converged.
    UsageError
        The dataset is not a curve.
    """
    shown = {"bearing_force": "reaction  |F| [N]", "starting_torque": "starting torque  M$_0$ [N·m]"}
    shown = {name: label for name, label in shown.items() if name in ds}
    fig = style.figure(8.0, 2.8 * len(shown) + 0.6)
    axes = fig.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for number, (ax, (name, label)) in enumerate(zip(axes, shown.items(), strict=True)):
        draw_characteristic(ax, ds, name, number)
        style.dress(ax, "eccentricity  e [µm]" if ax is axes[-1] else "", label)
        finish(ax)
    style.set_title(fig, ds, "package at rest", _direction_fact([ds]), style.grid_fact(ds))
    return fig


def draw_characteristic(ax: Axes, ds: xr.Dataset, name: str, number: int = 0, label: str = "") -> None:
    """Draw one figure of a curve against the eccentricity, in the colour and with the marker of its number."""
    converged = _converged(ds)
    colour, marker = style.FAMILY[number % len(style.FAMILY)], style.FAMILY_MARKERS[number % len(style.FAMILY_MARKERS)]
    e = along(ds) * 1e6
    value = np.where(converged, array(ds, name), np.nan)
    unstable = converged & ~_flag(ds, "stable", True)
    jump = _flag(ds, "jump", False) & converged
    ax.plot(*_broken(e, value, jump), color=colour, linewidth=1.8)
    points: style.Look = {"linestyle": "none", "marker": marker, "markersize": 5.5, "color": colour}
    settled = np.where(unstable, np.nan, value)
    ax.plot(e, settled, clip_on=False, gid="stable", **points)
    if label:
        ax.plot([], [], label=label, **(points | {"linestyle": "-", "linewidth": 1.8}))
    if unstable.any():
        ax.plot(
            e[unstable], value[unstable], markerfacecolor=style.WHITE, gid="unstable", zorder=3, clip_on=False, **points
        )
    _mark_jumps(ax, e, value, jump, colour)
    if not converged.all():
        ax.plot(
            e[~converged],
            np.zeros((~converged).sum()) + 0.02 * (number + 1),
            "x",
            color=colour,
            gid="failed",
            transform=ax.get_xaxis_transform(),
            markersize=7,
            markeredgewidth=1.8,
            clip_on=False,
        )


def finish(ax: Axes) -> None:
    """Start the axis at nothing, and explain the marks that occur."""
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]) if ax.dataLim.ymin < 0.0 else 0.0)
    ax.margins(x=0.02)
    occurring = {line.get_gid() for line in ax.lines}
    marks: dict[str, style.Look] = {
        "unstable": {"marker": "o", "markerfacecolor": style.WHITE, "linestyle": "none", "label": "unstable"},
        "failed": {"marker": "x", "markeredgewidth": 1.8, "linestyle": "none", "label": "did not converge"},
        "jump": {"linestyle": ":", "linewidth": 1.4, "label": "jump to another branch"},
    }
    for gid, look in marks.items():
        if gid in occurring:
            ax.plot([], [], color=style.GREY, **look)
    style.legend(ax, loc="upper left")


def along(ds: xr.Dataset) -> Floats:
    """Eccentricity along the direction of the farthest point; negative on the other side [m]."""
    e = np.stack([array(ds, "eccentricity_x"), array(ds, "eccentricity_y")])
    size = np.hypot(*e)
    farthest = int(size.argmax())
    projected: Floats = (e[:, farthest] / size[farthest]) @ e if size[farthest] > 0.0 else size
    return projected


def _converged(ds: xr.Dataset) -> Flags:
    if "point" not in ds.dims:
        raise UsageError("a characteristic needs a curve; this dataset holds one point")
    converged = _flag(ds, "converged", False)
    if not converged.any():
        raise unconverged(str(ds["status"].values[-1]) if "status" in ds else "nothing says that it did")
    return converged


def _flag(ds: xr.Dataset, name: str, default: bool) -> Flags:
    return np.asarray(ds[name].values, dtype=np.bool_) if name in ds else np.full(ds.sizes["point"], default)


def _broken(e: Floats, value: Floats, jump: Flags) -> tuple[Floats, Floats]:
    """The line of a curve, lifted from the paper before each jump."""
    places = np.flatnonzero(jump)
    return np.insert(e, places, np.nan), np.insert(value, places, np.nan)


def _mark_jumps(ax: Axes, e: Floats, value: Floats, jump: Flags, colour: str) -> None:
    """A dotted step from the last point that converged before each jump."""
    for point in np.flatnonzero(jump):
        before = np.flatnonzero(np.isfinite(value[:point]))
        if before.size:
            step = [before[-1], point]
            ax.plot(e[step], value[step], ":", color=colour, linewidth=1.4, gid="jump")


def _common_title(curves: Sequence[xr.Dataset]) -> xr.Dataset:
    titles = list(dict.fromkeys(str(ds.attrs.get("title", "")) for ds in curves))
    return xr.Dataset(attrs={"title": titles[0] if len(titles) == 1 else "Load characteristic"})


def _family_facts(curves: Sequence[xr.Dataset]) -> list[str]:
    speeds = [style.speed_fact(float(speed)) for ds in curves for speed in np.unique(array(ds, "speed"))]
    grids = [style.grid_fact(ds, len(curves) == 1) for ds in curves]
    return [", ".join(dict.fromkeys(speeds)), _direction_fact(curves), ", ".join(dict.fromkeys(grids))]


def _direction_fact(curves: Sequence[xr.Dataset]) -> str:
    angles = []
    for ds in curves:
        e_x, e_y = array(ds, "eccentricity_x"), array(ds, "eccentricity_y")
        farthest = int(np.hypot(e_x, e_y).argmax())
        if np.hypot(e_x, e_y)[farthest] > 0.0:
            angles.append(f"{style.signed(float(np.degrees(np.arctan2(e_y, e_x)[farthest])))}°")
    return f"e toward {', '.join(dict.fromkeys(angles))}" if angles else ""
