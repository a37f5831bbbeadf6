"""How far a small change of each parameter moves a result (`tornado`)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import labels, style
from petalfoil.plot.labels import QUANTITIES
from petalfoil.plot.views import Floats, array, number, unconverged
from petalfoil.text import for_figure

MOST_BARS = 20
"""Parameters of one panel: those of the largest effects."""

FARTHEST = 5.0
"""A bar longer than this, over the largest of the others, is cut there: its number tells how long it is."""

BAR = 0.3
"""Height of a bar with its share of the panel [in]."""


def tornado(ds: xr.Dataset) -> Figure:
    """Draw the effects of a small change of each parameter as bars, the largest on top.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``sensitivity``.

    Returns
    -------
    matplotlib.figure.Figure
        A panel for each result. A bar to the right says that the result grows; full bars are for the change stated
        beside the parameter, pale ones for the opposite change.

    Raises
    ------
    ConvergenceError
        No parameter has a derivative.
    """
    shown = ds.isel(point=np.flatnonzero(ds["converged"].values & np.isfinite(array(ds, "effect"))))
    if not shown.sizes["point"]:
        raise unconverged(str(ds["status"].values[-1]))
    places = shown["place"].values if "place" in shown else np.full(shown.sizes["point"], "")
    of_bars = list(zip(shown["quantity"].values.astype(str), places.astype(str), strict=True))
    names = list(dict.fromkeys(of_bars))
    numbers = [[number for number, bar in enumerate(of_bars) if bar == name][:MOST_BARS] for name in names]
    panels = [shown.isel(point=one) for one in numbers]
    heights = [panel.sizes["point"] for panel in panels]
    fig = style.figure(8.5, BAR * sum(heights) + 0.75 * len(names) + 0.8)
    axes = fig.subplots(len(names), 1, squeeze=False, gridspec_kw={"height_ratios": heights}).ravel()
    for ax, name, panel in zip(axes, names, panels, strict=True):
        _draw(ax, name, panel)
    style.legend_below(axes[0], 2)
    style.set_title(fig, ds, "effect of small changes of the parameters", *_state(shown.isel(point=0)))
    return fig


def _state(ds: xr.Dataset) -> tuple[str, ...]:
    """Speed, load or displacement of the equilibrium."""
    varies = "place" in ds  # told beside each panel
    speed = labels.speed_fact(number(ds, "speed")) if "speed" in ds and not (varies and "load_x" in ds) else ""
    if "load_x" in ds:
        return speed, labels.load_fact(ds)
    return speed, "" if varies else labels.displacement_fact(ds)


def _draw(ax: Axes, of: tuple[str, str], ds: xr.Dataset) -> None:
    name, place_text = of
    effect, opposite, unit = _effects(ds)
    place, sizes = -np.arange(len(effect)), np.maximum(np.abs(effect), np.abs(opposite))
    reach = _reach(sizes)
    drawn = np.clip(opposite, -reach, reach), np.clip(effect, -reach, reach)
    ax.barh(place, drawn[0], height=0.62, color=style.SKY, alpha=0.45, label="opposite change", gid="opposite")
    ax.barh(place, drawn[1], height=0.62, color=style.BLUE, label="change as stated", gid="effect")
    for y, value, size in zip(place, effect, sizes, strict=True):
        text = f"{value:+.3g}".replace("-", "−") + (" (bar cut)" if size > reach else "")
        end, side = (float(np.clip(value, -reach, reach)), y), 1.0 if value >= 0.0 else -1.0
        look: style.Look = {"ha": "left" if side > 0.0 else "right", "va": "center", "fontsize": style.TICK}
        ax.annotate(text, end, (4.0 * side, 0.0), textcoords="offset points", **look)
    changes = zip(ds["parameter"].values, ds["parameter_text"].values, ds["change_text"].values, strict=True)
    ax.set_yticks(place, [for_figure(f"{path} = {value}, {_signed(change)}") for path, value, change in changes])
    ax.axvline(0.0, color=style.GREY, linewidth=0.8)
    label = QUANTITIES[name].name if name in QUANTITIES else for_figure(name.replace("_", " "))
    at = f" at {for_figure(place_text)}" if place_text else ""
    style.dress(ax, f"change of the {label}{at} [{unit}]")
    ax.grid(False, axis="y")
    cut = bool(np.any(sizes > reach))
    beyond = (1.55 if cut else 1.3) * reach
    ax.set_xlim(-beyond, beyond)


def _reach(sizes: Floats) -> float:
    """Length of the longest bar that is drawn: one that is much longer than the others would hide them."""
    longest, *others = np.sort(sizes)[::-1]
    if others and others[0] > 0.0:
        return float(min(longest, FARTHEST * others[0]))
    return float(longest) or 1.0  # nothing has an effect


def _effects(ds: xr.Dataset) -> tuple[Floats, Floats, str]:
    """Changes of a result by the stated and by the opposite changes, and their unit: % where the result has a value."""
    value, change = array(ds, "quantity_value"), array(ds, "parameter_change")
    effect = array(ds, "effect")
    other = np.where(change > 0.0, array(ds, "derivative_below"), array(ds, "derivative_above"))
    opposite = np.nan_to_num(-other * change)
    if np.all(value == 0.0):
        return effect, opposite, for_figure(str(ds["quantity_unit"].values[0]))
    return 100.0 * effect / np.abs(value), 100.0 * opposite / np.abs(value), "%"


def _signed(change: str) -> str:
    return change if change.startswith("+") else f"+{change}"
