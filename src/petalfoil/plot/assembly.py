"""The package as it is put together: true to scale, and one petal unrolled with its free shape."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Wedge

from petalfoil.plot import style
from petalfoil.plot.reading import Floats, array, journal_surface, mid_plane, number, one_point
from petalfoil.plot.section import Stretch, petal_outline

_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 361)
_MARGIN = 0.12
"""Angle shown beyond each end of the unrolled petal over the petal's angle."""


def package(ds: xr.Dataset) -> Figure:
    """Draw the package of ``check``: the whole section true to scale, and one petal unrolled with its radius stretched.

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
    fig = style.figure(10.0, 5.2)
    left, right = fig.subplots(1, 2, width_ratios=[1.0, 1.15])
    _draw_whole(left, ds)
    _draw_unrolled(right, ds)
    style.set_title(fig, ds, *_facts(ds))
    _state_stretch(fig, right, ds)
    return fig


def _state_stretch(fig: Figure, ax: Axes, ds: xr.Dataset) -> None:
    """Head the unrolled petal with how many times its radius is stretched against its arc."""
    ax.set_title("unrolled", fontsize=style.LABEL, color=style.INK)
    fig.draw_without_rendering()  # the layout decides the size of the axes
    box = ax.get_window_extent()
    arc = math.radians(np.ptp(ax.get_xlim())) * number(ds, "bushing_radius") * 1e3
    stretch = (box.height / np.ptp(ax.get_ylim())) / (box.width / arc)
    ax.set_title(f"unrolled, radius stretched ×{stretch:.2g}", fontsize=style.LABEL, color=style.INK)


def _facts(ds: xr.Dataset) -> list[str]:
    formats = {
        "overlap": "overlap {:.3g}",
        "layers": "{:.0f} layers",
        "radial_clearance": "radial room {:.4g} µm",
        "pack_clearance": "{:.4g} µm left",
        "compressibility_number": "Λ = {:.3g}",
    }
    lengths = ("radial_clearance", "pack_clearance")
    known = {name: number(ds, name) * (1e6 if name in lengths else 1.0) for name in formats}
    return [form.format(known[name]) for name, form in formats.items() if not math.isnan(known[name])]


def _draw_whole(ax: Axes, ds: xr.Dataset) -> None:
    """The section in millimetres, nothing stretched."""
    bore = number(ds, "bushing_radius") * 1e3
    ring = Wedge((0.0, 0.0), 1.06 * bore, 0.0, 360.0, width=0.06 * bore)
    ring.set(facecolor=style.PALE, edgecolor=style.GREY, hatch="////", linewidth=0.8)
    ax.add_patch(ring)
    true = Stretch(number(ds, "bushing_radius"), 1.0)
    journal = true.points(journal_surface(ds, _CIRCLE), _CIRCLE) * 1e3
    ax.fill(*journal.T, facecolor="#F4F4F4", edgecolor=style.INK, linewidth=0.8, gid="journal")
    if "radius" in ds:
        _draw_true_petals(ax, ds, true)
    style.dress(ax, "x [mm]", "y [mm]")
    ax.grid(False)
    ax.set_aspect("equal")
    ax.set_xlim(-1.1 * bore, 1.1 * bore)
    ax.set_ylim(-1.1 * bore, 1.1 * bore)
    ax.set_title("true to scale", fontsize=style.LABEL, color=style.INK)


def _draw_true_petals(ax: Axes, ds: xr.Dataset, true: Stretch) -> None:
    half, phi, radius = number(ds, "petal_thickness") / 2, array(ds, "phi"), array(ds, "radius")
    for petal, root in enumerate(array(ds, "root_angle")):
        outline = petal_outline(radius[petal], root + phi, half, true) * 1e3
        colour = style.BLUE if petal == 0 else ("#4D5963", "#8F9BA6")[petal % 2]
        ax.fill(*outline.T, facecolor=colour, edgecolor=colour, linewidth=0.2, gid=f"petal {petal}")
    roots = true.points(np.full(ds.sizes["petal"], true.bore), array(ds, "root_angle")) * 1e3
    ax.plot(*roots.T, "s", color=style.INK, markersize=4, gid="roots")


def _draw_unrolled(ax: Axes, ds: xr.Dataset) -> None:
    """Radius against bushing angle over one petal, with everything that passes there."""
    span = float(array(ds, "phi")[-1]) if "phi" in ds.coords else 2.0 * math.pi
    root = float(array(ds, "root_angle")[0]) if "root_angle" in ds.coords else 0.0
    window = np.linspace(root - _MARGIN * span, root + (1.0 + _MARGIN) * span, 361)
    bore, journal = number(ds, "bushing_radius") * 1e3, journal_surface(ds, window) * 1e3
    low, high = float(journal.min()), bore
    if "radius" in ds:
        _draw_neighbours(ax, ds, window)
        low = min(low, _draw_free(ax, ds, root))
    depth = 0.12 * (high - low)
    degrees = np.degrees(window)
    ax.fill_between(
        degrees,
        bore,
        high + depth,
        facecolor=style.PALE,
        edgecolor=style.GREY,
        hatch="////",
        linewidth=0,
        gid="bushing",
    )
    ax.fill_between(degrees, low - depth, journal, facecolor="#F4F4F4", linewidth=0, zorder=0, gid="journal")
    ax.plot(degrees, journal, color=style.INK, linewidth=1.0)
    ax.axhline(bore, color=style.INK, linewidth=1.0)
    place: style.Look = {"fontsize": style.TICK, "color": style.INK, "va": "center"}
    ax.text(degrees[6], low - depth / 2, "journal", **place)
    ax.text(
        degrees[6],
        bore + depth / 2,
        "bushing",
        bbox={"facecolor": style.WHITE, "edgecolor": "none", "pad": 1.5},
        **place,
    )
    style.dress(ax, "bushing angle  θ [deg]", "radius [mm]")
    ax.set_xlim(degrees[0], degrees[-1])
    ax.set_ylim(low - depth, high + depth)
    style.legend(ax, loc="lower right")


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
            faces = ((radius[petal] - half) * 1e3, (radius[petal] + half) * 1e3)
            ax.fill_between(np.degrees(theta), *faces, label=label, zorder=2 + first, gid=f"petal {petal}", **look)


def _draw_free(ax: Axes, ds: xr.Dataset, root: float) -> float:
    """The free mid-surface of the first petal and where it would meet the journal; gives its lowest radius [mm]."""
    if "free_radius" not in ds:
        return math.inf
    phi, free = array(ds, "phi"), array(ds, "free_radius") * 1e3
    ax.plot(np.degrees(root + phi), free, "--", color=style.VERMILLION, linewidth=1.6, label="petal, free", zorder=4)
    meets = number(ds, "first_contact_angle")
    if not math.isnan(meets):
        place = (math.degrees(root + meets), float(np.interp(meets, phi, free)))
        ax.plot(*place, "o", color=style.VERMILLION, markersize=6, label="free petal meets the journal", zorder=5)
    return float(free.min())
