"""The foil pack as it is assembled: its section, and one petal unrolled with its free shape."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil.plot import labels, style
from petalfoil.plot.labels import MICRO
from petalfoil.plot.section import default_scale, frame_section
from petalfoil.plot.section_walls import draw_backing, draw_free_foil, draw_petals, draw_solids, foil_room
from petalfoil.plot.stretch import Stretch
from petalfoil.plot.views import Floats, array, journal_surface, mid_plane, number, one_point

_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 361)
_MARGIN = 0.12
"""Angle shown beyond each end of the unrolled petal over the petal's angle."""
_MILLI = 1e3


def pack(ds: xr.Dataset) -> Figure:
    """Draw the foil pack of ``check``: the section with its clearance stretched, and one petal unrolled.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``check``, with the free and the assembled shape.

    Returns
    -------
    matplotlib.figure.Figure
        Section on the left, unrolled petal on the right.

    Raises
    ------
    ConvergenceError
        The assembled shape did not converge.
    """
    ds = mid_plane(one_point(ds))
    fig = style.figure(12.0, 6.2)
    left, right = fig.subplots(1, 2, width_ratios=[1.0, 1.05])
    _draw_section(left, ds)
    _draw_unrolled(right, ds)
    style.set_title(fig, ds, *_facts(ds))
    _state_stretch(fig, right, ds)
    return fig


def _state_stretch(fig: Figure, ax: Axes, ds: xr.Dataset) -> None:
    """Head the unrolled petal with how many times its radius is stretched against its arc."""
    ax.set_title("unrolled", fontsize=style.LABEL, color=style.INK)
    fig.draw_without_rendering()  # the layout decides the size of the axes
    box = ax.get_window_extent()
    arc = math.radians(np.ptp(ax.get_xlim())) * number(ds, "bushing_radius") * _MILLI
    stretch = (box.height / np.ptp(ax.get_ylim())) / (box.width / arc)
    told = f"{stretch:.2g}" if stretch < 100.0 else labels.grouped(float(f"{stretch:.2g}"))
    ax.set_title(f"unrolled, radius stretched ×{told}", fontsize=style.LABEL, color=style.INK)


def _facts(ds: xr.Dataset) -> list[str]:
    formats = {
        "overlap": "overlap {:.3g}",
        "layers": "{:.0f} layers",
        "radial_clearance": "radial clearance {:.4g} µm",
        "pack_clearance": "{:.4g} µm above the solid pack height",
        "compressibility_number": "Λ on radial clearance = {:.3g}",
    }
    if "radius" not in ds:
        del formats["pack_clearance"]
    lengths = ("radial_clearance", "pack_clearance")
    known = {name: number(ds, name) * (MICRO if name in lengths else 1.0) for name in formats}
    return [form.format(known[name]) for name, form in formats.items() if not math.isnan(known[name])]


def _draw_section(ax: Axes, ds: xr.Dataset) -> None:
    """The section with its radial clearance stretched; the first petal stands out as in the unrolled picture."""
    scale = default_scale(ds)
    stretch = Stretch(number(ds, "bushing_radius"), scale, foil_room(ds, scale))
    draw_solids(ax, ds, stretch)
    draw_free_foil(ax, ds, stretch)
    draw_backing(ax, ds, stretch)
    draw_petals(ax, ds, stretch)
    for patch in ax.patches:
        if patch.get_gid() == "petal 0":
            patch.set(facecolor=style.BLUE, zorder=3)
    surface = stretch.points(journal_surface(ds, _CIRCLE), _CIRCLE)
    ax.plot(*surface.T, color=style.INK, linewidth=1.0, gid="journal surface")
    ax.text(0.0, 0.0, "journal", ha="center", va="center", fontsize=style.TICK, color=style.INK)
    frame_section(ax, stretch)


