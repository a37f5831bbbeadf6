"""A map of designs: a result over one or two parameters of the case; a point opens its case."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import ui

from petalfoil.studio.charts import map_chart, titled, unit_of
from petalfoil.studio.page_session import MAP, Session
from petalfoil.studio.parameter_choice import NOTHING, USUAL, ParameterChoice, as_typed
from petalfoil.studio.protocol import Mapped
from petalfoil.studio.study_panel import StudyPanel

FIRST = "min_film_thickness"
"""Result that is drawn first."""


class MapPanel(StudyPanel[Mapped]):
    """Parameters, run, map.

    Parameters
    ----------
    session : Session
        Whose case is varied.
    """

    def __init__(self, session: Session) -> None:
        super().__init__(session, MAP)
        self._result = FIRST
        with ui.element("div").classes("arguments"):
            choices = (("over", USUAL), ("and", NOTHING))
            self._parameters = [
                ParameterChoice(lambda: session.design, label, first, is_range=False) for label, first in choices
            ]
        self._below("Run map", "grid_on", "A click on a point opens its case.")

    def run(self) -> None:
        """Compute the map."""
        self._session.study({path: text for one in self._parameters for path, text in one.given.items()})

    def _found(self) -> Mapped | None:
        return self._session.map

    def _summary(self, found: Mapped) -> str:
        return f"{found.seconds:.2g} s, {found.missing} cases without an answer. A click opens a case."

    def _fill(self, found: Mapped) -> None:
        names = sorted(found.results)
        if self._result not in names:
            self._result = names[0]
        with ui.row().classes("axes"):
            choice = ui.select({name: titled(name) for name in names}, value=self._result, label="draw")
            choice.props("dense").on_value_change(lambda event: self._choose(event.value))
        self._draw(found)

    def _figure(self, found: Mapped) -> Any:
        return map_chart(found, self._result, self._theme)

    def _choose(self, name: str) -> None:
        self._result = name
        self.redraw()

    def _place(self, found: Mapped, point: dict[str, Any]) -> dict[str, Any]:
        """The case that is nearest to the point."""
        place = {}
        for (path, values), axis in zip(found.parameters.items(), "xy", strict=False):
            unit = found.units[path]
            wanted = float(point[axis]) * unit_of(values, unit)[1]
            value = values[int(np.abs(np.array(values) - wanted).argmin())]
            place[path] = as_typed(self._session.design, path, value, unit)
        return place
