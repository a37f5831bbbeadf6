"""The cross-section as a chart of the browser: bushing, petals, film in the colour of its pressure, journal, forces.

The chart is a plain mapping in the form of Plotly, drawn as SVG. Cells of a strip whose pressures share a colour are
one polygon, so that a thousand cells become some dozens of shapes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from petalfoil.plot.stretch import Stretch, petal_outline, round_scale
from petalfoil.studio.protocol import FoundAnswer
from petalfoil.studio.themes import Theme

Floats: TypeAlias = npt.NDArray[np.float64]
Chart: TypeAlias = dict[str, Any]
TraceData: TypeAlias = dict[str, Any]

VIRIDIS = (
    "#440154", "#481b6d", "#46327e", "#3f4788", "#365c8d", "#2e6e8e", "#277f8e", "#21918c",
    "#1fa187", "#2db27d", "#4ac16d", "#73d056", "#a0da39", "#d0e11c", "#fde725",
)  # fmt: skip
"""The colour map viridis in fifteen steps: grows evenly in brightness, with any colour vision."""
RING = 0.05
"""Thickness of the bushing's ring over its radius."""
BAND = 0.34
"""Height of the largest excess pressure over the drawn radius of the journal."""
BAND_NAME = "pressure band, from p<sub>a</sub> inward"
FOIL = 0.06
"""Drawn distance of the bushing behind a foil that deflects, over the bore's radius."""
ROUNDING = 1e-6
"""Distance of a drawn wall from the bore, over its radius, below which it is the bore."""
TOUCHING = 1e-6
"""Contact pressure over ambient pressure below which a reaction is rounding and not a contact."""
CONTACTS = {
    "journal_contact_pressure": ("journal in contact", "#D55E00"),
    "petal_contact_pressure": ("petal on petal", "#CC79A7"),
    "bushing_contact_pressure": ("petal on bushing", "#E69F00"),
}
NO_FORCE = 1e-6
"""Force, over ambient pressure times the square of the radius, below which none is drawn: that of a centred journal."""
CIRCLE = np.linspace(0.0, 2.0 * np.pi, 181)


@dataclass(frozen=True)
class State:
    """A state as a chart needs it.

    Attributes
    ----------
    found : FoundAnswer
        What the analysis found.
    stretch : Stretch
        The radial map.
    """

    found: FoundAnswer
    stretch: Stretch

    @classmethod
    def of(cls, found: FoundAnswer) -> State:
        """A state with the default stretch."""
        bore, journal = (float(found.scalars[f"{name}_radius"]) for name in ("bushing", "journal"))
        plain = cls(found, Stretch(bore, round_scale(bore, journal)))
        if "radius" in found.arrays:
            return plain
        outermost = float(plain.stretch.radius(plain.journal(plain.theta) + plain.array("film_thickness")).max())
        deflects = outermost > (1.0 + ROUNDING) * bore
        return cls(found, replace(plain.stretch, foil=outermost + FOIL * bore - bore)) if deflects else plain

    def scalar(self, name: str) -> float:
        """A result; NaN where there is none."""
        return float(self.found.scalars.get(name, math.nan))

    def vector(self, name: str) -> Floats:
        """Both components of a vector [SI]."""
        return np.array([self.scalar(f"{name}_x"), self.scalar(f"{name}_y")])

    def array(self, name: str) -> Floats:
        """An array."""
        return np.asarray(self.found.arrays[name], dtype=np.float64)

    @property
    def theta(self) -> Floats:
        """Bushing angles of the film's nodes, (petal, node) [rad]."""
        return self.array("root_angle")[:, None] + self.array("phi_exposed")

    def journal(self, theta: Floats) -> Floats:
        """Radius of the displaced journal's surface about the bushing's axis [m]."""
        e_x, e_y = self.scalar("eccentricity_x"), self.scalar("eccentricity_y")
        surface: Floats = self.scalar("journal_radius") + e_x * np.cos(theta) + e_y * np.sin(theta)
        return surface

    @property
    def pressure_ratio(self) -> Floats:
        """Film pressure over ambient pressure, (petal, node) [1]."""
        ratio: Floats = self.array("pressure") / self.scalar("ambient_pressure")
        return ratio


