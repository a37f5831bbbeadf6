"""The choice of a parameter of the case and its values, for studies; and the key that a value of a study stands for."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from petalfoil.studio.design import Design
from petalfoil.studio.form import Control, FormEntry, sections, sliders_of
from petalfoil.units import format_quantity

NOTHING = "none"
"""What is chosen where a parameter may be left out."""
USUAL = "petals.thickness"
"""The parameter that is proposed first."""
LEVELS = 7
"""Values of a parameter that are proposed for a map."""
NEAR = 0.15
"""How far the proposed values lie from that of the case, over it."""


class ParameterChoice:
    """A parameter of the case, and its values.

    Parameters
    ----------
    design : callable
        The present design.
    label : str
        What stands above the choice.
    first : str
        Path that is chosen first, where the case has it.
    is_range : bool
        Whether two ends are proposed instead of a list.
    """

    def __init__(self, design: Any, label: str, first: str, *, is_range: bool) -> None:
        self._design, self._is_range = design, is_range
        paths = [NOTHING, *entries(design())]
        self._path = ui.select(paths, value=first if first in paths else NOTHING, label=label)
        self._path.props("dense options-dense stack-label")
        kind = "range" if is_range else "values"
        self._values = ui.input(f"{kind} {label}", value=self._proposed(self._path.value)).props("dense stack-label")
        self._values.props["aria-label"] = f"{kind} {label}"
        self._path.on_value_change(lambda event: self._values.set_value(self._proposed(event.value)))

    @property
    def given(self) -> dict[str, str]:
        """Values by path, as typed; empty where no parameter is chosen."""
        return {} if self._path.value == NOTHING else {str(self._path.value): str(self._values.value or "")}

    def _proposed(self, path: str) -> str:
        """Values around that of the case."""
        entry = entries(self._design()).get(path)
        if entry is None:
            return ""
        (slider,) = sliders_of(entry, entry.text(self._design().get(path)))
        if entry.control is Control.COUNT:
            middle = int(slider.value)
            near = range(max(int(slider.low), middle - 2), min(int(slider.high), middle + 2) + 1)
            return ", ".join(map(str, near))
        low, high = sorted(((1.0 - NEAR) * slider.value, (1.0 + NEAR) * slider.value))
        ends = (slider.text(max(low, slider.low)), slider.text(min(high, slider.high)))
        return f"{ends[0]} : {ends[1]}" + ("" if self._is_range else f" : {LEVELS}")


def entries(design: Design) -> dict[str, FormEntry]:
    """Keys that can vary, by path: numbers that the case gives."""
    every = (entry for section in sections() for entry in section.entries)
    numbers = {entry.path: entry for entry in every if entry.control in (Control.QUANTITY, Control.COUNT)}
    return {path: one for path, one in numbers.items() if sliders_of(one, one.text(design.get(path)))}


def as_typed(design: Design, path: str, value: float, unit: str) -> Any:
    """What a value of a study [unit] is in a case: a text with a unit, or a number."""
    if entries(design)[path].control is Control.COUNT:
        return int(value)
    return value if unit == "1" else format_quantity(value, unit, digits=12)
