"""A motion as a chart of the browser: the cross-section that moves, the path of the journal, histories over time.

The pictures of the section are those that `orbit` keeps of the last turns. All of them are sent at once as frames of
Plotly, so that the browser plays them without asking the server; each has the same traces in the same order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from petalfoil.plot.stretch import Stretch, round_scale
from petalfoil.studio.protocol import FoundAnswer
from petalfoil.studio.section_chart import (
    BAND,
    CIRCLE,
    VIRIDIS,
    Chart,
    Floats,
    State,
    TraceData,
    film_shapes,
    joined,
    petal_outlines,
    polygon,
    ring,
)
from petalfoil.studio.themes import Theme

PLAY = 80
"""Time that a picture is shown [ms]."""
PATH_FRAMES = 90
"""Places of the journal that are played where a motion has no pictures of its section."""
DENT = 0.4
"""Largest displacement over the journal's radius, both as drawn: beyond one half its outline would be dented."""
TOUCHING = 1e-6
"""Film above the contact film thickness, over it, up to which the journal counts as in contact."""
PICTURES = ("pressure", "film_thickness", "radius")
"""Fields of a picture, which a motion holds along `frame` as ``frame_pressure`` and so on."""
SECTION, ASIDE = [0.0, 0.46], [0.58, 1.0]
"""Places of the section, and of path and histories beside it, over the width of the chart."""


def motion_chart(found: FoundAnswer, theme: Theme) -> Chart:
    """The motion of a journal, with its section where the motion holds pictures of it."""
    arrays = {name: np.asarray(values, dtype=np.float64) for name, values in found.arrays.items() if name != "leg"}
    moving = _Moving.of(found, arrays)
    lines = [*_path(arrays, theme), *_histories(arrays, theme)]
    played = [*moving.traces(0, theme), *_now(arrays, float(moving.times[0]), theme)]
    first = len(lines) + (1 if moving.has_section else 0)
    numbers = list(range(first, first + len(played)))
    frames = [
        {
            "name": f"{1e3 * time:.4g}",
            "data": [places_of(one) for one in (*moving.traces(number, theme), *_now(arrays, float(time), theme))],
            "traces": numbers,
        }
        for number, time in enumerate(moving.times)
    ]
    still = [polygon(ring(moving.stretch.bushing), xaxis="x4", yaxis="y4", fillcolor=theme.bushing)]
    data = [*(still if moving.has_section else []), *lines, *played]
    layout = _layout(moving, theme)
    return {"data": data, "layout": layout, "frames": frames, "config": theme.config("orbit")}


