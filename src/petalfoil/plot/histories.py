"""A motion over time: displacement, tilt, film, contact and speed; and the balance of its energy."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.labels import MICRO, RPM
from petalfoil.plot.orbit_views import elapsed, motion_facts, padded, path_of
from petalfoil.plot.views import Floats, array, number
from petalfoil.results.motion import Path


def orbit_histories(ds: xr.Dataset) -> Figure:
    """Draw displacement, minimum film thickness, contact fraction, and tilt and speed where they change, over time.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Panels one above the other, over revolutions of the shaft or, where the speed changes, milliseconds.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    panels = [draw_x, draw_y, draw_film_history, draw_contact]
    panels += [draw_tilt] if tilts(ds) else []
    panels += [] if path.is_steady else [draw_speed]
    fig = style.figure(9.0, 0.9 + 1.75 * len(panels))
    axes = fig.subplots(len(panels), 1, sharex=True)
    for ax, draw in zip(axes, panels, strict=True):
        draw(ax, ds, path)
        if ax is not axes[-1]:
            ax.set_xlabel("")
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def draw_x(ax: Axes, _ds: xr.Dataset, path: Path) -> None:
    """Draw the displacement along x on a scale of its own: an orbit is small against the distance of its middle."""
    _draw_displacement(ax, path, path.x, style.BLUE, "x")


def draw_y(ax: Axes, _ds: xr.Dataset, path: Path) -> None:
    """Draw the displacement along y on a scale of its own."""
    _draw_displacement(ax, path, path.y, style.VERMILLION, "y")


def _draw_displacement(ax: Axes, path: Path, values: Floats, colour: str, axis: str) -> None:
    _draw_line(ax, path, values * MICRO, colour, "")
    _dress(ax, path, f"displacement\nalong {axis} [µm]")
    ax.set_ylim(*padded(*_range([values * MICRO])))


def tilts(ds: xr.Dataset) -> bool:
    """Whether the shaft of a motion tilts."""
    return "slope_x" in ds and bool(np.any(array(ds, "slope_x")) or np.any(array(ds, "slope_y")))


