"""Charts of the browser other than section and motion: film over angle, the 3-D view, series, maps.

Each is a plain mapping in the form of Plotly, made from the arrays of a result. Only the 3-D view uses WebGL.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from petalfoil.results.schema import SCALARS, VARIABLES
from petalfoil.results.summary import label_alone, shown_as
from petalfoil.results.variable import TableLabel
from petalfoil.studio.motion_chart import motion_chart
from petalfoil.studio.protocol import FoundAnswer, Mapped, Searched
from petalfoil.studio.section_chart import VIRIDIS, Chart, Floats, State, TraceData, note_at_foot
from petalfoil.studio.themes import Theme
from petalfoil.units import format_quantity


def empty(theme: Theme, words: str) -> Chart:
    """A chart that says what is missing."""
    note = {"xref": "paper", "yref": "paper", "x": 0.5, "y": 0.5, "showarrow": False, "text": words}
    hidden = {"visible": False}
    layout = theme.layout(xaxis=hidden, yaxis=hidden, annotations=[note | {"font": {"size": 14, "color": theme.faint}}])
    return {"data": [], "layout": layout, "config": theme.config("empty")}


# ---------------------------------------------------------------------------------------------- film over angle


def film_chart(found: FoundAnswer, pinned: FoundAnswer | None, theme: Theme) -> Chart:
    """Pressure and film thickness over the bushing angle, the pinned design behind them."""
    traces: list[TraceData] = []
    if pinned is not None:
        look = {"line": {"color": theme.ghost, "width": 1.5, "dash": "dot"}, "name": "A"}
        traces += _over_angle(State.of(pinned), (look, look))
    now = ({"line": {"color": theme.accent, "width": 2}}, {"line": {"color": theme.second, "width": 2}})
    traces += _over_angle(State.of(found), ({**now[0], "name": "now"}, {**now[1], "name": "now"}))
    where = "bushing angle at the mid-plane [°]" if "space_pressure" in found.arrays else "bushing angle [°]"
    angle = theme.axis(where, range=[0, 360], dtick=45, anchor="y2")
    layout = theme.layout(
        xaxis=angle,
        yaxis=theme.axis("p/p<sub>a</sub>", domain=[0.55, 1.0]),
        yaxis2=theme.axis("film thickness [µm]", domain=[0.0, 0.45], rangemode="tozero", anchor="x"),
        showlegend=False,
        uirevision="film",
    )
    return {"data": traces, "layout": layout, "config": theme.config("film")}


def _over_angle(state: State, looks: tuple[dict[str, Any], dict[str, Any]]) -> list[TraceData]:
    degrees, order = _round_the_circle(state.theta)
    lines = ((state.pressure_ratio, "y", looks[0]), (1e6 * state.array("film_thickness"), "y2", looks[1]))
    return [
        {
            "type": "scatter", "mode": "lines", "x": degrees, "y": _gapped(values, order, 5), "yaxis": axis,
            "hovertemplate": "%{x:.1f}°: %{y:.4g}", **look,
        }
        for values, axis, look in lines
    ]  # fmt: skip


NodeOrder = list[tuple[int, int] | None]


def _round_the_circle(theta: Floats) -> tuple[list[float | None], NodeOrder]:
    """Angles of all strips in 0 to 360 degrees with a gap after each strip and at a full turn, and their nodes."""
    degrees: list[float | None] = []
    order: NodeOrder = []
    for petal, strip in enumerate(np.degrees(theta)):
        turns = np.floor(strip / 360.0 + 1e-12)
        for node, angle in enumerate(strip):
            if node and turns[node] != turns[node - 1]:
                degrees.append(None)
                order.append(None)
            degrees.append(round(float(angle - 360.0 * turns[node]), 3))
            order.append((petal, node))
        degrees.append(None)
        order.append(None)
    return degrees, order


def _gapped(values: Floats, order: NodeOrder, digits: int) -> list[float | None]:
    return [None if place is None else float(f"{values[place]:.{digits}g}") for place in order]


# ---------------------------------------------------------------------------------------------- in 3-D


def space_chart(found: FoundAnswer, theme: Theme) -> Chart:
    """The strips of the petals in 3-D, coloured by the pressure of the film on them."""
    state = State.of(found)
    if "space_pressure" in found.arrays:
        theta = state.array("root_angle")[:, None] + state.array("space_phi")
        z, pressure, film = state.array("z"), state.array("space_pressure"), state.array("space_film_thickness")
    else:  # a 2-D film is the same over the length
        theta, z = state.theta, np.array([0.0, state.scalar("length")])
        pressure, film = (np.repeat(state.array(name)[..., None], 2, axis=2) for name in ("pressure", "film_thickness"))
    ratio = pressure / state.scalar("ambient_pressure")
    radius = state.stretch.radius(state.journal(theta)[..., None] + film)
    colours = {"cmin": min(float(ratio.min()), 1.0), "cmax": max(float(ratio.max()), 1.001), "colorscale": _scale()}
    traces = []
    for strip, angle in enumerate(theta):
        places = [radius[strip] * np.cos(angle)[:, None], radius[strip] * np.sin(angle)[:, None]]
        x, y, along = (_short(1e3 * values) for values in (*places, np.broadcast_to(z, radius[strip].shape)))
        bar = {"title": {"text": "p/p<sub>a</sub>"}, "thickness": 12, "len": 0.6}
        surface = {"type": "surface", "x": along, "y": x, "z": y, "surfacecolor": _short(ratio[strip]), **colours}
        traces.append({**surface, "showscale": strip == 0, "colorbar": bar, "hoverinfo": "skip"})
    quiet = {"showbackground": False, "color": theme.ink, "gridcolor": theme.grid}
    axes = {
        f"{name}axis": {"title": {"text": text}, **quiet}
        for name, text in zip("xyz", ("z [mm]", "x", "y"), strict=True)
    }
    scene = axes | {"aspectmode": "data", "camera": {"eye": {"x": 1.9, "y": 1.3, "z": 1.05}}}
    note = note_at_foot(f"radial clearance drawn ×{state.stretch.scale:g}", theme)
    layout = theme.layout(scene=scene, uirevision="space", margin={"l": 0, "r": 0, "t": 0, "b": 0}, annotations=[note])
    return {"data": traces, "layout": layout, "config": theme.config("space")}


def _scale() -> list[list[float | str]]:
    return [[step / (len(VIRIDIS) - 1), colour] for step, colour in enumerate(VIRIDIS)]


def _short(values: Floats) -> list[list[float]]:
    """Values with as many digits as a picture shows."""
    return [[float(f"{value:.5g}") for value in row] for row in values]


# ---------------------------------------------------------------------------------------------- series


def label_of(name: str) -> TableLabel:
    """Label, unit and factor of a result or an array of the schema."""
    if name in SCALARS:
        return replace(shown_as(name), label=label_alone(name))
    variable = VARIABLES[name]
    lengths = {"m": ("µm", 1e6), "s": ("ms", 1e3), "rad s-1": ("rpm", 30.0 / math.pi)}
    unit, factor = lengths.get(variable.units, (variable.units.removeprefix("1"), 1.0))
    return TableLabel(name.replace("_", " "), unit, factor)


def titled(name: str) -> str:
    """A label with its unit."""
    shown = label_of(name)
    return f"{shown.label} [{shown.unit}]" if shown.unit else shown.label


def axes_of(found: FoundAnswer) -> list[str]:
    """Arrays of a result that can be drawn against each other."""
    if not found.is_series:
        return []
    return [name for name in found.arrays if name != "leg"]


def is_drawn(found: FoundAnswer) -> bool:
    """Whether a series or a table over frequency has more than one point to draw."""
    over = found.arrays.get("whirl_frequency", next(iter(found.arrays.values()), np.empty(0)))
    return len(over) > 1


def line_chart(found: FoundAnswer, names: tuple[str, str], theme: Theme) -> Chart:
    """One result of a series against another; each leg is a line of its own."""
    x, y = names
    across, along = label_of(x), label_of(y)
    legs = found.arrays.get("leg", np.full(len(found.arrays[x]), ""))
    traces = []
    for number, leg in enumerate(dict.fromkeys(legs.tolist())):
        chosen = legs == leg
        colour = (theme.accent, theme.second, theme.ghost)[number % 3]
        line = {"type": "scatter", "mode": "lines+markers", "name": leg or along.label, "line": {"color": colour}}
        values = ((found.arrays[x][chosen] * across.factor), (found.arrays[y][chosen] * along.factor))
        traces.append({**line, "x": _or_gap(values[0]), "y": _or_gap(values[1])})
    layout = theme.layout(
        xaxis=theme.axis(titled(x)), yaxis=theme.axis(titled(y)), showlegend=len(traces) > 1, uirevision=f"{x},{y}"
    )
    return {"data": traces, "layout": layout, "config": theme.config(f"{found.verb}-{y}")}


def _or_gap(values: Iterable[Any]) -> list[float | None]:
    """Numbers; a gap where a point has none."""
    return [float(value) if math.isfinite(value) else None for value in values]


def coefficients_chart(found: FoundAnswer, name: str, theme: Theme) -> Chart:
    """Stiffness or damping over whirl frequency: direct and cross terms."""
    frequency = np.asarray(found.arrays["whirl_frequency"], dtype=np.float64) / (2.0 * math.pi)
    values, letter = np.asarray(found.arrays[name], dtype=np.float64), {"stiffness": "K", "damping": "C"}[name]
    unit = {"stiffness": "N/µm", "damping": "N·s/mm"}[name]
    factor = {"stiffness": 1e-6, "damping": 1e-3}[name]
    colours = (theme.accent, theme.second, theme.ghost, theme.ink)
    traces = [
        {
            "type": "scatter", "mode": "lines+markers", "name": f"{letter}<sub>{'xy'[i]}{'xy'[j]}</sub>",
            "x": _or_gap(frequency), "y": _or_gap(factor * values[:, i, j]), "line": {"color": colours[2 * i + j]},
        }
        for i, j in np.ndindex(2, 2)
    ]  # fmt: skip
    layout = theme.layout(
        xaxis=theme.axis("whirl frequency [Hz]"), yaxis=theme.axis(f"{name} [{unit}]"), uirevision=name
    )
    return {"data": traces, "layout": layout, "config": theme.config(name)}


# ---------------------------------------------------------------------------------------------- maps


def map_chart(found: Mapped, name: str, theme: Theme) -> Chart:
    """A result over one parameter as a line, over two as a contour map; each case is a point."""
    shown = label_of(name)
    values = np.asarray(found.results[name], dtype=np.float64) * shown.factor
    scales = {path: unit_of(places, found.units[path]) for path, places in found.parameters.items()}
    places = [[float(f"{place / scales[path][1]:.9g}") for place in row] for path, row in found.parameters.items()]
    titles = [f"{path} [{scales[path][0]}]" if scales[path][0] else path for path in found.parameters]
    dot = {"type": "scatter", "marker": {"color": theme.ink, "size": 7}, "showlegend": False}
    if len(places) == 1:
        line = {**dot, "mode": "lines+markers", "x": places[0], "y": _or_gap(values), "line": {"color": theme.accent}}
        layout = theme.layout(xaxis=theme.axis(titles[0]), yaxis=theme.axis(titled(name)), uirevision=name)
        return {"data": [line], "layout": layout, "config": theme.config("map")}
    bar = {"title": {"text": titled(name), "side": "right"}, "thickness": 14}
    rows = [_or_gap(row) for row in values.T]
    contour = {"type": "contour", "x": places[0], "y": places[1], "z": rows, "colorscale": _scale(), "colorbar": bar}
    x, y = (grid.ravel().tolist() for grid in np.meshgrid(*places, indexing="ij"))
    cases = {**dot, "mode": "markers", "x": x, "y": y, "hovertemplate": "%{x}, %{y}<extra>open</extra>"}
    layout = theme.layout(xaxis=theme.axis(titles[0]), yaxis=theme.axis(titles[1]), uirevision=name)
    return {"data": [contour | {"hoverinfo": "z"}, cases], "layout": layout, "config": theme.config("map")}


def optimum_axes(found: Searched) -> list[tuple[str, Floats]]:
    """What designs are drawn over and of, and its values as shown: the first two objectives, or one over the design."""
    names = [objective.partition(" ")[2] for objective in found.objectives]
    axes = [(titled(name), np.asarray(found.results[name], dtype=np.float64) * label_of(name).factor) for name in names]
    return axes[:2] if len(axes) > 1 else [("design", np.arange(1.0, len(axes[0][1]) + 1.0)), *axes]


def optimum_chart(found: Searched, theme: Theme) -> Chart:
    """Designs of a search: those that miss a limit, those that keep all, and the best ones, a front where they are."""
    (across, x), (up, y) = optimum_axes(found)
    best, kept = found.on_front, found.feasible & ~found.on_front
    order = np.flatnonzero(best)[np.argsort(x[best])]
    missed, line = np.flatnonzero(~found.feasible), {"color": theme.second, "width": 1}
    looks: list[tuple[str, Any, str, dict[str, Any]]] = [
        ("misses a limit", missed, "markers", {"symbol": "x", "color": theme.ghost, "size": 7}),
        ("keeps every limit", np.flatnonzero(kept), "markers", {"color": theme.accent, "size": 7}),
        ("best", order, "lines+markers", {"color": theme.second, "size": 10}),
    ]
    traces = [
        {
            "type": "scatter", "mode": mode, "name": name, "marker": marker, "line": line,
            "x": _or_gap(x[chosen]), "y": _or_gap(y[chosen]), "text": [f"design {number + 1}" for number in chosen],
            "hovertemplate": "%{text}: %{x:.4g}, %{y:.4g}<extra>open</extra>",
        }
        for name, chosen, mode, marker in looks if len(chosen)
    ]  # fmt: skip
    layout = theme.layout(xaxis=theme.axis(across), yaxis=theme.axis(up), uirevision="optimum", showlegend=True)
    return {"data": traces, "layout": layout, "config": theme.config("optimum")}


def unit_of(values: Sequence[float], unit: str) -> tuple[str, float]:
    """A unit in which the largest of some values is read easily, and its size in the SI unit."""
    largest = max(map(abs, values), default=0.0)
    if unit in ("1", "") or largest == 0.0:
        return ("" if unit == "1" else unit), 1.0
    number, _, words = format_quantity(largest, unit, digits=12).partition(" ")
    if not words:  # degrees are written without a space
        return "°", math.pi / 180.0
    return words, largest / float(number)


def chart_of(found: FoundAnswer, axes: Sequence[str], theme: Theme) -> Chart:
    """The chart that suits a result.

    Parameters
    ----------
    found : FoundAnswer
        Result of any analysis.
    axes : sequence of str
        Results that a series is drawn over and of, or which coefficients are drawn; empty for a choice of its own.
    theme : Theme
        Colours.
    """
    if "time" in found.arrays and "x" in found.arrays:
        return motion_chart(found, theme)
    if "whirl_frequency" in found.arrays and "stiffness" in found.arrays:
        return coefficients_chart(found, next(iter(axes), "stiffness"), theme)
    names = axes_of(found)
    if len(names) > 1:
        x, y = axes if len(axes) == 2 and set(axes) <= set(names) else usual_axes(names)
        return line_chart(found, (x, y), theme)
    return empty(theme, "this result is a table")


def usual_axes(names: Sequence[str]) -> tuple[str, str]:
    """What a series is drawn over and of: what was varied, and the result that is asked about most."""
    varied = ("eccentricity_y", "eccentricity_x", "speed", "load_y", "load_x")
    asked = ("liftoff_speed", "threshold_speed", "critical_mass", "bearing_force", "min_film_thickness")
    x = next((name for name in varied if name in names), names[0])
    y = next((name for name in asked if name in names and name != x), next(name for name in names if name != x))
    return x, y
