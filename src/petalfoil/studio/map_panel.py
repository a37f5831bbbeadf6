"""A map of designs: a result over one or two parameters of the case; a point opens its case."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import events, ui

from petalfoil.studio.charts import map_chart, titled, unit_of
from petalfoil.studio.parameter_choice import NOTHING, USUAL, ParameterChoice, as_typed
from petalfoil.studio.protocol import Mapped
from petalfoil.studio.session import MAP, Session
from petalfoil.studio.themes import DARK, LIGHT

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
        with ui.element("div").classes("arguments"):
            choices = (("over", USUAL), ("and", NOTHING))
            self._parameters = [
                ParameterChoice(lambda: session.design, label, first, is_range=False) for label, first in choices
            ]
        with ui.row().classes("run"):
            ui.button("Run map", icon="grid_on", on_click=self.run).props("no-caps unelevated")
            self._note = ui.label("A click on a point opens its case.").classes("grid-note")
        self._failure = ui.label().classes("refusal").props("role=alert")
        self._answer = ui.element("div").classes("answer")
        self.show()

    def run(self) -> None:
        """Compute the map."""
        self._session.study({path: text for one in self._parameters for path, text in one.given.items()})

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
            place[path] = as_typed(self._session.design, path, value, unit)
        self._session.open_place(place)
