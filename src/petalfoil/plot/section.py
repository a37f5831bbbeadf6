"""The bearing cut across: petals, journal, bushing, film and pressure, the radial clearance stretched to be seen.

A film is under a thousandth of the radius, so a true section shows nothing. Every radius `r` about the bushing's axis
is drawn at `R_B − s (R_B − r)`: the bore keeps its size, and everything between it and the journal, petals, film and
displacement alike, is `s` times too large.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch

from petalfoil.errors import UsageError
from petalfoil.plot import labels, style
from petalfoil.plot.film_fields import draw_film, draw_film_map, draw_pressure, draw_pressure_map
from petalfoil.plot.labels import MICRO
from petalfoil.plot.section_walls import draw_backing, draw_foil, draw_petals, draw_solids, foil_room
from petalfoil.plot.stretch import Stretch, round_scale
from petalfoil.plot.views import (
    Floats,
    array,
    contact_places,
    displacement,
    grown_radius,
    is_3d,
    journal_surface,
    mid_plane,
    number,
    one_point,
    touching,
)

_LEAST_JOURNAL = 0.1
"""Least share of the bore's radius that is left to the journal at any scale."""
_BAND = 0.34
"""Height of the largest excess pressure over the drawn radius of the journal."""
_LEAST_ARROW = 0.03
"""Least drawn displacement over the drawn radius of the journal that an arrow shows: a shorter one is all head."""
_LEGEND = 0.45
"""Space below the section for its legend, over the bushing's radius."""
_CIRCLE = np.linspace(0.0, 2.0 * np.pi, 361)


def cross_section(ds: xr.Dataset, *, scale: float | None = None) -> Figure:
    """Draw the loaded bearing cut across at its mid-plane, the radial clearance `scale` times too large.

    Parameters
    ----------
    ds : xarray.Dataset
        One converged state, turning or at zero speed.
    scale : float, optional
        How many times too large the radial clearance is drawn; by default it takes up to half the radius.

    Returns
    -------
    matplotlib.figure.Figure
        The section, with the scale written below it.

    Raises
    ------
    ConvergenceError
        The state did not converge.
    UsageError
        The scale leaves no journal, or the dataset holds several points.
    """
    ds = one_point(ds)
    fig = style.figure(8.0, 7.4)
    ax = fig.subplots()
    draw_section(ax, ds, scale)
    style.set_title(fig, ds, *labels.state_facts(ds), labels.plane_fact(ds))
    return fig


def operating_point(ds: xr.Dataset) -> Figure:
    """Draw one state: its section, and pressure and film thickness as lines (2-D) or as maps (3-D).

    Parameters
    ----------
    ds : xarray.Dataset
        One converged state with pressure and film.

    Returns
    -------
    matplotlib.figure.Figure
        Section on the left, pressure and film on the right.

    Raises
    ------
    ConvergenceError
        The state did not converge.
    UsageError
        The dataset holds several points.
    """
    ds = one_point(ds)
    fig = style.figure(13.0, 6.4)
    axes = fig.subplot_mosaic([["section", "pressure"], ["section", "film"]], width_ratios=[1.0, 1.1])
    draw_section(axes["section"], ds)
    draw_p, draw_h = (draw_pressure_map, draw_film_map) if is_3d(ds) else (draw_pressure, draw_film)
    draw_p(axes["pressure"], ds)
    draw_h(axes["film"], ds)
    axes["pressure"].set_xlabel("")
    style.set_title(fig, ds, *labels.state_facts(ds), labels.plane_fact(ds))
    return fig


def draw_section(ax: Axes, ds: xr.Dataset, scale: float | None = None) -> None:
    """Draw the section of one state into axes."""
    plane = mid_plane(ds)
    factor = _checked_scale(plane, scale)
    stretch = Stretch(number(ds, "bushing_radius"), factor, foil_room(ds, factor))
    draw_solids(ax, plane, stretch)
    draw_backing(ax, plane, stretch)
    draw_petals(ax, plane, stretch)
    if "pressure" in ds:
        shades = Shades.of(
            array(ds, "pressure") / number(ds, "ambient_pressure")
        )  # of the whole film, as a map beside it
        draw_film_pressure(ax, plane, stretch, shades)
        _draw_ambient_line(ax, plane, stretch, shades)
        bar = ax.figure.colorbar(ax.collections[-1], ax=ax, shrink=0.6, pad=0.02, aspect=24)
        bar.set_label("p / p$_a$", fontsize=style.LABEL)
    draw_foil(ax, plane, stretch)
    surface = stretch.points(journal_surface(plane, _CIRCLE), _CIRCLE)
    ax.plot(*surface.T, color=style.INK, linewidth=1.0, gid="journal surface")
    _draw_contacts(ax, plane, stretch)
    _draw_arrows(ax, plane, stretch)
    frame_section(ax, stretch)


def default_scale(ds: xr.Dataset) -> float:
    """The largest of 1, 2, 5, 10, ... that keeps the radial clearance within its share and the journal round."""
    return round_scale(number(ds, "bushing_radius"), number(ds, "journal_radius"), math.hypot(*displacement(ds)))


