"""Colours, sizes, axes and titles of the figures.

The palette is Okabe and Ito's, told apart with any colour vision; the colour maps (viridis, cividis) grow evenly in
brightness.
"""

from __future__ import annotations

import textwrap
from typing import Any, TypeAlias

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from petalfoil.plot.canvas import DPI, ResultFigure
from petalfoil.text import for_terminal

Look: TypeAlias = dict[str, Any]
"""Keywords of an artist: colour, size and the like."""

BLUE, SKY, GREEN, ORANGE, VERMILLION, PURPLE = "#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00", "#CC79A7"
INK, GREY, PALE, WHITE = "#222222", "#777777", "#E6E6E6", "#FFFFFF"
FAMILY = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, INK)
FAMILY_MARKERS = ("o", "s", "^", "D", "v", "P", "X")
PETALS = ("#8F9BA6", "#C3CBD2")
"""Metal of even and odd petals."""
ALTERNATING = (BLUE, SKY)
"""Lines of even and odd petals."""
STEEL = "#F4F4F4"
"""Journal."""
PRESSURE_MAP, FILM_MAP = "viridis", "cividis"
CONTACT = VERMILLION

TITLE, LABEL, TICK = 11.0, 10.0, 9.0
"""Font sizes [pt]: readable when a figure of 8 inches is shown across a page."""


def figure(width: float, height: float) -> ResultFigure:
    """An empty figure of a size in inches, with a canvas of its own and space kept for titles and labels."""
    fig = ResultFigure(figsize=(width, height), dpi=DPI, layout="constrained", facecolor=WHITE)
    FigureCanvasAgg(fig)
    return fig


def dress(ax: Axes, xlabel: str = "", ylabel: str = "") -> None:
    """Give axes their labels, sizes and a faint grid; the frame keeps its left and lower side."""
    ax.set_xlabel(xlabel, fontsize=LABEL)
    ax.set_ylabel(ylabel, fontsize=LABEL)
    ax.tick_params(labelsize=TICK, color=GREY)
    ax.grid(True, color=PALE, linewidth=0.6)
    ax.set_axisbelow(True)
    ax.spines[["top", "right"]].set_visible(False)
    ax.spines[["left", "bottom"]].set_color(GREY)


def logarithmic(axis: Axis) -> None:
    """Label a logarithmic axis at 1, 2 and 5 of each decade, in plain numbers."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(lambda value, _: f"{value:g}")
    axis.set_minor_formatter(NullFormatter())


def full_circle(ax: Axes) -> None:
    """Let the horizontal axis be the bushing angle, once around."""
    ax.set_xlim(0.0, 360.0)
    ax.set_xticks(range(0, 361, 45))


def legend(ax: Axes, **options: Any) -> None:
    """Legend in the shared style, if any artist has a label."""
    handles, labels = ax.get_legend_handles_labels()
    if handles:
        look: Look = {"fontsize": TICK, "frameon": True, "framealpha": 0.9, "edgecolor": PALE} | options
        ax.legend(handles, labels, **look)


def legend_below(ax: Axes, columns: int) -> None:
    """Legend of axes below all panels of their figure, where it covers none of them."""
    handles, labels = ax.get_legend_handles_labels()
    look: Look = {"fontsize": TICK, "frameon": False, "ncols": columns}
    ax.figure.legend(handles, labels, loc="outside lower center", **look)


def folded(text: str, columns: int = 30) -> str:
    """A long label on several lines."""
    return "\n".join(textwrap.wrap(text, columns))


def set_title(fig: Figure, ds: xr.Dataset, *facts: str) -> None:
    """Head a figure with the case's title and, below it, the facts of the state that do not stand empty.

    Parameters
    ----------
    fig : Figure
        Figure to head.
    ds : xarray.Dataset
        Result whose title is used.
    *facts : str
        Speed, displacement, grid and the like.
    """
    columns = int(fig.get_figwidth() * 72.0 / (0.6 * TITLE))  # a letter of the sans-serif is about 0.6 em wide
    lines = textwrap.wrap(for_terminal(str(ds.attrs.get("title", ""))), columns) + textwrap.wrap(
        " · ".join(filter(None, facts)), columns
    )
    fig.suptitle("\n".join(lines), fontsize=TITLE, color=INK, parse_math=False)  # `$` is no formula
