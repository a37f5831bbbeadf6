"""A map of designs: a result over one or two parameters of the case; a point opens its case."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import events, ui

from petalfoil.studio.charts import map_chart, titled, unit_of
from petalfoil.studio.form import Control, Entry, sections, sliders_of
from petalfoil.studio.protocol import Mapped
from petalfoil.studio.session import MAP, Session
from petalfoil.studio.themes import DARK, LIGHT
from petalfoil.units import format_quantity

NOTHING = "none"
"""The second parameter of a line."""
LEVELS = 7
"""Values of a parameter that are proposed."""
NEAR = 0.15
"""How far the proposed values lie from that of the case, over it."""
FIRST = "min_film_thickness"
"""Result that is drawn first."""


class MapPanel:
    """Parameters, run, map.

    Parameters
    ----------
    session : Session
        Whose case is varied.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._built_for: Mapped | None = None
        self._drawn: Any = None
        self._result = FIRST
        paths = list(self._entries())
        with ui.element("div").classes("arguments"):
            self._parameters = [self._parameter("over", paths, paths[0] if paths else NOTHING)]
            self._parameters.append(self._parameter("and", [NOTHING, *paths], NOTHING))
        with ui.row().classes("run"):
            ui.button("Run map", icon="grid_on", on_click=self.run).props("no-caps unelevated")
            self._note = ui.label("A click on a point opens its case.").classes("grid-note")
        self._failure = ui.label().classes("refusal").props("role=alert")
        self._answer = ui.element("div").classes("answer")
        self.show()

    def run(self) -> None:
        """Compute the map."""
        chosen = [(path.value, values.value) for path, values in self._parameters if path.value != NOTHING]
        self._session.study({path: str(text) for path, text in chosen})

    def show(self) -> None:
        """Show the map, or why there is none."""
        failure = self._session.failures.get(MAP, "")
        self._failure.set_text(failure)
        self._failure.set_visibility(bool(failure))
        found = self._session.map
        if found is None or found is self._built_for:
            return
        self._built_for = found
        self._note.set_text(f"{found.seconds:.2g} s, {found.missing} cases without an answer. A click opens a case.")
        names = sorted(found.results)
        if self._result not in names:
            self._result = names[0]
        self._answer.clear()
        with self._answer:
            with ui.row().classes("axes"):
                choice = ui.select({name: titled(name) for name in names}, value=self._result, label="draw")
                choice.props("dense").on_value_change(lambda event: self._choose(event.value))
            self._drawn = ui.plotly(map_chart(found, self._result, self._theme())).classes("chart")
            self._drawn.on("plotly_click", self._clicked)

    def redraw(self) -> None:
        """Draw the map in the colours of the page."""
        if self._built_for is not None and self._drawn is not None:
            self._drawn.update_figure(map_chart(self._built_for, self._result, self._theme()))

    def _theme(self) -> Any:
        return DARK if self._session.is_dark else LIGHT

    def _choose(self, name: str) -> None:
        self._result = name
        self.redraw()

    def _clicked(self, event: events.GenericEventArguments) -> None:
        """Open the case that is nearest to the point that was clicked."""
        if self._built_for is None or not event.args.get("points"):
            return
        point, place = event.args["points"][0], {}
        for (path, values), axis in zip(self._built_for.parameters.items(), "xy", strict=False):
            unit = self._built_for.units[path]
            wanted = float(point[axis]) * unit_of(values, unit)[1]
            value = values[int(np.abs(np.array(values) - wanted).argmin())]
            is_count = self._entries()[path].control is Control.COUNT
            place[path] = int(value) if is_count else format_quantity(value, unit, digits=12) if unit != "1" else value
        self._session.open_place(place)

    def _entries(self) -> dict[str, Entry]:
        """Keys that can vary: numbers that the case gives."""
        entries = (entry for section in sections() for entry in section.entries)
        numbers = (Control.QUANTITY, Control.COUNT)
        given = {entry.path: entry for entry in entries if entry.control in numbers}
        design = self._session.design
        return {path: one for path, one in given.items() if sliders_of(one, one.text(design.get(path)))}

    def _parameter(self, label: str, paths: list[str], first: str) -> tuple[Any, Any]:
        """The choice of a parameter, and its values."""
        usual = "petals.thickness"
        chosen = ui.select(paths, value=usual if label == "over" and usual in paths else first, label=label)
        chosen.props("dense options-dense stack-label")
        values = ui.input(f"values {label}", value=self._proposed(chosen.value)).props("dense stack-label")
        values.props["aria-label"] = f"values {label}"
        chosen.on_value_change(lambda event: values.set_value(self._proposed(event.value)))
        return chosen, values

    def _proposed(self, path: str) -> str:
        """Values around that of the case."""
        entry = self._entries().get(path)
        if entry is None:
            return ""
        (slider,) = sliders_of(entry, entry.text(self._session.design.get(path)))
        if entry.control is Control.COUNT:
            middle = int(slider.value)
            near = range(max(int(slider.low), middle - 2), min(int(slider.high), middle + 2) + 1)
            return ", ".join(map(str, near))
        low, high = sorted(((1.0 - NEAR) * slider.value, (1.0 + NEAR) * slider.value))
        ends = (slider.text(max(low, slider.low)), slider.text(min(high, slider.high)))
        return f"{ends[0]} : {ends[1]} : {LEVELS}"
