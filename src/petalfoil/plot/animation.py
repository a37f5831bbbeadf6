"""The last revolutions of a motion as moving pictures: the section with petals, film and journal, and the path.

Both forms are files of their own: an HTML page with its pictures and its player inside, or a GIF.
"""

from __future__ import annotations

import base64
import io
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path as File

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

from petalfoil.errors import StoreError, UsageError
from petalfoil.plot import labels, style
from petalfoil.plot.journal_orbit import draw_path
from petalfoil.plot.labels import MICRO
from petalfoil.plot.orbit_views import motion_facts, path_of
from petalfoil.plot.section import Shades, default_scale, draw_film_pressure
from petalfoil.plot.section_walls import draw_petals, draw_solids
from petalfoil.plot.stretch import Stretch
from petalfoil.plot.views import array, journal_surface, mid_plane, number
from petalfoil.results.atomic import replacing
from petalfoil.results.motion import TURN, Path
from petalfoil.text import for_html

FORMS = (".html", ".gif")
DPI = 80
DELAY = 80
"""Time that a picture is shown [ms]."""
_SMOOTH = 192
"""Cells round the circle below which the film is drawn on a finer grid, between its nodes."""
_DENT = 0.4
"""Largest displacement over the journal's radius, both as drawn: beyond one half its outline would be dented."""
_ROUNDING = 1e-6
"""Film above the contact film thickness, over it, up to which the journal counts as in contact."""
_CIRCLE = np.linspace(0.0, TURN, 361)
_STATE = {
    "frame_pressure": "pressure",
    "frame_film_thickness": "film_thickness",
    "frame_radius": "radius",
    "frame_x": "eccentricity_x",
    "frame_y": "eccentricity_y",
}
"""Fields of a picture by their names in the result of one state."""


def animate(ds: xr.Dataset, path: str | File) -> None:
    """Write the last revolutions of a motion as moving pictures; a former file is replaced whole, or left alone.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.
    path : str or pathlib.Path
        Where to: ``.html`` (a page that needs nothing else) or ``.gif``.

    Raises
    ------
    UsageError
        The suffix is neither of these, or the dataset holds no motion.
    StoreError
        The file cannot be written.
    """
    target = File(path)
    if target.suffix.lower() not in FORMS:
        raise UsageError(f"an animation is written as one of {', '.join(FORMS)}; {target.name!r} asks for another")
    palette = _palette()
    pictures = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in frames(ds)]
    try:
        with replacing(target) as temporary:
            if target.suffix.lower() == ".gif":
                first, *others = pictures
                first.save(temporary, format="GIF", save_all=True, append_images=others, duration=DELAY, loop=0)
            else:
                temporary.write_text(_page(str(ds.attrs.get("title", "")), pictures), encoding="utf-8")
    except OSError as error:
        raise StoreError(f"cannot write {target}: {error}") from error


def frames(ds: xr.Dataset) -> Iterator[Image.Image]:
    """Draw the pictures, one after the other.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    still = ds.drop_vars([name for name in ds.data_vars if "time" in ds[name].dims or name in _STATE.values()])
    scene = _Scene.of(_smooth(mid_plane(still)), ds, path)
    for number_ in range(ds.sizes["frame"]):
        scene.show(number_)
        yield scene.image()


@dataclass
class _Scene:
    """The drawing whose section and moving point are renewed for every picture.

    Attributes
    ----------
    fig : Figure
        The figure.
    section, close : Axes
        The bearing cut across; the path close up.
    states : xarray.Dataset
        Pictures along ``frame``.
    path : Path
        The path.
    stretch, shades
        Scale of the section and of its pressures, the same in all pictures.
    """

    fig: Figure
    section: Axes
    close: Axes
    states: xr.Dataset
    path: Path
    stretch: Stretch
    shades: Shades

    @classmethod
    def of(cls, states: xr.Dataset, ds: xr.Dataset, path: Path) -> _Scene:
        """Set the drawing up; all that stays is drawn here."""
        states = states.rename({old: new for old, new in _STATE.items() if old in states})
        stretch = Stretch(number(ds, "bushing_radius"), _scale(ds))
        shades = Shades.of(array(states, "pressure") / number(ds, "ambient_pressure"))
        fig = style.figure(12.0, 6.8)
        section, close = fig.subplots(1, 2, width_ratios=[1.35, 1.0])
        fig.set_dpi(DPI)
        draw_path(close, ds, path, ratio=0.9, columns=2)
        close.plot([], [], "o", color=style.INK, markersize=9, gid="now")
        bar = fig.colorbar(ScalarMappable(shades.norm, style.PRESSURE_MAP), ax=section, shrink=0.6, pad=0.02, aspect=24)
        bar.set_label("p / p$_a$", fontsize=style.LABEL)
        style.set_title(fig, ds, *motion_facts(ds, path), labels.plane_fact(ds))
        scene = cls(fig, section, close, states, path, stretch, shades)
        scene.show(0)
        fig.draw_without_rendering()
        fig.set_layout_engine("none")  # the places found for the first picture stay
        return scene

    def show(self, number_: int) -> None:
        """Draw one picture."""
        ax, state = self.section, self.states.isel(frame=number_)
        ax.clear()
        draw_solids(ax, state, self.stretch)
        draw_petals(ax, state, self.stretch)
        draw_film_pressure(ax, state, self.stretch, self.shades)
        surface = self.stretch.points(journal_surface(state, _CIRCLE), _CIRCLE)
        ax.plot(*surface.T, color=style.INK, linewidth=1.0)
        _mark_contacts(ax, state, self.stretch)
        self._draw_centre(number_)
        self._draw_mark(state)
        _frame(ax, self.stretch)
        place = (MICRO * number(state, "eccentricity_x"), MICRO * number(state, "eccentricity_y"))
        (now,) = [line for line in self.close.lines if line.get_gid() == "now"]
        now.set_data([place[0]], [place[1]])
        low = -1.12 * self.stretch.bore
        ax.text(0.0, low, self._clock(state), ha="center", va="center", fontsize=style.TITLE, color=style.INK)

    def _draw_centre(self, number_: int) -> None:
        """The journal's centre and where it came from, to the scale of the section."""
        scale = self.stretch.scale
        since = self.states.isel(frame=slice(0, number_ + 1))
        x, y = scale * array(since, "eccentricity_x"), scale * array(since, "eccentricity_y")
        self.section.plot(0.0, 0.0, "+", color=style.INK, markersize=9)
        self.section.plot(x, y, color=style.VERMILLION, linewidth=1.0)
        self.section.plot(x[-1], y[-1], "o", color=style.VERMILLION, markersize=5)

    def _draw_mark(self, state: xr.Dataset) -> None:
        """A line fixed to the shaft: it shows the rotation."""
        angle = float(np.interp(number(state, "frame"), self.path.time, self.path.angle))
        centre = self.stretch.scale * np.array([number(state, "eccentricity_x"), number(state, "eccentricity_y")])
        out = float(self.stretch.radius(np.array(number(state, "journal_radius"))))
        ends = np.outer([0.06, 0.3], [np.cos(angle), np.sin(angle)]) * out + centre
        self.section.plot(*ends.T, color=style.GREY, linewidth=2.0, solid_capstyle="round")

    def _clock(self, state: xr.Dataset) -> str:
        time = number(state, "frame")
        turned = float(np.interp(time, self.path.time, self.path.angle)) / TURN
        speed = float(np.interp(time, self.path.time, self.path.speed))
        return f"t = {1e3 * time:.2f} ms · revolution {turned:.2f} · {labels.speed_fact(speed)}"

    def image(self) -> Image.Image:
        """The drawing as pixels."""
        buffer = io.BytesIO()
        self.fig.savefig(buffer, format="png", dpi=DPI)
        return Image.open(buffer).convert("RGB")


