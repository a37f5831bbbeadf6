"""Stability of a rigid rotor: critical mass and whirl ratio over speed and load; one point with its natural modes."""

from __future__ import annotations

import math

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from petalfoil.case import NEUTRAL
from petalfoil.plot import labels, style
from petalfoil.plot.campbell_diagram import campbell
from petalfoil.plot.labels import HERTZ, QUANTITIES, RPM
from petalfoil.plot.views import Floats, array, needs_result_of, number, unconverged

WIDE = 5.0
"""Factor between masses past which they are drawn on a logarithmic axis."""
_USUAL_RATIO = 0.6
"""Whirl ratio up to which the axis goes at least: half-speed whirl is seen in its place."""
_CALM = "stable for any rotor mass"
_HARDLY_DAMPED = "no mass is critical, the rotor is neutral"
_LEAST_LABEL = 0.25
"""Part of the axis of masses in which a label has space."""


def stability(ds: xr.Dataset) -> Figure:
    """Draw critical mass and whirl ratio over speed, a line for each load; natural modes of a point, or over speed.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``stability``: a point, a table over load and speed, or natural modes over speed.

    Returns
    -------
    matplotlib.figure.Figure
        Of a table: critical mass above, whirl ratio below; states in which no rotor mass is critical are marked at the
        upper edge, those with neutral rotors apart, or fill a map of speed and load where all are. Of a point: masses
        that are stable and those that whirl, and the natural modes of the rotor.

    Raises
    ------
    ConvergenceError
        No operating point was found.
    UsageError
        The dataset is of another verb.
    """
    if "critical_mass" not in ds:
        raise needs_result_of("stability", ds)
    if "point" in ds.dims:
        return campbell(ds)
    mass = array(ds, "critical_mass")
    if np.isnan(mass).all():
        raise unconverged(str(np.ravel(ds["status"].values)[-1]))
    if mass.size == 1:
        return _point(ds.squeeze())
    return _over_speed(ds) if np.isfinite(mass).any() else _calm_map(ds)


# ---------------------------------------------------------------------------------------------- over speed and load


def _over_speed(ds: xr.Dataset) -> Figure:
    order = np.argsort(array(ds, "speed"))
    rpm, loads = array(ds, "speed")[order] * RPM, array(ds, "load")
    masses, ratios = array(ds, "critical_mass")[:, order], array(ds, "whirl_ratio")[:, order]
    neutral = _is_neutral(ds)[:, order]
    fig = style.figure(8.0, 6.4)
    above, below = fig.subplots(2, 1, sharex=True, height_ratios=[1.5, 1.0])
    colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.85, len(loads)))
    for row, colour in enumerate(colours):
        look: style.Look = {"color": colour, "marker": "o", "markersize": 5, "linewidth": 1.8}
        label = f"load {loads[row]:.4g} N"
        above.plot(rpm, np.where(np.isfinite(masses[row]), masses[row], np.nan), label=label, **look)
        below.plot(rpm, ratios[row], **look)
        free, hardly = np.isinf(masses[row]), neutral[row]
        _mark_calm(above, rpm[free & ~hardly], colour, 0.97 - 0.05 * row)
        _mark_calm(above, rpm[free & hardly], colour, 0.97 - 0.05 * row, "d")
    for marker, shown, label in (("^", ~neutral, _CALM), ("d", neutral, _HARDLY_DAMPED)):
        if (np.isinf(masses) & shown).any():
            above.plot([], [], marker, color=style.GREY, markersize=8, label=label)
    style.dress(above, "", QUANTITIES["critical_mass"].axis)
    style.dress(below, QUANTITIES["speed"].axis, QUANTITIES["whirl_ratio"].axis)
    _set_masses(above, masses[np.isfinite(masses)])
    _set_ratios(below, ratios)
    fig.legend(
        *above.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=style.TICK, frameon=False
    )
    style.set_title(fig, ds, "a rotor heavier than the critical mass whirls")
    return fig


def _is_neutral(ds: xr.Dataset) -> NDArray[np.bool_]:
    """States whose verdict or status calls rotors neutral."""
    told = [ds[name].values.astype(str) for name in ("verdict", "status") if name in ds]
    neutral: NDArray[np.bool_] = np.any([np.char.find(words, NEUTRAL) >= 0 for words in told], axis=0)
    return neutral


