"""The best design within limits: objectives, limits, the designs that were tried; a point opens its case."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import events, ui

from petalfoil.studio.charts import label_of, optimum_axes, optimum_chart, titled
from petalfoil.studio.parameter_choice import NOTHING, USUAL, ParameterChoice, as_typed
from petalfoil.studio.protocol import Searched
from petalfoil.studio.session import OPTIMUM, Session
from petalfoil.studio.themes import DARK, LIGHT, Theme

DESIGNS = 40
"""Budget of designs that is proposed: seconds to a minute in 2-D."""
OBJECTIVES = (
    "min_film_thickness",
    "bearing_force",
    "peak_pressure",
    "contact_fraction",
    "friction_torque",
    "power_loss",
    "max_bending_stress",
)
"""Results that can be wanted large or small."""
MAXIMIZED, MINIMIZED = "min_film_thickness", "max_bending_stress"
"""Objectives that are proposed."""
LIMITS = "friction_torque < 30 mN m"
"""An example of a limit."""
SECOND = "petals.arc_length"
"""The second parameter that is proposed."""


class OptimumPanel:
    """Parameters with their ranges, objectives, limits, run, designs.

    Parameters
    ----------
    session : Session
        Whose case is varied.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._built_for: Searched | None = None
        self._drawn: Any = None
        wanted = {NOTHING: NOTHING} | {name: titled(name).partition(" [")[0] for name in OBJECTIVES}
        with ui.element("div").classes("arguments"):
            self._parameters = [
                ParameterChoice(lambda: session.design, label, first, is_range=True)
                for label, first in (("varied", USUAL), ("also varied", SECOND), ("third varied", NOTHING))
            ]
            self._objectives = {
                label: ui.select(wanted, value=first, label=label).props("dense options-dense stack-label")
                for label, first in (("maximize", MAXIMIZED), ("minimize", MINIMIZED))
            }
            self._limits = ui.input("limits").props(f'dense stack-label placeholder="such as {LIMITS}"')
            self._limits.props["aria-label"] = "limits"
            self._budget = ui.input("designs", value=str(DESIGNS)).props("dense stack-label inputmode=numeric")
            self._budget.props["aria-label"] = "designs"
        with ui.row().classes("run"):
            ui.button("Run search", icon="flag", on_click=self.run).props("no-caps unelevated")
            self._note = ui.label("One objective gives the best design, two give their front.").classes("grid-note")
        self._failure = ui.label().classes("refusal").props("role=alert")
        self._answer = ui.element("div").classes("answer")
        self.show()

    def run(self) -> None:
        """Search."""
        vary = {path: text for one in self._parameters for path, text in one.given.items()}
        goals: dict[str, Any] = {
            name: [] if field.value == NOTHING else [str(field.value)] for name, field in self._objectives.items()
        }
        limits = str(self._limits.value or "").split(",")
        goals["subject"] = [limit.strip() for limit in limits if limit.strip()]
        self._session.search(vary, goals, str(self._budget.value or ""))

    def show(self) -> None:
        """Show the designs, or why there are none."""
        failure = self._session.failures.get(OPTIMUM, "")
        self._failure.set_text(failure)
        self._failure.set_visibility(bool(failure))
        found = self._session.optimum
        if found is None or found is self._built_for:
            return
        self._built_for = found
        best = int(found.on_front.sum())
        self._note.set_text(
            f"{len(found.feasible)} designs in {found.seconds:.2g} s, {found.ended}; "
            f"{best} {'is' if best == 1 else 'are'} best. A click opens a design."
        )
        self._answer.clear()
        with self._answer:
            self._drawn = ui.plotly(optimum_chart(found, self._theme())).classes("chart")
            self._drawn.props["aria-label"] = "designs that were tried"
            self._drawn.on("plotly_click", self._clicked)
            for line in best_designs(found):
                ui.label(line).classes("grid-note")

    def redraw(self) -> None:
        """Draw the designs in the colours of the page."""
        if self._built_for is not None and self._drawn is not None:
            self._drawn.update_figure(optimum_chart(self._built_for, self._theme()))

    def _theme(self) -> Theme:
        return DARK if self._session.is_dark else LIGHT

    def _clicked(self, event: events.GenericEventArguments) -> None:
        """Open the design that is nearest to the point that was clicked."""
        found = self._built_for
        if found is None or not event.args.get("points"):
            return
        point = event.args["points"][0]
        axes = optimum_axes(found)
        off = [
            (np.asarray(values) - float(point[axis])) / (float(np.nanmax(np.abs(values))) or 1.0)
            for axis, (_, values) in zip("xy", axes, strict=True)
        ]
        number = int(np.nanargmin(np.hypot(*off)))
        design = self._session.design
        self._session.open_place(
            {
                path: as_typed(design, path, values[number], found.units[path])
                for path, values in found.parameters.items()
            }
        )


def best_designs(found: Searched, most: int = 6) -> list[str]:
    """The best designs in words."""
    lines = []
    for number in np.flatnonzero(found.on_front)[:most]:
        parts = []
        for objective in found.objectives:
            name = objective.partition(" ")[2]
            shown = label_of(name)
            parts.append(f"{shown.label.strip()} {found.results[name][number] * shown.factor:.4g} {shown.unit}".strip())
        lines.append(f"design {number + 1}: " + ", ".join(parts))
    return lines