def _draw_unrolled(ax: Axes, ds: xr.Dataset) -> None:
    """Radius against bushing angle over one petal, with everything that passes there; the legend stands below."""
    span = float(array(ds, "phi")[-1]) if "phi" in ds.coords else 2.0 * math.pi
    root = float(array(ds, "root_angle")[0]) if "root_angle" in ds.coords else 0.0
    margin = _MARGIN if "radius" in ds else 0.0
    window = np.linspace(root - margin * span, root + (1.0 + margin) * span, 361)
    bore, journal = number(ds, "bushing_radius") * _MILLI, journal_surface(ds, window) * _MILLI
    low = float(journal.min())
    if "radius" in ds:
        _draw_neighbours(ax, ds, window)
        low = min(low, _draw_free(ax, ds, root))
    _draw_walls(ax, np.degrees(window), journal, (low, bore))
    style.dress(ax, "bushing angle  θ [deg]", "radius [mm]")
    ax.set_xlim(math.degrees(window[0]), math.degrees(window[-1]))
    if ax.get_legend_handles_labels()[0]:
        style.legend(ax, loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=3, frameon=False)


def _draw_walls(ax: Axes, degrees: Floats, journal: Floats, limits: tuple[float, float]) -> None:
    """Journal below and bushing above, each with its name."""
    low, bore = limits
    depth = 0.12 * (bore - low)
    look: style.Look = {"facecolor": style.PALE, "edgecolor": style.GREY, "hatch": "////", "linewidth": 0}
    ax.fill_between(degrees, bore, bore + depth, gid="bushing", **look)
    ax.fill_between(degrees, low - depth, journal, facecolor=style.STEEL, linewidth=0, zorder=0, gid="journal")
    ax.plot(degrees, journal, color=style.INK, linewidth=1.0)
    ax.axhline(bore, color=style.INK, linewidth=1.0)
    place: style.Look = {"fontsize": style.TICK, "color": style.INK, "va": "center"}
    box = {"facecolor": style.WHITE, "edgecolor": "none", "pad": 1.5}
    ax.text(degrees[6], low - depth / 2, "journal", **place)
    ax.text(degrees[6], bore + depth / 2, "bushing", bbox=box, **place)
    ax.set_ylim(low - depth, bore + depth)


def _draw_neighbours(ax: Axes, ds: xr.Dataset, window: Floats) -> None:
    """The petals with their thickness; the first one stands out."""
    half, phi, radius = number(ds, "petal_thickness") / 2, array(ds, "phi"), array(ds, "radius")
    roots = array(ds, "root_angle")
    for petal, root in enumerate(roots):
        for turn in (-2.0 * math.pi, 0.0, 2.0 * math.pi):
            theta = root + turn + phi
            if theta[-1] < window[0] or theta[0] > window[-1]:
                continue
            first = petal == 0 and turn == 0.0
            look: style.Look = {
                "facecolor": style.BLUE if first else style.PETALS[petal % 2],
                "edgecolor": style.INK,
                "linewidth": 0.5,
            }
            label = "petal, assembled" if first else None
            faces = ((radius[petal] - half) * _MILLI, (radius[petal] + half) * _MILLI)
            ax.fill_between(np.degrees(theta), *faces, label=label, zorder=2 + first, gid=f"petal {petal}", **look)


def _draw_free(ax: Axes, ds: xr.Dataset, root: float) -> float:
    """The free mid-surface of the first petal and where it would meet the journal; returns its lowest radius [mm]."""
    if "free_radius" not in ds:
        return math.inf
    phi, free = array(ds, "phi"), array(ds, "free_radius") * _MILLI
    ax.plot(np.degrees(root + phi), free, "--", color=style.VERMILLION, linewidth=1.6, label="petal, free", zorder=4)
    meets = number(ds, "first_contact_angle")
    if not math.isnan(meets):
        place = (math.degrees(root + meets), float(np.interp(meets, phi, free)))
        ax.plot(*place, "o", color=style.VERMILLION, markersize=6, label="free petal meets the journal", zorder=5)
    return float(free.min())