def _mark_calm(ax: Axes, rpm: Floats, colour: Floats, height: float, marker: str = "^") -> None:
    if rpm.size:
        place: style.Look = {"transform": ax.get_xaxis_transform(), "clip_on": False, "markersize": 8, "gid": "calm"}
        ax.plot(rpm, np.full(rpm.size, height), marker, color=colour, **place)


def _set_masses(ax: Axes, finite: Floats) -> None:
    low, high = float(finite.min()), float(finite.max())
    if low > 0.0 and high > WIDE * low:
        ax.set_yscale("log")
        style.logarithmic(ax.yaxis)
        ax.set_ylim(low / 1.5, high * (high / low) ** 0.35)
    else:
        ax.set_ylim(0.0, 1.35 * high if high > 0.0 else 1.0)


def _set_ratios(ax: Axes, ratios: Floats) -> None:
    """Limits that contain all ratios, and half-speed whirl with them."""
    finite = ratios[np.isfinite(ratios)]
    low, high = float(finite.min(initial=0.0)), float(finite.max(initial=0.0))
    ax.set_ylim(1.1 * low, max(_USUAL_RATIO, 1.1 * high))


def _calm_map(ds: xr.Dataset) -> Figure:
    """Speeds and loads, where every rotor mass is stable."""
    mass = array(ds, "critical_mass")
    fig = style.figure(8.0, 4.6)
    ax = fig.subplots()
    rpm, load = np.meshgrid(array(ds, "speed") * RPM, array(ds, "load"))
    free, neutral = np.isinf(mass), _is_neutral(ds)
    calm, hardly = free & ~neutral, free & neutral
    if calm.any():
        ax.plot(rpm[calm], load[calm], "^", color=style.GREEN, markersize=9, label=_CALM, gid="calm")
    if hardly.any():
        ax.plot(rpm[hardly], load[hardly], "d", color=style.ORANGE, markersize=9, label=_HARDLY_DAMPED, gid="neutral")
    if not free.all():
        ax.plot(rpm[~free], load[~free], "x", color=style.GREY, markersize=8, label="did not converge")
    style.dress(ax, QUANTITIES["speed"].axis, QUANTITIES["load"].axis)
    ax.margins(0.08)
    ax.set_ylim(bottom=0.0)
    style.legend_below(ax, 2)
    style.set_title(fig, ds, _CALM if calm.all() else "")
    return fig


# ---------------------------------------------------------------------------------------------- one operating point


def _point(ds: xr.Dataset) -> Figure:
    with_modes = "natural_frequency" in ds and np.isfinite(array(ds, "natural_frequency")).any()
    fig = style.figure(9.0, 6.0 if with_modes else 2.6)
    axes = fig.subplots(2 if with_modes else 1, 1, height_ratios=[1.0, 2.4] if with_modes else [1.0], squeeze=False)[
        :, 0
    ]
    _draw_masses(axes[0], ds)
    if with_modes:
        _draw_modes(axes[1], ds)
    place = labels.load_fact(ds) or labels.displacement_fact(ds)
    threshold = number(ds, "threshold_speed") * RPM
    told = f"threshold speed {labels.grouped(threshold)} rpm" if math.isfinite(threshold) else ""
    style.set_title(fig, ds, labels.speed_fact(number(ds, "speed")), place, told)
    return fig


def _draw_masses(ax: Axes, ds: xr.Dataset) -> None:
    """Which rotor masses are stable, and which whirl; the rotor's own among them."""
    critical, rotor, ratio = (number(ds, name) for name in ("critical_mass", "rotor_mass", "whirl_ratio"))
    style.dress(ax, QUANTITIES["rotor_mass"].axis)
    ax.set_yticks([])
    left, right = _set_mass_axis(ax, [mass for mass in (critical, rotor) if math.isfinite(mass) and mass > 0.0])
    calm = min(max(critical, left), right)
    ax.axvspan(left, calm, color=style.GREEN, alpha=0.25, linewidth=0, gid="stable masses")
    ax.axvspan(calm, right, color=style.VERMILLION, alpha=0.25, linewidth=0, gid="whirling masses")
    ends, mark = _places(ax, (left, calm, right)), _places(ax, (rotor,))[0]
    middle: style.Look = {"transform": ax.transAxes, "ha": "center", "va": "center", "color": style.INK}
    if ends[1] > _LEAST_LABEL:
        free = _HARDLY_DAMPED if _is_neutral(ds).any() else _CALM
        text = free if math.isinf(critical) else f"stable below\n{critical:.4g} kg"
        ax.text(_free_middle(0.0, ends[1], mark), 0.5, text, fontsize=style.LABEL, **middle)
    if ends[1] < 1.0 - _LEAST_LABEL:
        whirl = "" if math.isnan(ratio) else f"\nwhirl ratio {ratio:.3g}"
        text = "whirls at any rotor mass" if critical == 0.0 else f"whirls above {critical:.4g} kg"
        ax.text(_free_middle(ends[1], 1.0, mark), 0.5, text + whirl, fontsize=style.LABEL, **middle)
    if math.isfinite(rotor):
        ax.axvline(rotor, color=style.INK, linewidth=1.6, gid="rotor")
        ax.text(mark, 1.03, f"rotor, {rotor:.4g} kg", fontsize=style.TICK, **(middle | {"va": "bottom"}))


