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
_DEPTH = 0.12
"""Drawn depth of journal and bushing over the radii between them."""
_ANGLE = "bushing angle  θ [deg]"
_MILLI = 1e3


def pack(ds: xr.Dataset) -> Figure:
    """Draw the foil pack of ``check``: its section, and one petal unrolled, assembled in the pack and free of it.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``check``, with the free and the assembled shape.

    Returns
    -------
    matplotlib.figure.Figure
        Section with its clearance stretched on the left; on the right the unrolled pack, and below it, on a scale of
        its own, the free petal, which reaches far into the journal.

    Raises
    ------
    ConvergenceError
        The assembled shape did not converge.
    """
    ds = mid_plane(one_point(ds))
    fig = style.figure(12.0, 6.8)
    has_free = "radius" in ds and "free_radius" in ds
    rows = ["pack", "free"] if has_free else ["pack"]
    axes = fig.subplot_mosaic([["section", row] for row in rows], width_ratios=[1.0, 1.1])
    _draw_section(axes["section"], ds)
    _draw_pack(axes["pack"], ds)
    if has_free:
        _draw_free(axes["free"], ds)
    _draw_legend(axes[rows[-1]], [axes[row] for row in rows])
    style.set_title(fig, ds, *_facts(ds))
    shown = {"pack": "foil pack" if "radius" in ds else "clearance", "free": "petal 0 before assembly"}
    _state_stretches(fig, {axes[row]: shown[row] for row in rows}, ds)
    return fig


def _draw_legend(lowest: Axes, shown: list[Axes]) -> None:
    """One legend of all unrolled panels, below the lowest of them."""
    handles = [handle for ax in shown for handle in ax.get_legend_handles_labels()[0]]
    if handles:
        look: style.Look = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.34), "ncols": 2, "frameon": False}
        names = [str(handle.get_label()) for handle in handles]
        lowest.legend(handles, names, fontsize=style.TICK, **look)


def _state_stretches(fig: Figure, shown: dict[Axes, str], ds: xr.Dataset) -> None:
    """Head each unrolled panel with how many times its radius is stretched against its arc."""
    for ax, name in shown.items():
        ax.set_title(name, fontsize=style.LABEL, color=style.INK)
    fig.draw_without_rendering()  # the layout decides the size of the axes
    for ax, name in shown.items():
        box = ax.get_window_extent()
        arc = math.radians(np.ptp(ax.get_xlim())) * number(ds, "bushing_radius") * _MILLI
        stretch = (box.height / np.ptp(ax.get_ylim())) / (box.width / arc)
        told = f"{stretch:.2g}" if stretch < 100.0 else labels.grouped(float(f"{stretch:.2g}"))
        ax.set_title(f"{name}, unrolled, radius stretched ×{told}", fontsize=style.LABEL, color=style.INK)


def _facts(ds: xr.Dataset) -> list[str]:
    formats = {
        "overlap": "overlap {:.3g}",
        "layers": "{:.0f} layers",
        "radial_clearance": "least radial clearance {:.4g} µm",
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
    size = f"journal\nØ {2e3 * number(ds, 'journal_radius'):.4g} mm"
    ax.text(0.0, 0.0, size, ha="center", va="center", fontsize=style.TICK, color=style.INK)
    frame_section(ax, stretch)


def _draw_pack(ax: Axes, ds: xr.Dataset) -> None:
    """Radius against bushing angle over one petal: the assembled petals between journal and bushing."""
    window = _window(ds)
    bore, journal = number(ds, "bushing_radius") * _MILLI, journal_surface(ds, window) * _MILLI
    if "radius" in ds:
        _draw_petals(ax, ds, window)
    _draw_walls(ax, np.degrees(window), journal, (float(journal.min()), bore))
    style.dress(ax, "" if "free_radius" in ds else _ANGLE, "radius [mm]")


def _draw_free(ax: Axes, ds: xr.Dataset) -> None:
    """The free mid-surface of the first petal, and where it would meet the journal."""
    window, root = _window(ds), float(array(ds, "root_angle")[0])
    bore, journal = number(ds, "bushing_radius") * _MILLI, journal_surface(ds, window) * _MILLI
    phi, free = array(ds, "phi"), array(ds, "free_radius") * _MILLI
    ax.plot(np.degrees(root + phi), free, "--", color=style.VERMILLION, linewidth=1.6, label="petal 0, free", zorder=4)
    meets = number(ds, "first_contact_angle")
    if not math.isnan(meets):
        place = (math.degrees(root + meets), float(np.interp(meets, phi, free)))
        ax.plot(*place, "o", color=style.VERMILLION, markersize=6, label="free petal meets the journal", zorder=5)
    _draw_walls(ax, np.degrees(window), journal, (min(float(journal.min()), float(free.min())), bore))
    style.dress(ax, _ANGLE, "radius [mm]")


def _window(ds: xr.Dataset) -> Floats:
    """Bushing angles that are shown: those of the first petal and a margin, or the whole bore [rad]."""
    span = float(array(ds, "phi")[-1]) if "phi" in ds.coords else 2.0 * math.pi
    root = float(array(ds, "root_angle")[0]) if "root_angle" in ds.coords else 0.0
    margin = _MARGIN if "radius" in ds else 0.0
    return np.linspace(root - margin * span, root + (1.0 + margin) * span, 361)


def _draw_walls(ax: Axes, degrees: Floats, journal: Floats, limits: tuple[float, float]) -> None:
    """Journal below and bushing above, each with its name."""
    low, bore = limits
    depth = _DEPTH * (bore - low)
    look: style.Look = {"facecolor": style.PALE, "edgecolor": style.GREY, "hatch": "////", "linewidth": 0}
    ax.fill_between(degrees, bore, bore + depth, gid="bushing", **look)
    ax.fill_between(degrees, low - depth, journal, facecolor=style.STEEL, linewidth=0, zorder=0, gid="journal")
    ax.plot(degrees, journal, color=style.INK, linewidth=1.0)
    ax.axhline(bore, color=style.INK, linewidth=1.0)
    place: style.Look = {"fontsize": style.TICK, "color": style.INK, "va": "center"}
    box = {"facecolor": style.WHITE, "edgecolor": "none", "pad": 1.5}
    ax.text(degrees[6], low - depth / 2, "journal", **place)
    ax.text(degrees[6], bore + depth / 2, "bushing", bbox=box, **place)
    ax.set_xlim(degrees[0], degrees[-1])
    ax.set_ylim(low - depth, bore + depth)


def _draw_petals(ax: Axes, ds: xr.Dataset, window: Floats) -> None:
    """The petals with their thickness; the first one stands out, the others have two shades in turn."""
    half, phi, radius = number(ds, "petal_thickness") / 2, array(ds, "phi"), array(ds, "radius")
    named: set[str] = set()
    for petal, root in enumerate(array(ds, "root_angle")):
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
            name = "petal 0, assembled" if first else f"{('even', 'odd')[petal % 2]} petals"
            faces = ((radius[petal] - half) * _MILLI, (radius[petal] + half) * _MILLI)
            label = None if name in named else name
            ax.fill_between(np.degrees(theta), *faces, label=label, zorder=2 + first, gid=f"petal {petal}", **look)
            named.add(name)
    for petal in range(1, min(3, len(radius))):  # shades that the section has and this window has not
        if (name := f"{('even', 'odd')[petal % 2]} petals") not in named:
            shade: style.Look = {"facecolor": style.PETALS[petal % 2], "edgecolor": style.INK, "linewidth": 0.5}
            ax.fill_between([], [], label=name, **shade)