def has_section(found: FoundAnswer | None) -> bool:
    """Whether a result holds what a cross-section shows."""
    return found is not None and "pressure" in found.arrays and "bushing_radius" in found.scalars


def section_chart(found: FoundAnswer, theme: Theme) -> Chart:
    """The cross-section of a state.

    Parameters
    ----------
    found : FoundAnswer
        A converged state with pressure and film thickness.
    theme : Theme
        Colours.
    """
    state = State.of(found)
    solids = (*_solids(state, theme), *_petals(state, theme), *_film(state), *_foil(state, theme))
    arrows = list(_arrows(state, theme))
    named = (_named(BAND_NAME, VIRIDIS[len(VIRIDIS) // 2], 8), *(_named(words, colour) for words, colour, _ in arrows))
    traces = [*solids, *_roots(state, theme), *_contacts(state), *named]
    bore, reach = state.stretch.bushing, 1.2 * state.stretch.bushing
    axis = {"visible": False, "range": [-reach, reach], "fixedrange": False}
    note = note_at_foot(f"radial clearance drawn ×{state.stretch.scale:g}", theme)
    layout = theme.layout(
        xaxis=axis,
        yaxis=axis | {"scaleanchor": "x"},
        annotations=[*(arrow for _, _, arrow in arrows), *_rotation(state, theme), *_angles(bore, theme), note],
        legend={"orientation": "h", "y": -0.02, "x": 0.5, "xanchor": "center", "yanchor": "top"},
        margin={"l": 8, "r": 8, "t": 8, "b": 44},
        uirevision="section",
    )
    return {"data": traces, "layout": layout, "config": theme.config("cross-section")}


def polygon(points: Floats, **look: Any) -> TraceData:
    """A closed shape without an outline of its own."""
    x, y = np.round(points.T, 6)  # micrometres: finer than a pixel, and short to send
    shape = {"type": "scatter", "mode": "lines", "fill": "toself", "hoverinfo": "skip", "showlegend": False}
    return {**shape, "line": {"width": 0}, **look, "x": x.tolist(), "y": y.tolist()}


def ring(bore: float) -> Floats:
    """Outline of the bushing's ring, (point, 2) [m]."""
    rim = np.stack([np.cos(CIRCLE), np.sin(CIRCLE)], axis=-1)
    return np.concatenate([bore * rim, (1.0 + RING) * bore * rim[::-1]])


def _solids(state: State, theme: Theme) -> Iterator[TraceData]:
    bore = state.stretch.bushing
    yield polygon(ring(bore), fillcolor=theme.bushing, name="bushing")
    journal = state.stretch.points(state.journal(CIRCLE), CIRCLE)
    yield polygon(journal, fillcolor=theme.journal, line={"width": 1, "color": theme.ink}, name="journal")


def _petals(state: State, theme: Theme) -> Iterator[TraceData]:
    if "radius" not in state.found.arrays or "petal_thickness" not in state.found.scalars:
        return
    outlines = petal_outlines(state)
    for side in (0, 1):
        if outlines[side::2]:
            look = {"fillcolor": theme.petals[side], "line": {"width": 0.6, "color": theme.ink}}
            yield joined(outlines[side::2], name="petals", **look)


def petal_outlines(state: State) -> list[Floats]:
    """Outline of each petal, (point, 2) [m]."""
    half, phi, radius = 0.5 * state.scalar("petal_thickness"), state.array("phi"), state.array("radius")
    roots = enumerate(state.array("root_angle"))
    return [petal_outline(radius[petal], root + phi, half, state.stretch) for petal, root in roots]


def _foil(state: State, theme: Theme) -> Iterator[TraceData]:
    """The surface of a foil that deflects as a whole, such as the top foil of a bump foil bearing."""
    if not state.stretch.foil:
        return
    theta = state.theta.ravel()
    surface = state.stretch.points(state.journal(theta) + state.array("film_thickness").ravel(), theta)
    yield polygon(surface, fill="none", line={"width": 2, "color": theme.ink}, name="foil")


def joined(shapes: list[Floats], **look: Any) -> TraceData:
    """Several shapes as one trace; none as one without points."""
    trace = polygon(shapes[0] if shapes else np.zeros((0, 2)), **look)
    trace["x"], trace["y"] = [], []
    for number, shape in enumerate(shapes):
        one = polygon(np.concatenate([shape, shape[:1]]))
        trace["x"] += ([None] if number else []) + one["x"]
        trace["y"] += ([None] if number else []) + one["y"]
    return trace


def _film(state: State) -> Iterator[TraceData]:
    """The film, and the excess pressure as a band inside the journal, in the colours of the pressure."""
    ratio = state.pressure_ratio
    low, high = min(float(ratio.min()), 1.0), max(float(ratio.max()), 1.001)
    for colour, pieces in sorted(film_shapes(state, (low, high), BAND).items()):
        yield joined(pieces, fillcolor=VIRIDIS[colour], line={"width": 0.4, "color": VIRIDIS[colour]}, name="film")
    yield _colour_bar(low, high)


def film_shapes(state: State, limits: tuple[float, float], height: float) -> dict[int, list[Floats]]:
    """Shapes of film and band by the number of their colour.

    Parameters
    ----------
    state : State
        The state.
    limits : (float, float)
        Pressure ratios of the first and the last colour.
    height : float
        Height of the band at its largest excess pressure over the drawn radius of the journal.
    """
    (low, high), ratio, theta = limits, state.pressure_ratio, state.theta
    surface = state.journal(theta)
    points = state.stretch.points
    film = points(surface, theta), points(surface + state.array("film_thickness"), theta)
    most = max(abs(high - 1.0), abs(low - 1.0))
    band = _band(state, ratio, theta, height / most)
    middles = 0.5 * (ratio[:, 1:] + ratio[:, :-1])
    colours = np.clip(((middles - low) / (high - low) * len(VIRIDIS)).astype(int), 0, len(VIRIDIS) - 1)
    shapes: dict[int, list[Floats]] = {}
    for strip, colour, start, stop in _runs(colours):
        for inner, outer in (film, band):
            piece = slice(start, stop + 2)
            shapes.setdefault(colour, []).append(np.concatenate([inner[strip, piece], outer[strip, piece][::-1]]))
    return shapes


def _runs(colours: npt.NDArray[np.int_]) -> Iterator[tuple[int, int, int, int]]:
    """Strip, colour, first and last cell of each run of cells of one colour."""
    for strip, row in enumerate(colours):
        edges = np.flatnonzero(np.diff(row)) + 1
        for start, stop in zip([0, *edges], [*edges, len(row)], strict=True):
            yield strip, int(row[start]), int(start), int(stop) - 1


def _band(state: State, ratio: Floats, theta: Floats, height: float) -> tuple[Floats, Floats]:
    """Base line (ambient pressure) and top of the band; suction goes outside the base line.

    `height` is that of an excess pressure of one ambient pressure over the drawn radius of the journal.
    """
    excess = ratio - 1.0
    drawn = state.stretch.radius(state.journal(theta))
    height *= float(state.stretch.radius(np.array(state.scalar("journal_radius"))))
    base = drawn - height * max(-float(excess.min()), 0.0)
    direction = np.stack([np.cos(theta), np.sin(theta)], axis=-1)
    return base[..., None] * direction, (base - height * excess)[..., None] * direction


def _colour_bar(low: float, high: float) -> TraceData:
    scale = [[step / (len(VIRIDIS) - 1), colour] for step, colour in enumerate(VIRIDIS)]
    bar = {"title": {"text": "p/p<sub>a</sub>"}, "thickness": 12, "len": 0.6, "x": 1.0, "tickformat": ".3~g"}
    marker = {"colorscale": scale, "cmin": low, "cmax": high, "color": [low], "showscale": True, "size": 0}
    hidden = {"type": "scatter", "mode": "markers", "x": [None], "y": [None], "hoverinfo": "skip", "showlegend": False}
    return hidden | {"marker": marker | {"colorbar": bar}}


def _roots(state: State, theme: Theme) -> Iterator[TraceData]:
    if "radius" not in state.found.arrays or "root_angle" not in state.found.arrays:
        return
    theta = state.array("root_angle")
    x, y = (state.stretch.bushing * np.stack([np.cos(theta), np.sin(theta)])).tolist()
    marker = {"size": 7, "symbol": "square", "color": theme.ink}
    look = {"type": "scatter", "mode": "markers", "marker": marker, "hoverinfo": "name"}
    yield {**look, "name": "root of a petal", "x": x, "y": y}


def _contacts(state: State) -> Iterator[TraceData]:
    for name, (label, colour) in CONTACTS.items():
        if name not in state.found.arrays:
            continue
        touched = state.array(name) > TOUCHING * state.scalar("ambient_pressure")
        if not touched.any():
            continue
        at_journal = name == "journal_contact_pressure"
        angle = state.array("phi_exposed" if at_journal else "phi")
        theta = (state.array("root_angle")[:, None] + angle)[touched]
        outer = None if at_journal else state.array("radius")[touched] + 0.5 * state.scalar("petal_thickness")
        x, y = state.stretch.points(state.journal(theta) if outer is None else outer, theta).T
        marker = {"size": 6, "color": colour, "line": {"width": 0.5, "color": "#ffffff"}}
        yield {
            "type": "scatter", "mode": "markers", "name": label, "marker": marker, "hoverinfo": "name",
            "x": x.tolist(), "y": y.tolist(),
        }  # fmt: skip


def _arrows(state: State, theme: Theme) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
    """Displacement (to the scale of the drawing) and force on the journal: words, colour, arrow.

    The arrow of the displacement is broad, so that a force along it does not hide it.
    """
    e = state.stretch.scale * state.vector("eccentricity")
    force = state.vector("force")
    size = float(np.hypot(*force))
    if np.hypot(*e) > 0.01 * state.stretch.bore:
        yield "displacement of the journal", theme.faint, _arrow(np.zeros(2), e, theme.faint, 5.0)
    if size > NO_FORCE * state.scalar("ambient_pressure") * state.stretch.bore**2:
        drawn = float(state.stretch.radius(np.array(state.scalar("journal_radius"))))
        yield "force on it", theme.accent, _arrow(e, e + 0.42 * drawn * force / size, theme.accent, 2.0)


def _named(words: str, colour: str, width: float = 3) -> TraceData:
    """An entry of the legend for an arrow or for the pressure band, which have none of their own."""
    look = {"line": {"color": colour, "width": width}, "hoverinfo": "skip"}
    return {"type": "scatter", "mode": "lines", "x": [None], "y": [None], "name": words, **look}


def _rotation(state: State, theme: Theme) -> Iterator[Mapping[str, Any]]:
    if state.scalar("speed") > 0.0:
        x, y = state.stretch.scale * state.vector("eccentricity")
        spot = {"xref": "x", "yref": "y", "showarrow": False, "font": {"size": 20, "color": theme.ink}}
        yield {"x": float(x), "y": float(y - 0.14 * state.stretch.bore), "text": "↺ ω", **spot}


def _arrow(tail: Floats, tip: Floats, colour: str, width: float) -> dict[str, Any]:
    head = {"showarrow": True, "arrowhead": 2, "arrowsize": 1.2 if width < 3.0 else 0.6}
    base = {"xref": "x", "yref": "y", "axref": "x", "ayref": "y", **head}
    places = {"x": float(tip[0]), "y": float(tip[1]), "ax": float(tail[0]), "ay": float(tail[1])}
    return base | places | {"arrowcolor": colour, "arrowwidth": width, "text": ""}


def _angles(bore: float, theme: Theme) -> Iterator[dict[str, Any]]:
    for degrees in (0, 90, 180, 270):
        angle, rim = math.radians(degrees), 1.13 * bore
        place = {"x": rim * math.cos(angle), "y": rim * math.sin(angle), "text": f"{degrees}°"}
        yield place | {"showarrow": False, "font": {"size": 11, "color": theme.faint}}


def note_at_foot(text: str, theme: Theme) -> dict[str, Any]:
    """A small text at the lower left."""
    place = {"xref": "paper", "yref": "paper", "x": 0.0, "y": 0.0, "xanchor": "left", "yanchor": "bottom"}
    return place | {"text": text, "showarrow": False, "font": {"size": 11, "color": theme.faint}}
