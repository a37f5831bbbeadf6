"""Pressure and film thickness: around the bearing, over one petal for a family, as maps of angle and length."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import labels, style
from petalfoil.plot.labels import MICRO
from petalfoil.plot.views import (
    ON_JOURNAL,
    Floats,
    array,
    contact_places,
    is_3d,
    mid_plane,
    number,
    one_point,
    strip_edges,
    strip_middles,
    strips,
    touching,
)

_RASTER = 3.0
"""Points per degree of the raster that shades the maps."""
_STATIONS = 120
"""Points of that raster along the axis."""


def pressure_and_film(ds: xr.Dataset) -> Figure:
    """Draw pressure and film thickness over the exposed part of each petal against the bushing angle.

    A 3-D result is shown at its mid-plane. Petal edges are marked, and where the journal is in contact.

    Parameters
    ----------
    ds : xarray.Dataset
        One converged state with pressure and film.

    Returns
    -------
    matplotlib.figure.Figure
        Pressure above, film below.

    Raises
    ------
    ConvergenceError
        The state did not converge.
    UsageError
        The dataset holds several points.
    """
    ds = one_point(ds)
    fig = style.figure(8.0, 5.6)
    above, below = fig.subplots(2, 1, sharex=True)
    draw_pressure(above, ds)
    draw_film(below, ds)
    above.set_xlabel("")
    style.set_title(fig, ds, *labels.state_facts(ds), labels.plane_fact(ds))
    return fig


def draw_pressure(ax: Axes, ds: xr.Dataset) -> None:
    """Draw p/p_a of the mid-plane against the bushing angle."""
    plane = mid_plane(ds)
    ratio = array(plane, "pressure") / number(ds, "ambient_pressure")
    for strip in strips(plane):
        colour = style.ALTERNATING[strip.petal % 2]
        ax.plot(strip.degrees, ratio[strip.petal], color=colour, linewidth=1.8)
        ax.fill_between(strip.degrees, 1.0, ratio[strip.petal], color=colour, alpha=0.18, linewidth=0)
    ax.axhline(1.0, color=style.GREY, linewidth=0.8)
    low, high = min(ratio.min(), 1.0), max(ratio.max(), 1.0)
    spread = max(high - low, 0.02)
    ax.set_ylim(low - 0.06 * spread, high + 0.22 * spread)
    _frame_circle(ax, ds, "pressure  p / p$_a$")
    _number_petals(ax, ds)
    _remark(ax, "peak", number(ds, "peak_pressure") * 1e-3, "kPa", number(ds, "peak_pressure_angle"))


def draw_film(ax: Axes, ds: xr.Dataset) -> None:
    """Draw the film thickness of the mid-plane against the bushing angle, and where the journal is in contact."""
    plane = mid_plane(ds)
    film = array(plane, "film_thickness") * MICRO
    placed = "contact_force" in plane  # contacts between nodes have their own places
    at_nodes = "journal_contact_pressure" in ds and not placed
    contact = touching(plane, "journal_contact_pressure") if at_nodes else None
    label: str | None = "journal in contact"
    if placed and len(angles := contact_places(plane, ON_JOURNAL)[0]):
        degrees = np.degrees(np.mod(angles, 2.0 * np.pi))
        floor = np.full(len(angles), number(ds, "contact_film_thickness") * MICRO)
        ax.plot(degrees, floor, "o", color=style.CONTACT, markersize=3.5, label=label, zorder=3)
    for strip in strips(plane):
        ax.plot(strip.degrees, film[strip.petal], color=style.ALTERNATING[strip.petal % 2], linewidth=1.8)
        if contact is not None and contact[strip.petal].any():
            touched = contact[strip.petal]
            places = (strip.degrees[touched], film[strip.petal][touched])
            ax.plot(*places, "o", color=style.CONTACT, markersize=3.5, label=label, zorder=3)
            label = None
    least = number(ds, "contact_film_thickness") * MICRO
    if not math.isnan(least):
        ax.axhline(
            least, color=style.GREY, linewidth=1.0, linestyle="--", label=f"contact film thickness, {least:.3g} µm"
        )
    ax.set_yscale("log")
    ax.set_ylim(0.7 * min(film.min(), least if least > 0.0 else math.inf), 9.0 * film.max())
    style.logarithmic(ax.yaxis)
    _frame_circle(ax, ds, "film thickness  h [µm]")
    _remark(ax, "minimum", number(ds, "min_film_thickness") * MICRO, "µm", number(ds, "min_film_thickness_angle"))
    style.legend(ax, loc="upper left", fontsize=style.TICK - 1.0, handlelength=1.4)


def _frame_circle(ax: Axes, ds: xr.Dataset, ylabel: str) -> None:
    style.dress(ax, "bushing angle  θ [deg]", ylabel)
    style.full_circle(ax)
    for edge in strip_edges(ds):
        ax.axvline(edge, color=style.GREY, linewidth=0.8, linestyle=":")


def _number_petals(ax: Axes, ds: xr.Dataset) -> None:
    if ds.sizes["petal"] == 1:
        return
    place: style.Look = {"va": "bottom", "fontsize": style.TICK, "color": style.GREY}
    for petal, middle in zip(ds["petal"].values, strip_middles(ds), strict=True):
        ax.text(middle, 1.01, f"{petal}", transform=ax.get_xaxis_transform(), ha="center", **place)
    ax.text(-0.012, 1.01, "petal", transform=ax.transAxes, ha="right", **place)


def _remark(ax: Axes, which: str, value: float, unit: str, angle: float) -> None:
    if math.isnan(value):
        return
    at = "" if math.isnan(angle) else f" at {labels.signed(math.degrees(angle) % 360.0)}°"
    box = {"facecolor": style.WHITE, "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
    text = f"{which} {value:.4g} {unit}{at}"
    ax.text(
        0.99, 0.97, text, transform=ax.transAxes, ha="right", va="top", fontsize=style.TICK, color=style.INK, bbox=box
    )


# ---------------------------------------------- one petal


def petal_profiles(family: Sequence[tuple[str, xr.Dataset]], *, petal: int = 0) -> Figure:
    """Draw pressure and film over the exposed part of one petal against the angle from its root.

    3-D results are shown at their mid-plane.

    Parameters
    ----------
    family : sequence of (str, xarray.Dataset)
        Label and converged state.
    petal : int
        Number of the petal; with a centred journal all are alike.

    Returns
    -------
    matplotlib.figure.Figure
        Pressure above, film below, one line for each state.

    Raises
    ------
    ConvergenceError
        A state did not converge.
    UsageError
        No state is given, one is a curve of several points, or has no such petal.
    """
    if not family:
        raise UsageError("profiles need at least one state")
    states = [(label, _with_petal(ds, petal)) for label, ds in family]
    fig = style.figure(8.0, 6.4)
    above, below = fig.subplots(2, 1, sharex=True)
    for place, (label, ds) in enumerate(states):
        plane = mid_plane(ds)
        degrees = np.degrees(array(ds, "phi_exposed"))
        look: style.Look = {"color": style.FAMILY[place % len(style.FAMILY)], "linewidth": 1.8}
        above.plot(degrees, array(plane, "pressure")[petal] / number(ds, "ambient_pressure"), label=label, **look)
        below.plot(degrees, array(plane, "film_thickness")[petal] * MICRO, **look)
    above.axhline(1.0, color=style.GREY, linewidth=0.8)
    below.set_yscale("log")
    style.logarithmic(below.yaxis)
    style.dress(above, "", "pressure  p / p$_a$")
    style.dress(below, "angle from the petal's root  φ [deg]", "film thickness  h [µm]")
    style.legend(above, loc="upper left")
    style.set_title(fig, _family_title(states), *_shared_facts(states))
    return fig


def _with_petal(ds: xr.Dataset, petal: int) -> xr.Dataset:
    ds = one_point(ds)
    if not 0 <= petal < ds.sizes["petal"]:
        raise UsageError(f"there is no petal {petal}: petals are numbered 0 to {ds.sizes['petal'] - 1}")
    return ds


def _family_title(states: Sequence[tuple[str, xr.Dataset]]) -> xr.Dataset:
    titles = list(dict.fromkeys(str(ds.attrs.get("title", "")) for _, ds in states))
    return xr.Dataset(attrs={"title": titles[0] if len(titles) == 1 else "Exposed part of one petal"})


def _shared_facts(states: Sequence[tuple[str, xr.Dataset]]) -> list[str]:
    """What the states share; what differs is told by their labels."""
    facts = [
        (
            labels.speed_fact(number(ds, "speed")),
            labels.displacement_fact(ds),
            labels.grid_fact(ds),
            labels.plane_fact(ds),
        )
        for _, ds in states
    ]
    return [values[0] for values in zip(*facts, strict=True) if len(set(values)) == 1]


# ---------------------------------------------- maps


def maps(ds: xr.Dataset) -> Figure:
    """Draw pressure and film thickness over bushing angle and length, with the contact of the journal outlined.

    Parameters
    ----------
    ds : xarray.Dataset
        One converged state of the 3-D model.

    Returns
    -------
    matplotlib.figure.Figure
        Pressure above, film below.

    Raises
    ------
    ConvergenceError
        The state did not converge.
    UsageError
        The result is of the 2-D model, or holds several points.
    """
    ds = one_point(ds)
    fig = style.figure(8.0, 5.6)
    above, below = fig.subplots(2, 1, sharex=True)
    draw_pressure_map(above, ds)
    draw_film_map(below, ds)
    above.set_xlabel("")
    style.set_title(fig, ds, *labels.state_facts(ds))
    return fig


def draw_pressure_map(ax: Axes, ds: xr.Dataset) -> None:
    """Draw p/p_a over bushing angle and length."""
    ratio = array(ds, "pressure") / number(ds, "ambient_pressure")
    _draw_map(ax, ds, ratio, Normalize(ratio.min(), max(ratio.max(), ratio.min() + 1e-3)), style.PRESSURE_MAP)
    ax.figure.colorbar(ax.collections[0], ax=ax, pad=0.01, aspect=14).set_label("p / p$_a$", fontsize=style.LABEL)
    if "journal_contact_pressure" in ds and touching(ds, "journal_contact_pressure").any():
        ax.plot([], [], color=style.CONTACT, linewidth=1.4, label="journal in contact")
        style.legend(ax, loc="upper right")


def draw_film_map(ax: Axes, ds: xr.Dataset) -> None:
    """Draw the film thickness over bushing angle and length."""
    film = array(ds, "film_thickness") * MICRO
    _draw_map(ax, ds, film, LogNorm(film.min(), max(film.max(), 1.01 * film.min())), style.FILM_MAP)
    bar = ax.figure.colorbar(ax.collections[0], ax=ax, pad=0.01, aspect=14)
    bar.set_label("film thickness  h [µm]", fontsize=style.LABEL)
    style.logarithmic(bar.ax.yaxis)


def _draw_map(ax: Axes, ds: xr.Dataset, values: Floats, norm: Normalize, colours: str) -> None:
    if not is_3d(ds):
        raise UsageError("maps need a result of the 3-D model; the 2-D one has a single station: use pressure_and_film")
    z = array(ds, "z") * 1e3
    for strip in strips(ds):
        degrees, stations, shade = refined(strip.degrees, z, values[strip.petal])
        ax.pcolormesh(degrees, stations, shade.T, norm=norm, cmap=colours, shading="nearest", rasterized=True)
    outline_contact(ax, ds, z)
    for edge in strip_edges(ds):
        ax.axvline(edge, color=style.WHITE, linewidth=0.8, linestyle=":")
    style.dress(ax, "bushing angle  θ [deg]", "z [mm]")
    style.full_circle(ax)
    ax.grid(False)
    ax.set_ylim(z[0], z[-1])


def refined(x: Floats, y: Floats, values: Floats) -> tuple[Floats, Floats, Floats]:
    """Interpolate nodal values bilinearly to a raster fine enough to look smooth."""
    fine_x = np.linspace(x[0], x[-1], 2 + math.ceil(_RASTER * (x[-1] - x[0])))
    fine_y = np.linspace(y[0], y[-1], _STATIONS)
    along_x = np.stack([np.interp(fine_x, x, column) for column in values.T], axis=1)
    both: Floats = np.stack([np.interp(fine_y, y, row) for row in along_x])
    return fine_x, fine_y, both


def outline_contact(ax: Axes, ds: xr.Dataset, z: Floats) -> None:
    """Draw a line around every area where the journal is in contact."""
    if "journal_contact_pressure" not in ds:
        return
    contact = touching(ds, "journal_contact_pressure").astype(np.float64)
    for strip in strips(ds):
        if contact[strip.petal].any():
            ax.contour(strip.degrees, z, contact[strip.petal].T, levels=[0.5], colors=[style.CONTACT], linewidths=1.4)
