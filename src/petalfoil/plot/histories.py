"""A motion over time: displacement, film, contact and speed; and the audit of its energy."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.motion import MICRO, RPM, elapsed, motion_facts, padded, path_of
from petalfoil.plot.reading import Floats, array, number
from petalfoil.results.motion import Path

Drawn = tuple[Floats, str]


def orbit_histories(ds: xr.Dataset) -> Figure:
    """Draw displacement, smallest film, contact share and, where it changes, speed over time.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Panels one above the other, over turns of the shaft or, where the speed changes, milliseconds.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(9.0, 7.6 if path.is_steady else 9.0)
    panels = [draw_displacement, draw_film_history, draw_contact] + ([] if path.is_steady else [draw_speed])
    axes = np.atleast_1d(fig.subplots(len(panels), 1, sharex=True, height_ratios=[1.6, *[1.0] * (len(panels) - 1)]))
    for ax, draw in zip(axes, panels, strict=True):
        draw(ax, ds, path)
        if ax is not axes[-1]:
            ax.set_xlabel("")
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def draw_displacement(ax: Axes, _ds: xr.Dataset, path: Path) -> None:
    """Draw both displacements."""
    for values, colour, label in ((path.x, style.BLUE, "x"), (path.y, style.VERMILLION, "y")):
        _draw(ax, path, values * MICRO, colour, label)
    _frame(ax, path, "displacement [µm]")
    low, high = padded(*_range([path.x * MICRO, path.y * MICRO]))
    ax.set_ylim(low, high + 0.15 * (high - low))  # room for the legend
    style.legend(ax, loc="upper right", ncols=2)


def draw_film_history(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the smallest film and its floor."""
    film = array(ds, "min_film_thickness") * MICRO
    _draw(ax, path, film, style.GREEN, "")
    floor = number(ds, "contact_film_thickness") * MICRO
    if not math.isnan(floor):
        ax.axhline(floor, color=style.GREY, linewidth=1.0, linestyle="--", label=f"film floor, {floor:.3g} µm")
    _frame(ax, path, "smallest film [µm]")
    ax.set_ylim(0.0, 1.25 * float(film.max()))
    style.legend(ax, loc="upper right")


def draw_contact(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the share of the contacts."""
    share = 100.0 * array(ds, "contact_fraction")
    over, _ = elapsed(path)
    ax.fill_between(over, 0.0, share, color=style.ORANGE, alpha=0.35, linewidth=0)
    _draw(ax, path, share, style.ORANGE, "")
    _frame(ax, path, "contact share [%]")
    ax.set_ylim(0.0, max(1.1 * float(share.max()), 1.0))
    if not share.any():
        ax.text(0.5, 0.5, "no contact", transform=ax.transAxes, ha="center", color=style.GREY, fontsize=style.LABEL)


def draw_speed(ax: Axes, _ds: xr.Dataset, path: Path) -> None:
    """Draw the speed of the shaft."""
    _draw(ax, path, path.speed * RPM, style.INK, "")
    _frame(ax, path, "speed [rpm]")
    ax.set_ylim(0.0, max(1.1 * float(path.speed.max()) * RPM, 1.0))


def orbit_energy(ds: xr.Dataset) -> Figure:
    """Draw the audit of the energy: what loads and film did on rotor and petals, and what the shaft spent.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Above, work of loads and film, the energy gained from it, and the defect; below, work of the shaft.

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
    """Draw work on rotor and petals, their energy, and what is missing."""
    columns = list(_exchanged(ds))
    scale, unit = _unit(max(float(np.abs(values).max()) for values, *_ in columns))
    for values, colour, label, line in columns:
        _draw(ax, path, values * scale, colour, label, line)
    _frame(ax, path, f"work and energy [{unit}]")
    ax.set_ylim(*padded(*_range([values * scale for values, *_ in columns]), share=0.3))
    ax.axhline(0.0, color=style.GREY, linewidth=0.6, zorder=0)
    style.legend(ax, loc="upper left", ncols=2)
    ax.text(0.99, 0.03, _spent(ds), transform=ax.transAxes, ha="right", fontsize=style.TICK, color=style.INK)


def draw_shaft(ax: Axes, ds: xr.Dataset, path: Path) -> None:
    """Draw the work of the shaft against film and dry friction."""
    whole, rubbing = array(ds, "shaft_work"), array(ds, "rubbing_work")
    scale, unit = _unit(float(np.abs(whole).max()))
    _draw(ax, path, whole * scale, style.INK, "shaft, film and rubbing")
    _draw(ax, path, rubbing * scale, style.ORANGE, "rubbing alone")
    _frame(ax, path, f"work of the shaft [{unit}]")
    ax.set_ylim(*padded(*_range([whole * scale, rubbing * scale]), share=0.15))
    style.legend(ax, loc="upper left")


def _spent(ds: xr.Dataset) -> str:
    """What the shaft spent on friction, which the audit leaves out, and the defect of what it holds."""
    whole, rubbing = float(array(ds, "shaft_work")[-1]), float(array(ds, "rubbing_work")[-1])
    scale, unit = _unit(abs(whole))
    told = f"the shaft spent {scale * whole:.3g} {unit} on friction, {scale * rubbing:.3g} {unit} of it on rubbing"
    defect = number(ds, "energy_balance_error")
    return told if math.isnan(defect) else f"{told}\nlargest defect: {defect:.1e} of what was exchanged"


def _exchanged(ds: xr.Dataset) -> Iterator[tuple[Floats, str, str, str]]:
    """Values [J], colour, label and line of what the audit balances."""
    loads, film = array(ds, "load_work"), array(ds, "film_work")
    energy = array(ds, "kinetic_energy") + array(ds, "elastic_energy")
    gained = energy - energy[0]
    yield loads, style.BLUE, "work of the loads", "-"
    yield film, style.GREEN, "work of the film", "-"
    yield gained, style.INK, "gained by rotor and petals", "-"
    lost = array(ds, "petal_friction_work") if "petal_friction_work" in ds else np.zeros_like(gained)
    if np.any(lost):
        yield lost, style.ORANGE, "lost between petals", "-"
    yield gained + lost - loads - film, style.VERMILLION, "defect", "--"


def _range(columns: list[Floats]) -> tuple[float, float]:
    return min(float(values.min()) for values in columns), max(float(values.max()) for values in columns)


def _unit(largest: float) -> tuple[float, str]:
    """Factor and unit in which an energy is readable."""
    for scale, unit in ((1.0, "J"), (1e3, "mJ"), (1e6, "µJ")):
        if largest * scale >= 1.0:
            return scale, unit
    return 1e6, "µJ"


def _draw(ax: Axes, path: Path, values: Floats, colour: str, label: str, line: str = "-") -> None:
    over, _ = elapsed(path)
    look: style.Look = {"label": label} if label else {}
    ax.plot(over, values, color=colour, linewidth=1.1, linestyle=line, **look)


def _frame(ax: Axes, path: Path, ylabel: str) -> None:
    over, label = elapsed(path)
    style.dress(ax, label, ylabel)
    ax.set_xlim(float(over[0]), float(over[-1]))
