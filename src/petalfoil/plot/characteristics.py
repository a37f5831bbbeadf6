"""Characteristics against the displacement of the journal: at speed, at zero speed, and hysteresis."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import labels, style
from petalfoil.plot.labels import MICRO, QUANTITIES
from petalfoil.plot.section import cross_section, operating_point
from petalfoil.plot.views import Flags, Floats, array, unconverged

_FILM = ("bearing_force", "min_film_thickness", "friction_torque", "contact_fraction")
"""Quantities of a curve at speed."""
_ZERO_SPEED = ("bearing_force", "starting_torque")
"""Quantities of a curve at zero speed."""
LEGS = {"loading": (style.GREY, "--"), "unloading": (style.BLUE, "-"), "reloading": (style.VERMILLION, "-")}
"""Colour and line of each leg of a hysteresis."""


def curve(ds: xr.Dataset) -> Figure:
    """Draw force, minimum film thickness, friction torque and contact fraction against eccentricity.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``curve``, ``solve`` or ``balance``; a single point is drawn as `operating_point` does.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each quantity that the result has.

    Raises
    ------
    ConvergenceError
        No point converged.
    """
    if ds.sizes.get("point", 1) == 1:
        return operating_point(ds)
    shown = [name for name in _FILM if name in ds]
    fig = style.figure(11.0, 3.1 * ((len(shown) + 1) // 2) + 0.8)
    _draw_panels(fig, ds, shown, 2)
    style.set_title(fig, ds, *_family_facts([ds]))
    return fig


def load_characteristic(family: Sequence[tuple[str, xr.Dataset]]) -> Figure:
    """Draw the bearing force against eccentricity for a family of curves.

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
    style.dress(ax, QUANTITIES["eccentricity"].axis, QUANTITIES["bearing_force"].axis)
    finish(ax)
    style.set_title(fig, _common_title([ds for _, ds in family]), *_family_facts([ds for _, ds in family]))
    return fig


def static(ds: xr.Dataset) -> Figure:
    """Draw the force of the foil pack at zero speed against the displacement of the journal, and its starting torque.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``static``; a single point is drawn as `cross_section`, a loop as `hysteresis`.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each quantity that the result has.

    Raises
    ------
    ConvergenceError
        No point converged.
    """
    if ds.sizes.get("point", 1) == 1:
        return cross_section(ds)
    if is_loop(ds):
        return hysteresis(ds)
    shown = [name for name in _ZERO_SPEED if name in ds]
    fig = style.figure(8.0, 2.8 * len(shown) + 0.6)
    _draw_panels(fig, ds, shown, 1)
    style.set_title(fig, ds, "foil pack at zero speed", _direction_fact([ds]), labels.grid_fact(ds))
    return fig


def _draw_panels(fig: Figure, ds: xr.Dataset, names: Sequence[str], columns: int) -> None:
    """One quantity in each panel; the lowest panels name the eccentricity, the first explains the marks."""
    rows = -(-len(names) // columns)
    for number, name in enumerate(names):
        ax = fig.add_subplot(rows, columns, number + 1)
        draw_characteristic(ax, ds, name, number)
        lowest = number + columns >= len(names)
        style.dress(ax, QUANTITIES["eccentricity"].axis if lowest else "", QUANTITIES[name].axis)
        finish(ax, explain=number == 0)
        if name == "contact_fraction":
            _frame_contact(ax, ds)


def _frame_contact(ax: Axes, ds: xr.Dataset) -> None:
    """Let the axis of the contact fraction reach a per cent at least, and say where there is none."""
    largest = 100.0 * float(np.nanmax(array(ds, "contact_fraction")))
    ax.set_ylim(0.0, max(1.1 * largest, 1.0))
    if largest == 0.0:
        ax.text(0.5, 0.5, "no contact", transform=ax.transAxes, ha="center", color=style.GREY, fontsize=style.LABEL)


def draw_characteristic(ax: Axes, ds: xr.Dataset, name: str, number: int = 0, label: str = "") -> None:
    """Draw one quantity of a curve against the eccentricity, in the colour and with the marker of its number."""
    converged = _converged(ds)
    colour, marker = style.FAMILY[number % len(style.FAMILY)], style.FAMILY_MARKERS[number % len(style.FAMILY_MARKERS)]
    e = along(ds) * MICRO
    value = np.where(converged, array(ds, name), np.nan) * QUANTITIES[name].factor
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


def finish(ax: Axes, explain: bool = True) -> None:
    """Start the vertical axis at zero, and explain the marks that occur."""
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]) if ax.dataLim.ymin < 0.0 else 0.0)
    ax.margins(x=0.02)
    if not explain:
        return
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
    """The line of a curve, interrupted before each jump."""
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
    speeds = [labels.speed_fact(float(speed)) for ds in curves for speed in np.unique(array(ds, "speed"))]
    grids = [labels.grid_fact(ds) for ds in curves]
    return [", ".join(dict.fromkeys(speeds)), _direction_fact(curves), ", ".join(dict.fromkeys(grids))]


