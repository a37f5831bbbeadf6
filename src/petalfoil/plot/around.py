"""Pressure and film against the bushing angle: the figures 6 and 7 of the paper, once around the bearing."""

from __future__ import annotations

import math

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.reading import (
    array,
    is_spatial,
    mid_plane,
    number,
    one_point,
    strip_edges,
    strip_middles,
    strips,
    touching,
)


def pressure_and_film(ds: xr.Dataset) -> Figure:
    """Draw pressure and film thickness over the exposed part of each petal against the bushing angle.

    A spatial result is shown at its mid-plane. Petal edges are marked, and where the journal touches.

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
    style.set_title(fig, ds, *style.state_facts(ds), plane_fact(ds))
    return fig


def plane_fact(ds: xr.Dataset) -> str:
    """Which section a title should name."""
    return f"mid-plane, z = {float(mid_plane(ds)['z']) * 1e3:.4g} mm" if is_spatial(ds) else ""


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
    _frame(ax, ds, "pressure  p / p$_a$")
    _number_petals(ax, ds)
    _remark(ax, "largest", number(ds, "peak_pressure") * 1e-3, "kPa", number(ds, "peak_pressure_angle"))


def draw_film(ax: Axes, ds: xr.Dataset) -> None:
    """Draw the film thickness of the mid-plane against the bushing angle, and where the journal touches."""
    plane = mid_plane(ds)
    film = array(plane, "film_thickness") * 1e6
    contact = touching(plane, "journal_contact_pressure") if "journal_contact_pressure" in ds else None
    label: str | None = "journal touches"
    for strip in strips(plane):
        ax.plot(strip.degrees, film[strip.petal], color=style.ALTERNATING[strip.petal % 2], linewidth=1.8)
        if contact is not None and contact[strip.petal].any():
            touched = contact[strip.petal]
            places = (strip.degrees[touched], film[strip.petal][touched])
            ax.plot(*places, "o", color=style.CONTACT, markersize=3.5, label=label, zorder=3)
            label = None
    floor = number(ds, "contact_film_thickness") * 1e6
    if not math.isnan(floor):
        ax.axhline(floor, color=style.GREY, linewidth=1.0, linestyle="--", label=f"film floor, {floor:.3g} µm")
    ax.set_yscale("log")
    ax.set_ylim(0.7 * min(film.min(), floor if floor > 0.0 else math.inf), 3.0 * film.max())
    style.logarithmic(ax.yaxis)
    _frame(ax, ds, "film thickness  h [µm]")
    _remark(ax, "smallest", number(ds, "min_film_thickness") * 1e6, "µm", number(ds, "min_film_thickness_angle"))
    style.legend(ax, loc="upper left", ncols=2)


def _frame(ax: Axes, ds: xr.Dataset, ylabel: str) -> None:
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
    at = "" if math.isnan(angle) else f" at {style.signed(math.degrees(angle) % 360.0)}°"
    box = {"facecolor": style.WHITE, "edgecolor": "none", "alpha": 0.8, "pad": 1.5}
    text = f"{which} {value:.4g} {unit}{at}"
    ax.text(
        0.99, 0.97, text, transform=ax.transAxes, ha="right", va="top", fontsize=style.TICK, color=style.INK, bbox=box
    )