def _set_mass_axis(ax: Axes, masses: list[float]) -> tuple[float, float]:
    """Limits that show the masses well apart from the ends; a logarithmic axis where they are far apart [kg]."""
    low, high = min(masses, default=1.0), max(masses, default=1.0)
    limits = (0.0, 1.6 * high)
    if high > WIDE * low:
        ax.set_xscale("log")
        style.logarithmic(ax.xaxis)
        beyond = (high / low) ** 0.4
        limits = (low / beyond, high * beyond)
    ax.set_xlim(limits)
    return limits


def _places(ax: Axes, masses: tuple[float, ...]) -> tuple[float, ...]:
    """Where masses are on the axis: 0 at its left end, 1 at its right end."""
    drawn = ax.get_xaxis_transform().transform([(mass, 0.0) for mass in masses])
    return tuple(float(place) for place in ax.transAxes.inverted().transform(drawn)[:, 0])


def _free_middle(low: float, high: float, mark: float) -> float:
    """Middle of the larger part of a range that a mark divides."""
    if not low < mark < high:
        return 0.5 * (low + high)
    return 0.5 * (low + mark) if mark - low >= high - mark else 0.5 * (mark + high)


def _draw_modes(ax: Axes, ds: xr.Dataset) -> None:
    """Growth rate over frequency of the natural modes; the upper half grows."""
    hertz, growth = array(ds, "natural_frequency") * HERTZ, array(ds, "mode_growth_rate")
    direction = array(ds, "whirl_direction") if "whirl_direction" in ds else np.zeros_like(hertz)
    kinds = {
        "forward whirl": (direction > 0.5, "o", style.BLUE),
        "backward whirl": (direction < -0.5, "s", style.ORANGE),
        "elliptical whirl": (np.abs(direction) <= 0.5, "D", style.PURPLE),
    }
    for label, (chosen, marker, colour) in kinds.items():
        if chosen.any():
            ax.plot(hertz[chosen], growth[chosen], marker, color=colour, markersize=7, label=label, zorder=3)
    low, high = min(float(np.nanmin(growth)), 0.0), max(float(np.nanmax(growth)), 0.0)
    spread = high - low or 1.0
    ax.set_ylim(low - 0.2 * spread, high + 0.2 * spread)
    ax.axhspan(0.0, high + 0.2 * spread, color=style.VERMILLION, alpha=0.1, linewidth=0)
    ax.axhline(0.0, color=style.GREY, linewidth=0.8)
    speed = number(ds, "speed") * HERTZ
    for order, line, name in ((1.0, "--", "speed"), (0.5, ":", "half the speed")):
        ax.axvline(
            order * speed, color=style.GREY, linewidth=1.0, linestyle=line, label=f"{name}, {order * speed:.4g} Hz"
        )
    style.dress(ax, "damped natural frequency [Hz]", "growth rate [1/s]")
    ax.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)
    _set_frequencies(ax, hertz[np.isfinite(hertz)], speed)
    place: style.Look = {"transform": ax.transAxes, "ha": "right", "fontsize": style.TICK, "color": style.GREY}
    ax.text(0.99, 0.97, "unstable", va="top", **place)
    ax.text(0.99, 0.03, "stable", va="bottom", **place)
    style.legend_below(ax, 3)


def _set_frequencies(ax: Axes, hertz: Floats, speed: float) -> None:
    """Limits that show modes and speed; a logarithmic axis where they are far apart."""
    low, high = min(float(hertz.min()), 0.5 * speed), max(float(hertz.max()), speed, 1e-9)
    if low > 0.0 and high > 2.0 * WIDE * low:
        ax.set_xscale("log")
        style.logarithmic(ax.xaxis)
        ax.set_xlim(low / 1.5, high * 1.5)
    else:
        ax.set_xlim(0.0, 1.1 * high)