class _Moving:
    """The pictures of a motion.

    Attributes
    ----------
    times : (picture,) array
        When they were taken [s].
    stretch : Stretch
        The radial map, the same in all of them.
    has_section : bool
        Whether the motion holds pictures of the section.
    """

    def __init__(self, found: FoundAnswer, arrays: dict[str, Floats], times: Floats, stretch: Stretch) -> None:
        self.times, self.stretch = times, stretch
        self._found, self._arrays = found, arrays
        self.has_section = "frame_pressure" in arrays
        if self.has_section:
            ratio = arrays["frame_pressure"] / float(found.scalars["ambient_pressure"])
            self._range = min(float(ratio.min()), 1.0), max(float(ratio.max()), 1.001)

    @classmethod
    def of(cls, found: FoundAnswer, arrays: dict[str, Floats]) -> _Moving:
        """The pictures of a result of `orbit`; of one without pictures the places along the last half of its path."""
        bore, journal = (float(found.scalars[f"{name}_radius"]) for name in ("bushing", "journal"))
        if "frame_pressure" not in arrays:
            time = arrays["time"]
            chosen = np.unique(np.linspace(0.5 * len(time), len(time) - 1, PATH_FRAMES).astype(int))
            return cls(found, arrays, time[chosen], Stretch(bore, 1.0))
        moved = float(np.hypot(arrays["frame_x"], arrays["frame_y"]).max())
        most = DENT * bore / (moved + DENT * (bore - journal))
        return cls(found, arrays, arrays["frame"], Stretch(bore, min(round_scale(bore, journal), most)))

    def traces(self, number: int, theme: Theme) -> Iterator[TraceData]:
        """What moves in the section: journal, petals, film in each colour, contacts, a mark on the shaft."""
        if not self.has_section:
            return
        state = self._state(number)
        place: dict[str, Any] = {"xaxis": "x4", "yaxis": "y4"}
        outline = {"line": {"width": 1, "color": theme.ink}, **place}
        surface = self.stretch.points(state.journal(CIRCLE[::3]), CIRCLE[::3])
        yield polygon(surface, fillcolor=theme.journal, **outline)
        petals = petal_outlines(state) if "radius" in state.found.arrays else []
        for side in (0, 1):
            look = {"fillcolor": theme.petals[side], "line": {"width": 0.6, "color": theme.ink}}
            yield joined(petals[side::2], **look, **place)
        shapes = film_shapes(state, self._range, BAND)
        for step, colour in enumerate(VIRIDIS):
            look = {"fillcolor": colour, "line": {"width": 0.4, "color": colour}}
            yield joined(shapes.get(step, []), **look, **place)
        yield self._contacts(state) | place

    def _state(self, number: int) -> State:
        """The picture as a state of its own."""
        names = ("root_angle", "phi_exposed", "phi")
        arrays = {name: self._arrays[name] for name in names if name in self._arrays}
        arrays |= {name: self._arrays[f"frame_{name}"][number] for name in PICTURES if f"frame_{name}" in self._arrays}
        at = {f"eccentricity_{axis}": float(self._arrays[f"frame_{axis}"][number]) for axis in "xy"}
        return State(replace(self._found, arrays=dict(arrays), scalars={**self._found.scalars, **at}), self.stretch)

    def _contacts(self, state: State) -> TraceData:
        touched = state.array("film_thickness") <= state.scalar("contact_film_thickness") * (1.0 + TOUCHING)
        x, y = self.stretch.points(state.journal(state.theta[touched]), state.theta[touched]).T
        marker = {"size": 6, "color": "#D55E00", "line": {"width": 0.5, "color": "#ffffff"}}
        shown = {"type": "scatter", "mode": "markers", "name": "journal in contact", "marker": marker}
        return {**shown, "hoverinfo": "name", "x": x.tolist(), "y": y.tolist()}


def places_of(trace: TraceData) -> TraceData:
    """What of a trace changes from picture to picture."""
    return {"x": trace["x"], "y": trace["y"]}


def _path(arrays: dict[str, Floats], theme: Theme) -> Iterator[TraceData]:
    x, y = (_short(1e6 * arrays[axis]) for axis in "xy")
    line = {"color": theme.accent, "width": 1}
    yield {"type": "scatter", "mode": "lines", "x": x, "y": y, "line": line, "hoverinfo": "skip"}


def _histories(arrays: dict[str, Floats], theme: Theme) -> Iterator[TraceData]:
    time = _short(1e3 * arrays["time"])
    shown = ((1e6 * arrays["min_film_thickness"], "y2", theme.accent, "minimum film thickness [µm]"),
             (100.0 * arrays["contact_fraction"], "y3", theme.second, "contact fraction [%]"))  # fmt: skip
    for values, axis, colour, name in shown:
        yield {
            "type": "scatter", "mode": "lines", "x": time, "y": _short(values), "xaxis": "x2", "yaxis": axis,
            "line": {"color": colour, "width": 1.5}, "name": name,
        }  # fmt: skip


def _now(arrays: dict[str, Floats], time: float, theme: Theme) -> Iterator[TraceData]:
    """The journal on its path, and the instant in the histories."""
    x, y = (1e6 * float(np.interp(time, arrays["time"], arrays[axis])) for axis in "xy")
    marker = {"size": 11, "color": theme.second, "line": {"width": 1, "color": theme.ink}}
    yield {"type": "scatter", "mode": "markers", "x": [x], "y": [y], "marker": marker, "hoverinfo": "skip"}
    films = 1e6 * arrays["min_film_thickness"]
    yield {
        "type": "scatter", "mode": "lines", "x": [1e3 * time] * 2, "y": [0.0, float(films.max())], "xaxis": "x2",
        "yaxis": "y2", "line": {"color": theme.ink, "width": 1, "dash": "dot"}, "hoverinfo": "skip",
    }  # fmt: skip


