"""Colours of the charts, on a light and on a dark page; the palette is that of the figures on paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

BLUE, SKY, GREEN, ORANGE, VERMILLION, PURPLE = "#0072B2", "#56B4E9", "#009E73", "#E69F00", "#D55E00", "#CC79A7"


@dataclass(frozen=True)
class Theme:
    """Colours of a chart.

    Attributes
    ----------
    ink, faint, grid : str
        Lines and texts, notes, lines of the grid.
    bushing, journal : str
        Solids of a section.
    petals : tuple of str
        Metal of even and odd petals.
    accent, second, ghost : str
        First and second line, and that of the pinned design.
    """

    ink: str
    faint: str
    grid: str
    bushing: str
    journal: str
    petals: tuple[str, str]
    accent: str
    second: str
    ghost: str

    def layout(self, **own: Any) -> dict[str, Any]:
        """The layout of a chart: transparent, in the page's font and colours."""
        return {
            "paper_bgcolor": "rgba(0,0,0,0)",
            "plot_bgcolor": "rgba(0,0,0,0)",
            "font": {"color": self.ink, "size": 12, "family": "Roboto, system-ui, sans-serif"},
            "hovermode": "closest",
            "dragmode": "pan",
            "margin": {"l": 56, "r": 12, "t": 10, "b": 40},
            **own,
        }

    def axis(self, title: str, **own: Any) -> dict[str, Any]:
        """An axis with a title and a faint grid."""
        line = {"gridcolor": self.grid, "zeroline": False, "linecolor": self.faint, "ticks": "outside", "ticklen": 4}
        return {"title": {"text": title, "standoff": 6}, "automargin": True, "tickcolor": self.faint, **line, **own}

    def config(self, name: str) -> dict[str, Any]:
        """Settings of the drawing: a button that saves an SVG, no link to elsewhere, no request to a server."""
        return {
            "displaylogo": False,
            "modeBarButtonsToRemove": ["select2d", "lasso2d", "autoScale2d"],
            "toImageButtonOptions": {"format": "svg", "filename": f"petalfoil-{name}"},
            "scrollZoom": False,
            "plotlyServerURL": "",
        }


LIGHT = Theme(
    "#222222", "#5f5f5f", "#e3e6e8", "#d8dcdf", "#f4f5f6", ("#8f9ba6", "#c3cbd2"), BLUE, VERMILLION, "#9a9a9a"
)
DARK = Theme("#e8eaed", "#a7adb3", "#33383d", "#3a4046", "#1d2124", ("#77838e", "#a9b3bb"), SKY, ORANGE, "#8a8f94")