def _checked_scale(ds: xr.Dataset, scale: float | None) -> float:
    if scale is None:
        return default_scale(ds)
    bore, lowest = number(ds, "bushing_radius"), float(journal_surface(ds, _CIRCLE).min())
    most = (1.0 - _LEAST_JOURNAL) * bore / (bore - lowest)
    if not 1.0 <= scale <= most:
        raise UsageError(
            f"the scale of a cross-section must be between 1 and {most:.3g} for this bearing, got {scale:g}"
        )
    return scale


@dataclass(frozen=True)
class Shades:
    """What colours and heights of pressures are measured by, shared by the states of one drawing.

    Parameters
    ----------
    norm : Normalize
        Colours over p / p_a.
    suction, largest : float
        Deepest suction below ambient pressure, largest distance from it, over ambient pressure.
    """

    norm: Normalize
    suction: float
    largest: float

    @classmethod
    def of(cls, ratio: Floats) -> Shades:
        """Shades that suit pressures over ambient pressure."""
        low, high = float(ratio.min()), float(ratio.max())
        norm = Normalize(min(low, 1.0), max(high, 1.001))
        return cls(norm, max(1.0 - low, 0.0), max(float(np.abs(ratio - 1.0).max()), 1e-12))


def draw_film_pressure(ax: Axes, ds: xr.Dataset, stretch: Stretch, shades: Shades) -> None:
    """Draw the film in the colour of its pressure, and the excess pressure as a band inside the journal."""
    ratio = array(ds, "pressure") / number(ds, "ambient_pressure")
    theta = array(ds, "root_angle")[:, None] + array(ds, "phi_exposed")
    surface = journal_surface(ds, theta)
    film = stretch.points(surface, theta), stretch.points(surface + array(ds, "film_thickness"), theta)
    band = _band(ds, stretch, (ratio, shades), theta)
    colours = np.concatenate([(row[1:] + row[:-1]) / 2 for row in ratio])
    for (low, high), name in ((film, "film"), (band, "pressure")):
        quads = list(_between(low, high))
        patches = PolyCollection(quads, array=colours, cmap=style.PRESSURE_MAP, norm=shades.norm, edgecolors="face")
        patches.set(linewidth=0.3, gid=name)
        ax.add_collection(patches)


def _band(ds: xr.Dataset, stretch: Stretch, pressure: tuple[Floats, Shades], theta: Floats) -> tuple[Floats, Floats]:
    """Base line (ambient pressure) and top of the pressure band; suction goes outside the base line."""
    ratio, shades = pressure
    base, height = _ambient_line(ds, stretch, shades, theta)
    direction = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    return base[..., None] * direction, (base - height * (ratio - 1.0))[..., None] * direction


def _ambient_line(ds: xr.Dataset, stretch: Stretch, shades: Shades, theta: Floats) -> tuple[Floats, float]:
    """Drawn radius of ambient pressure in the band, and of one ambient pressure above it [m]."""
    height = _BAND * float(stretch.radius(np.array(grown_radius(ds)))) / shades.largest
    return stretch.radius(journal_surface(ds, theta)) - height * shades.suction, height


def _draw_ambient_line(ax: Axes, ds: xr.Dataset, stretch: Stretch, shades: Shades) -> None:
    """The line that the pressure band is drawn from: inward above ambient pressure, outward below it."""
    base, _ = _ambient_line(ds, stretch, shades, _CIRCLE)
    look: style.Look = {"color": style.GREY, "linewidth": 1.0, "linestyle": ":", "gid": "ambient pressure"}
    ax.plot(base * np.cos(_CIRCLE), base * np.sin(_CIRCLE), label="pressure band, from p$_a$ inward", **look)


def _between(low: Floats, high: Floats) -> Floats:
    """Quadrilaterals between two lines of places of every strip."""
    quads = np.stack([low[:, :-1], low[:, 1:], high[:, 1:], high[:, :-1]], axis=2)
    return quads.reshape(-1, 4, 2)