def _layout(moving: _Moving, theme: Theme) -> dict[str, Any]:
    """Section on the left, path above the histories on the right; without a section path and histories."""
    beside = {"path": ASIDE, "histories": ASIDE, "rows": ([0.54, 1.0], [0.25, 0.42], [0.0, 0.17])}
    alone = {"path": [0.0, 0.42], "histories": ASIDE, "rows": ([0.0, 1.0], [0.55, 1.0], [0.0, 0.45])}
    places = beside if moving.has_section else alone
    of_path, of_film, of_contact = places["rows"]
    axes: dict[str, Any] = {
        "xaxis": theme.axis("x [µm]", domain=places["path"], anchor="y"),
        "yaxis": theme.axis("y [µm]", domain=of_path, scaleanchor="x", anchor="x"),
        "xaxis2": theme.axis("time [ms]", domain=places["histories"], anchor="y3"),
        "yaxis2": theme.axis("film [µm]", domain=of_film, anchor="x2", rangemode="tozero"),
        "yaxis3": theme.axis("contact [%]", domain=of_contact, anchor="x2", rangemode="tozero"),
    }
    notes = []
    if moving.has_section:
        reach = 1.1 * moving.stretch.bushing
        hidden = {"visible": False, "range": [-reach, reach]}
        axes |= {
            "xaxis4": hidden | {"domain": SECTION, "anchor": "y4"},
            "yaxis4": hidden | {"domain": [0.0, 1.0], "scaleanchor": "x4", "anchor": "x4"},
        }
        text = f"radial clearance drawn ×{moving.stretch.scale:.3g}; the last turns"
        place = {"xref": "paper", "yref": "paper", "x": 0.0, "y": 0.0, "xanchor": "left", "yanchor": "top"}
        notes.append(place | {"text": text, "showarrow": False, "font": {"size": 11, "color": theme.faint}})
    return theme.layout(
        **axes, showlegend=False, updatemenus=[_buttons(theme)], sliders=[_slider(moving, theme)], annotations=notes,
        uirevision="motion", margin={"l": 12, "r": 12, "t": 40, "b": 90},
    )  # fmt: skip


def _buttons(theme: Theme) -> dict[str, Any]:
    """Buttons that play the pictures and stop them."""
    timing = {"frame": {"duration": PLAY, "redraw": False}, "transition": {"duration": 0}, "fromcurrent": True}
    play = {"label": "▶ animate", "method": "animate", "args": [None, timing]}
    stop = {"label": "■ stop", "method": "animate", "args": [[None], timing | {"mode": "immediate"}]}
    place = {"type": "buttons", "direction": "right", "x": 0.0, "y": 1.0, "xanchor": "left", "yanchor": "bottom"}
    look = {"showactive": False, "font": {"color": theme.ink}, "bgcolor": theme.bushing}
    return place | look | {"buttons": [play, stop]}


def _slider(moving: _Moving, theme: Theme) -> dict[str, Any]:
    """A slider over the pictures, by their time."""
    timing = {"frame": {"duration": 0, "redraw": False}, "transition": {"duration": 0}, "mode": "immediate"}
    names = [f"{1e3 * time:.4g}" for time in moving.times]
    steps = [{"label": name, "method": "animate", "args": [[name], timing]} for name in names]
    shown = {"prefix": "t = ", "suffix": " ms", "font": {"size": 12, "color": theme.ink}, "xanchor": "left"}
    look = {
        "bgcolor": theme.bushing,
        "bordercolor": theme.faint,
        "tickcolor": theme.faint,
        "font": {"size": 1, "color": "rgba(0,0,0,0)"},
    }
    return {"steps": steps, "currentvalue": shown, "pad": {"t": 44}, "ticklen": 0, "minorticklen": 0, **look}


def _short(values: Floats) -> list[float | None]:
    """Numbers with as many digits as a picture shows; a gap where there is none."""
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]