def _scale(ds: xr.Dataset) -> float:
    """The largest of 1, 2, 5, 10, ... at which clearance and displacements suit the drawing."""
    bore = number(ds, "bushing_radius")
    clearance = bore - number(ds, "journal_radius")
    moved = float(np.hypot(array(ds, "frame_x"), array(ds, "frame_y")).max())
    most = min(default_scale(ds), _DENT * bore / (moved + _DENT * clearance))
    return max(step * 10.0**decade for decade in range(9) for step in (1.0, 2.0, 5.0) if step * 10.0**decade <= most)


def _smooth(states: xr.Dataset) -> xr.Dataset:
    """The film on a finer grid where its own would show corners."""
    cells = states.sizes["phi_exposed"] - 1
    finer = -(-_SMOOTH // (cells * states.sizes["petal"]))
    if finer <= 1:
        return states
    phi = array(states, "phi_exposed")
    return states.interp(phi_exposed=np.interp(np.arange(cells * finer + 1) / finer, np.arange(cells + 1), phi))


def _palette() -> Image.Image:
    """One palette for all pictures: colours of pressures, and those of lines with their passage to white."""
    colours = [matplotlib.colormaps[style.PRESSURE_MAP](share)[:3] for share in np.linspace(0.0, 1.0, 136)]
    colours += [(grey, grey, grey) for grey in np.linspace(0.0, 1.0, 24)]
    for name in (style.BLUE, style.SKY, style.GREEN, style.ORANGE, style.VERMILLION, *style.PETALS):
        solid = np.array(to_rgb(name))
        colours += [tuple(white + (1.0 - white) * solid) for white in np.linspace(0.0, 0.75, 12)]
    image = Image.new("P", (1, 1))
    image.putpalette([round(255 * part) for colour in colours[:256] for part in colour])
    return image


def _mark_contacts(ax: Axes, state: xr.Dataset, stretch: Stretch) -> None:
    """Mark where the film has the contact film thickness."""
    least = number(state, "contact_film_thickness")
    touched = array(state, "film_thickness") <= least * (1.0 + _ROUNDING)
    if touched.any():
        theta = (array(state, "root_angle")[:, None] + array(state, "phi_exposed"))[touched]
        look: style.Look = {"color": style.CONTACT, "markersize": 4, "markeredgecolor": style.WHITE, "zorder": 5}
        ax.plot(*stretch.points(journal_surface(state, theta), theta).T, "o", markeredgewidth=0.3, **look)


def _frame(ax: Axes, stretch: Stretch) -> None:
    reach = 1.1 * stretch.bore
    ax.set_aspect("equal")
    ax.set_axis_off()
    ax.set_xlim(-reach, reach)
    ax.set_ylim(-1.15 * reach, reach)
    note = f"radial clearance drawn ×{labels.grouped(stretch.scale)}; red: journal in contact"
    ax.text(0.0, -1.12 * reach, note, ha="center", va="center", fontsize=style.TICK, color=style.INK)


def _page(title: str, pictures: list[Image.Image]) -> str:
    """The page with its pictures and its player inside."""
    shell = files("petalfoil.plot").joinpath("player.html").read_text(encoding="utf-8")
    inline = json.dumps([_inline(picture) for picture in pictures])
    inside = {"TITLE": for_html(title) or "petalfoil", "DELAY": str(DELAY), "FRAMES": inline}
    # One pass over the shell: a title that looks like a placeholder is text, not the next one to be filled.
    return re.sub("@([A-Z]+)@", lambda mark: inside[mark[1]], shell)


def _inline(picture: Image.Image) -> str:
    buffer = io.BytesIO()
    picture.save(buffer, format="PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode("ascii")