def draw_tilt(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw both slopes of the shaft's axis."""
    slopes = {"along x": (array(ds, "slope_x"), style.BLUE), "along y": (array(ds, "slope_y"), style.VERMILLION)}
    for label, (values, colour) in slopes.items():
        _draw_line(ax, path, values * MICRO, colour, label)
    _dress(ax, path, "shaft slope\n[µrad]")
    low, high = padded(*_range([values * MICRO for values, _ in slopes.values()]))
    ax.set_ylim(low, high + 0.4 * (high - low))  # space for the legend
    style.legend(ax, loc="upper right", ncols=2)


def draw_film_history(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the minimum film thickness and the contact film thickness."""
    film = array(ds, "min_film_thickness") * MICRO
    _draw_line(ax, path, film, style.GREEN, "")
    least = number(ds, "contact_film_thickness") * MICRO
    if not math.isnan(least):
        label = f"contact film thickness, {least:.3g} µm"
        ax.axhline(least, color=style.GREY, linewidth=1.0, linestyle="--", label=label)
    _dress(ax, path, "minimum film\nthickness [µm]")
    ax.set_ylim(0.0, 1.4 * float(film.max()))
    style.legend(ax, loc="upper right")


def draw_contact(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the contact fraction."""
    percent = 100.0 * array(ds, "contact_fraction")
    over, _ = elapsed(path)
    ax.fill_between(over, 0.0, percent, color=style.ORANGE, alpha=0.35, linewidth=0)
    _draw_line(ax, path, percent, style.ORANGE, "")
    _dress(ax, path, "contact\nfraction [%]")
    ax.set_ylim(0.0, max(1.1 * float(percent.max()), 1.0))
    if not percent.any():
        ax.text(0.5, 0.5, "no contact", transform=ax.transAxes, ha="center", color=style.GREY, fontsize=style.LABEL)


def draw_speed(ax: Axes, _ds: xr.Dataset, path: Path) -> None:
    """Draw the speed of the shaft."""
    _draw_line(ax, path, path.speed * RPM, style.INK, "")
    _dress(ax, path, "speed [rpm]")
    ax.set_ylim(0.0, max(1.1 * float(path.speed.max()) * RPM, 1.0))


def orbit_energy(ds: xr.Dataset) -> Figure:
    """Draw the energy balance: work of loads and film on rotor and petals, and work of the shaft against friction.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Above, work of loads and film, the energy gained from it, and the balance error; below, work of the shaft.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(9.0, 7.0)
    above, below = fig.subplots(2, 1, sharex=True, height_ratios=[1.6, 1.0])
    draw_energy(above, ds, path)
    draw_shaft(below, ds, path)
    above.set_xlabel("")
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def draw_energy(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw work on rotor and petals, their energy, and the balance error."""
    columns = list(_exchanged(ds))
    scale, unit = _unit(max(float(np.abs(values).max()) for values, *_ in columns))
    for values, colour, label, line in columns:
        _draw_line(ax, path, values * scale, colour, label, line)
    _dress(ax, path, f"work and energy [{unit}]")
    ax.set_ylim(*padded(*_range([values * scale for values, *_ in columns]), share=0.3))
    ax.axhline(0.0, color=style.GREY, linewidth=0.6, zorder=0)
    style.legend(ax, loc="upper left", ncols=2)
    ax.text(0.99, 0.03, _spent(ds), transform=ax.transAxes, ha="right", fontsize=style.TICK, color=style.INK)


def draw_shaft(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the work of the shaft against film and dry friction."""
    whole, rubbing = array(ds, "shaft_work"), array(ds, "rubbing_work")
    scale, unit = _unit(float(np.abs(whole).max()))
    _draw_line(ax, path, whole * scale, style.INK, "film and rubbing")
    _draw_line(ax, path, rubbing * scale, style.ORANGE, "rubbing")
    _dress(ax, path, f"work of the shaft [{unit}]")
    ax.set_ylim(*padded(*_range([whole * scale, rubbing * scale]), share=0.15))
    style.legend(ax, loc="upper left")


def _spent(ds: xr.Dataset) -> str:
    """Work of the shaft against friction, which the balance leaves out, and the error of the balance."""
    whole, rubbing = float(array(ds, "shaft_work")[-1]), float(array(ds, "rubbing_work")[-1])
    scale, unit = _unit(abs(whole))
    told = f"work of the shaft {scale * whole:.3g} {unit}, {scale * rubbing:.3g} {unit} of it against rubbing"
    error = number(ds, "energy_balance_error")
    return told if math.isnan(error) else f"{told}\nenergy-balance error {error:.1e}"


def _exchanged(ds: xr.Dataset) -> Iterator[tuple[Floats, str, str, str]]:
    """Values [J], colour, label and line of the terms of the balance."""
    loads, film = array(ds, "load_work"), array(ds, "film_work")
    energy = array(ds, "kinetic_energy") + array(ds, "elastic_energy")
    gained = energy - energy[0]
    yield loads, style.BLUE, "work of the loads", "-"
    yield film, style.GREEN, "work of the film", "-"
    yield gained, style.INK, "gained by rotor and petals", "-"
    lost = array(ds, "petal_friction_work") if "petal_friction_work" in ds else np.zeros_like(gained)
    if np.any(lost):
        yield lost, style.ORANGE, "friction between petals", "-"
    yield gained + lost - loads - film, style.VERMILLION, "balance error", "--"


def _range(columns: list[Floats]) -> tuple[float, float]:
    return min(float(values.min()) for values in columns), max(float(values.max()) for values in columns)


def _unit(largest: float) -> tuple[float, str]:
    """Factor and unit in which an energy is readable."""
    for scale, unit in ((1.0, "J"), (1e3, "mJ"), (1e6, "µJ")):
        if largest * scale >= 1.0:
            return scale, unit
    return 1e6, "µJ"


def _draw_line(ax: Axes, path: Path, values: Floats, colour: str, label: str, line: str = "-") -> None:
    over, _ = elapsed(path)
    look: style.Look = {"label": label} if label else {}
    ax.plot(over, values, color=colour, linewidth=1.1, linestyle=line, **look)


def _dress(ax: Axes, path: Path, ylabel: str) -> None:
    over, label = elapsed(path)
    style.dress(ax, label, ylabel)
    ax.set_xlim(float(over[0]), float(over[-1]))