def _direction_fact(curves: Sequence[xr.Dataset]) -> str:
    angles = []
    for ds in curves:
        e_x, e_y = array(ds, "eccentricity_x"), array(ds, "eccentricity_y")
        farthest = int(np.hypot(e_x, e_y).argmax())
        if np.hypot(e_x, e_y)[farthest] > 0.0:
            angles.append(f"{labels.signed(float(np.degrees(np.arctan2(e_y, e_x)[farthest])))}°")
    return f"e toward {', '.join(dict.fromkeys(angles))}" if angles else ""


# ---------------------------------------------- hysteresis


def is_loop(ds: xr.Dataset) -> bool:
    """Whether a static curve is loaded, unloaded and loaded again."""
    return "leg" in ds and {"unloading", "reloading"} <= set(ds["leg"].to_numpy().tolist())


def hysteresis(ds: xr.Dataset) -> Figure:
    """Draw the force along a loop, and how far unloading and reloading stand from their mean.

    Parameters
    ----------
    ds : xarray.Dataset
        Static curve of a foil pack with friction, made as a loop.

    Returns
    -------
    matplotlib.figure.Figure
        Force against displacement; below, the part of it that changes sign with the direction of motion.

    Raises
    ------
    UsageError
        The dataset is no loop.
    """
    if not is_loop(ds):
        raise UsageError("a hysteresis needs a static curve with friction, made as a loop")
    fig = style.figure(8.0, 6.2)
    above, below = fig.subplots(2, 1, sharex=True)
    legs = {leg: force_along(ds, leg) for leg in LEGS}
    for leg, (e, force) in legs.items():
        colour, line = LEGS[leg]
        above.plot(e, force, color=colour, linestyle=line, linewidth=1.6, marker="o", markersize=3.5, label=leg)
    _draw_deviation(below, legs["unloading"], legs["reloading"])
    style.dress(above, "", "force against the displacement [N]")
    style.dress(below, QUANTITIES["eccentricity"].axis, "deviation from the mean [N]")
    style.legend(above, loc="upper left")
    style.set_title(
        fig, ds, "friction between petals", f"energy loss per cycle {cycle(ds):.3g} µJ", labels.grid_fact(ds)
    )
    return fig


def force_along(ds: xr.Dataset, leg: str) -> tuple[Floats, Floats]:
    """Displacement [µm] and force against it [N] of one leg, the turning point before it included."""
    legs = ds["leg"].to_numpy().tolist()
    chosen = [number for number, name in enumerate(legs) if name == leg]
    first = max(chosen[0] - 1, 0)
    points = np.arange(first, chosen[-1] + 1)
    e = np.stack([array(ds, "eccentricity_x"), array(ds, "eccentricity_y")])
    far = e[:, int(np.argmax(np.hypot(*e)))]
    against: Floats = -(far / np.hypot(*far)) @ np.stack([array(ds, "force_x"), array(ds, "force_y")])
    return along(ds)[points] * MICRO, against[points]


def _draw_deviation(ax: Axes, down: tuple[Floats, Floats], up: tuple[Floats, Floats]) -> None:
    """Draw unloading and reloading less their mean."""
    e = np.sort(up[0])
    unloading, loading = np.interp(e, down[0][::-1], down[1][::-1]), np.interp(e, *up)
    mean = 0.5 * (loading + unloading)
    for leg, force in (("unloading", unloading), ("reloading", loading)):
        ax.plot(e, force - mean, color=LEGS[leg][0], linewidth=1.6, marker="o", markersize=3.5)
    ax.axhline(0.0, color=style.GREY, linewidth=0.6, zorder=0)


def cycle(ds: xr.Dataset) -> float:
    """Energy lost from the end of loading to the end of reloading [µJ]."""
    legs, lost = ds["leg"].to_numpy().tolist(), array(ds, "petal_friction_work")
    begin = max(number for number, name in enumerate(legs) if name == "loading")
    return float(lost[-1] - lost[begin]) * MICRO