def _draw_contacts(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    kinds = {
        "journal_contact_pressure": ("journal in contact", style.VERMILLION),
        "bushing_contact_pressure": ("petal on bushing", style.ORANGE),
        "petal_contact_pressure": ("petal on petal", style.PURPLE),
    }
    for facing, (name, (label, colour)) in enumerate(kinds.items()):
        theta, radius = contact_places(ds, facing) if "contact_force" in ds else _at_nodes(ds, name)
        if not len(theta):
            continue
        if name == "journal_contact_pressure":
            radius = journal_surface(ds, theta)
        look: style.Look = {"color": colour, "markersize": 4, "markeredgecolor": style.WHITE, "markeredgewidth": 0.3}
        ax.plot(*stretch.points(radius, theta).T, "o", label=label, gid=name, zorder=5, **look)


def _at_nodes(ds: xr.Dataset, name: str) -> tuple[Floats, Floats]:
    """Bushing angles of contacts at nodes, and radii of the outer face of the petals there, (k,) each."""
    nothing = np.zeros(0)
    if name not in ds or not (touched := touching(ds, name)).any():
        return nothing, nothing
    theta = (array(ds, "root_angle")[:, None] + array(ds, str(ds[name].dims[-1])))[touched]
    outer = array(ds, "radius") + number(ds, "petal_thickness") / 2
    return theta, outer[touched] if outer.shape == touched.shape else nothing


def _draw_arrows(ax: Axes, ds: xr.Dataset, stretch: Stretch) -> None:
    """Draw displacement, force and rotation at the journal's centre, side by side rather than over each other."""
    e = stretch.scale * np.array(displacement(ds))
    drawn = float(stretch.radius(np.array(grown_radius(ds))))
    force = np.array([number(ds, "force_x"), number(ds, "force_y")])
    size, distance = float(np.hypot(*force)), float(np.hypot(*e))
    ax.plot(0.0, 0.0, "+", color=style.INK, markersize=9, label="centre of the bushing", gid="centre")
    taken = []  # directions from the journal's centre that arrows occupy
    if distance > _LEAST_ARROW * drawn:
        _arrow(ax, np.zeros(2), e, style.GREEN, "displacement")
        told = f"displacement, {distance / stretch.scale * MICRO:.3g} µm ×{labels.grouped(stretch.scale)}"
        ax.plot([], [], color=style.GREEN, linewidth=1.6, label=told)
        taken.append(-e / distance)
    elif distance > 0.0:
        told = f"displacement, {distance / stretch.scale * MICRO:.3g} µm (not visible)"
        ax.plot([], [], linestyle="", label=told)
    if size > 0.0:
        along = 0.5 * drawn * force / size
        against = (
            force @ e <= 0.0
        )  # the arrow ends at the centre where one that starts there would cover the displacement
        tail, tip = (e - along, e) if against else (e, e + along)
        _arrow(ax, tail, tip, style.BLUE, "force")
        ax.plot([], [], color=style.BLUE, linewidth=1.6, label=f"force on the journal, {size:.3g} N")
        taken.append((-force if against else force) / size)
    if number(ds, "speed") > 0.0:
        _draw_rotation(ax, e, 0.42 * drawn, _widest_gap(taken))


def _widest_gap(directions: list[Floats]) -> float:
    """Angle of the middle of the widest gap between directions; below the centre where there is none [rad]."""
    if not directions:
        return -math.pi / 2
    angles = np.sort([math.atan2(y, x) for x, y in directions])
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * math.pi))
    widest = int(np.argmax(gaps > gaps.max() - 1e-9))
    return float(angles[widest] + 0.5 * gaps[widest])


def _arrow(ax: Axes, tail: Floats, tip: Floats, colour: str, name: str) -> None:
    arrow = FancyArrowPatch(tuple(tail), tuple(tip), arrowstyle="-|>", mutation_scale=10, shrinkA=0, shrinkB=0)
    arrow.set(color=colour, linewidth=1.6, gid=name, zorder=6)
    ax.add_patch(arrow)


def _draw_rotation(ax: Axes, centre: Floats, radius: float, middle: float) -> None:
    """An arc with a head, growing with the bushing angle, around a side that other arrows leave free."""
    angles = middle + np.radians(np.linspace(-40.0, 40.0, 41))
    arc = centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    ax.plot(*arc[:-1].T, color=style.INK, linewidth=1.4, gid="rotation")
    _arrow(ax, arc[-2], arc[-1], style.INK, "rotation head")
    inside = centre + 0.72 * radius * np.array([math.cos(middle), math.sin(middle)])
    ax.text(inside[0], inside[1], "ω", ha="center", va="center", fontsize=style.TITLE, color=style.INK)


def frame_section(ax: Axes, stretch: Stretch) -> None:
    """Mark the bushing angles around a section, and state below it how far it is stretched."""
    ax.set_aspect("equal")
    ax.set_axis_off()
    rim = 1.13 * stretch.bushing
    for degrees in (0, 90, 180, 270):
        angle = math.radians(degrees)
        place = (rim * math.cos(angle), rim * math.sin(angle))
        ax.text(*place, f"{degrees}°", ha="center", va="center", fontsize=style.TICK, color=style.GREY)
    size = stretch.bushing
    ax.set_xlim(-1.18 * size, 1.18 * size)
    ax.set_ylim(-(1.18 + _LEGEND) * size, 1.18 * size)
    drawn = f"radial clearance drawn ×{labels.grouped(stretch.scale)}"
    note = f"{drawn}, {_within(ax)}displacement too; journal not to scale"
    ax.text(0.0, -1.24 * size, note, ha="center", va="center", fontsize=style.TICK, color=style.INK)
    below = {"bbox_to_anchor": (0.0, -1.27 * size), "bbox_transform": ax.transData, "borderaxespad": 0.0}
    style.legend(ax, loc="upper center", ncols=2, frameon=False, **below)


def _within(ax: Axes) -> str:
    """What is stretched together with the clearance, beside the displacement."""
    gids = {str(artist.get_gid()) for artist in (*ax.lines, *ax.patches)}
    if "top foil" in gids:
        return "foil and "
    return "petals and " if "petal 0" in gids else ""
