"""Spectrum of the whirl at one speed, and over a speed that changes, with synchronous and half-speed whirl marked."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.labels import MICRO, RPM
from petalfoil.plot.orbit_views import elapsed, motion_facts, path_of
from petalfoil.plot.views import Floats
from petalfoil.results.motion import LEAST_TURNS, TURN, Path, Waterfall, spectrum, waterfall

ORDERS = {1.0: "1×", 0.5: "½×"}
"""Whirl ratios that are marked: synchronous whirl, and half-speed whirl."""
WIDEST = 2.2
"""Largest frequency that is drawn, over the highest speed."""
DECADES = 1e-4
"""Amplitudes below this share of the largest are not drawn in a spectrum."""
SHADES = 1e-3
"""The same in a waterfall."""
COLUMNS = 700
"""Frequencies that a waterfall shows at most."""
FAINTEST = 0.02
"""A waterfall ends at the largest frequency whose amplitude is more than this over the largest one."""
DRIFT = 2.0
"""Frequencies that a piece cannot tell from a drift, over its resolution: half the width of a line under Hann's window,
whose nulls are no nulls of the motion."""
COVERED = 0.45
"""They are covered up to this over the highest speed: half-speed whirl stays in sight of few revolutions."""


def orbit_spectrum(ds: xr.Dataset) -> Figure:
    """Draw the full spectrum of the whirl: at one speed of its last revolutions, else as a waterfall over the speed.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Amplitude of forward whirl at positive frequencies, of backward whirl at negative ones.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(9.0, 5.2 if path.is_steady else 6.4)
    draw_frequencies(fig.subplots(), path)
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def orbit_waterfall(ds: xr.Dataset) -> Figure:
    """Draw spectra of short pieces of the motion, over the speed or, where that is not passed once, over time.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Amplitude as colour over frequency, with the lines of synchronous and half-speed whirl.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(9.0, 6.4)
    ax = fig.subplots()
    if _is_long_enough(ax, path):
        draw_waterfall(ax, path)
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig


def draw_frequencies(ax: Axes, path: Path) -> None:
    """Draw what suits the motion: a spectrum at one speed, else a waterfall; a note where it is too short for them."""
    if _is_long_enough(ax, path):
        if path.is_steady:
            draw_spectrum(ax, path)
        else:
            draw_waterfall(ax, path)


def _is_long_enough(ax: Axes, path: Path) -> bool:
    """Whether there are revolutions enough for a spectrum; if not, the panel says so."""
    if path.turns >= LEAST_TURNS:
        return True
    ax.set_axis_off()
    note = f"no spectrum from {path.turns:.3g} revolutions:\nit needs {LEAST_TURNS:g}"
    ax.text(0.5, 0.5, note, transform=ax.transAxes, ha="center", va="center", fontsize=style.LABEL, color=style.GREY)
    return False


def draw_spectrum(ax: Axes, path: Path) -> None:
    """Draw the full spectrum of the last revolutions."""
    found, speed = spectrum(path), float(path.speed[-1])
    drawn = np.abs(found.frequency) <= WIDEST * speed
    hertz, height = found.frequency[drawn] / TURN, np.maximum(found.amplitude[drawn] * MICRO, 1e-9)
    top = float(height.max())
    ax.fill_between(hertz, DECADES * top, height, color=style.BLUE, alpha=0.18, linewidth=0)
    ax.plot(hertz, height, color=style.BLUE, linewidth=1.2, gid="spectrum")
    ax.set_yscale("log")
    ax.set_ylim(DECADES * top, 6.0 * top)
    ax.set_xlim(float(hertz[0]), float(hertz[-1]))
    for order, label in ORDERS.items():
        for sign in (1.0, -1.0):
            place = sign * order * speed / TURN
            ax.axvline(place, color=style.VERMILLION, linewidth=0.9, linestyle="--" if order == 1.0 else ":", zorder=1)
            text = label if sign > 0.0 else f"−{label}"
            ax.text(
                place, 2.2 * top, text, ha="center", fontsize=style.TICK, color=style.VERMILLION, backgroundcolor="w"
            )
    style.dress(ax, _frequency_label(), "amplitude [µm]")


def draw_waterfall(ax: Axes, path: Path) -> None:
    """Draw spectra of short pieces over speed or time."""
    found = waterfall(path)
    over, label, speeds = _heights(path, found)
    hertz, amplitude = _columns(found, _widest(found, float(path.speed.max())))
    top = float(amplitude.max()) * MICRO
    norm = LogNorm(SHADES * top, top)
    look: style.Look = {"cmap": style.PRESSURE_MAP, "norm": norm, "shading": "nearest", "rasterized": True}
    mesh = ax.pcolormesh(hertz, over, np.maximum(amplitude * MICRO, 1e-12), **look)
    for order, name in ORDERS.items():
        for sign in (1.0, -1.0):
            line: style.Look = {"color": style.WHITE, "linewidth": 1.0, "linestyle": "--" if order == 1.0 else ":"}
            ax.plot(sign * order * speeds / TURN, over, **line)
            text = name if sign > 0.0 else f"−{name}"
            place = (sign * order * float(speeds[-1]) / TURN, float(over[-1]))
            ax.annotate(text, place, (0, 4), textcoords="offset points", ha="center", fontsize=style.TICK)
    told_apart = min(DRIFT * found.resolution, COVERED * float(path.speed.max()))
    _mask_drift(ax, told_apart / TURN, 1e3 * TURN / found.resolution)
    style.dress(ax, _frequency_label(), label)
    ax.grid(False)
    ax.set_xlim(float(hertz[0]), float(hertz[-1]))
    ax.set_ylim(float(over[0]), float(over[-1]))
    bar = ax.figure.colorbar(mesh, ax=ax, pad=0.02, aspect=30)
    bar.set_label("amplitude [µm]", fontsize=style.LABEL)


def _widest(found: Waterfall, speed: float) -> float:
    """Largest frequency with an amplitude worth showing, but at least that of the highest speed [rad/s]."""
    shown = found.amplitude.max(axis=0) > FAINTEST * found.amplitude.max()
    return min(1.05 * max(speed, float(np.abs(found.frequency[shown]).max())), WIDEST * speed)


def _mask_drift(ax: Axes, hertz: float, piece: float) -> None:
    """Cover the frequencies [Hz] that pieces [ms] are too short for, and say so."""
    ax.axvspan(-hertz, hertz, facecolor=style.PALE, alpha=0.85, linewidth=0, gid="drift")
    text = f"below {hertz:.0f} Hz: drift and slow whirl,\nnot told apart by pieces of {piece:.2g} ms"
    look: style.Look = {"transform": ax.get_xaxis_transform(), "rotation": 90, "ha": "center", "va": "center"}
    ax.text(0.0, 0.5, text, fontsize=style.TICK, color=style.INK, **look)


def _heights(path: Path, found: Waterfall) -> tuple[Floats, str, Floats]:
    """What the pieces are drawn over, its label, and their speeds; in the order of growing heights."""
    way = np.diff(found.speed)
    if np.all(way > 0.0) or np.all(way < 0.0):
        order = np.argsort(found.speed)
        return found.speed[order] * RPM, "speed [rpm]", found.speed[order]
    over, label = elapsed(path)
    return np.interp(found.time, path.time, over), label, found.speed


def _columns(found: Waterfall, widest: float) -> tuple[Floats, Floats]:
    """Frequencies [Hz] and amplitudes as far as they are drawn, neighbours merged into the largest of them."""
    drawn = np.abs(found.frequency) <= widest
    hertz, amplitude = found.frequency[drawn] / TURN, found.amplitude[:, drawn]
    if np.all(np.diff(found.speed) < 0.0):
        amplitude = amplitude[::-1]
    merge = max(len(hertz) // COLUMNS, 1)
    kept = len(hertz) // merge * merge
    columns: Floats = amplitude[:, :kept].reshape(len(amplitude), -1, merge).max(axis=2)
    middles: Floats = hertz[:kept].reshape(-1, merge).mean(axis=1)
    return middles, columns


def _frequency_label() -> str:
    return "whirl frequency [Hz], backward < 0 < forward"
