"""The best design within limits: objectives, limits, the designs that were tried; a point opens its case."""

from __future__ import annotations

from typing import Any

import numpy as np
from nicegui import ui

from petalfoil.studio.charts import label_of, optimum_axes, optimum_chart, titled
from petalfoil.studio.page_session import OPTIMUM, Session
from petalfoil.studio.parameter_choice import NOTHING, USUAL, ParameterChoice, as_typed
from petalfoil.studio.protocol import Searched
from petalfoil.studio.study_panel import StudyPanel

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


class OptimumPanel(StudyPanel[Searched]):
    """Parameters with their ranges, objectives, limits, run, designs.

    Parameters
    ----------
    session : Session
        Whose case is varied.
    """

    def __init__(self, session: Session) -> None:
        super().__init__(session, OPTIMUM)
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
        self._below("Run search", "flag", "One objective gives the best design, two give their front.")

    def run(self) -> None:
        """Search."""
        vary = {path: text for one in self._parameters for path, text in one.given.items()}
        goals: dict[str, Any] = {
            name: [] if field.value == NOTHING else [str(field.value)] for name, field in self._objectives.items()
        }
        limits = str(self._limits.value or "").split(",")
        goals["subject"] = [limit.strip() for limit in limits if limit.strip()]
        self._session.search(vary, goals, str(self._budget.value or ""))

    def _found(self) -> Searched | None:
        return self._session.optimum

    def _summary(self, found: Searched) -> str:
        best = int(found.on_front.sum())
        return (
            f"{len(found.feasible)} designs in {found.seconds:.2g} s, {found.ended}; "
            f"{best} {'is' if best == 1 else 'are'} best. A click opens a design."
        )

    def _fill(self, found: Searched) -> None:
        self._draw(found).props["aria-label"] = "designs that were tried"
        for line in best_designs(found):
            ui.label(line).classes("grid-note")

    def _figure(self, found: Searched) -> Any:
        return optimum_chart(found, self._theme)

    def _place(self, found: Searched, point: dict[str, Any]) -> dict[str, Any]:
        """The design that is nearest to the point."""
        off = [
            (np.asarray(values) - float(point[axis])) / (float(np.nanmax(np.abs(values))) or 1.0)
            for axis, (_, values) in zip("xy", optimum_axes(found), strict=True)
        ]
        number = int(np.nanargmin(np.hypot(*off)))
        return {
            path: as_typed(self._session.design, path, values[number], found.units[path])
            for path, values in found.parameters.items()
        }


def best_designs(found: Searched, most: int = 6) -> list[str]:
    """The best designs in words."""
    lines = []
    for number in np.flatnonzero(found.on_front)[:most]:
        parts = []
        for objective in found.objectives:
            name = objective.partition(" ")[2]
            shown = label_of(name)
            parts.append(f"{shown.label} {found.results[name][number] * shown.factor:.4g} {shown.unit}".strip())
        lines.append(f"design {number + 1}: " + ", ".join(parts))
    return lines
