"""The case on the page: a control for each key, generated from the definitions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from petalfoil.case import Case
from petalfoil.studio.form import Control, FormEntry, FormSection, Slider, sections, sliders_of
from petalfoil.studio.page_session import Session

THROTTLE = 0.08
"""Time between two values of a slider that moves [s]."""
NOT_GIVEN = "not given"
"""What stands in the control of a key that the case leaves out and that has no value of its own then."""
OPEN_AT_FIRST = ("petals", "operation")
"""Tables that are unfolded when the page opens."""


class KeyControl:
    """The control of one key.

    Parameters
    ----------
    entry : FormEntry
        The key.
    session : Session
        Whose case it is a part of.
    """

    def __init__(self, entry: FormEntry, session: Session) -> None:
        self.entry, self._session = entry, session
        self._field: Any = None
        self._sliders: Any = None
        with ui.element("div").classes("key"):
            self._build()

    def refuse(self, words: str) -> None:
        """Show beside the control why its value is refused; an empty text clears it."""
        if self.entry.control is Control.FLAG:
            return
        self._field.error = words or None

    def _build(self) -> None:
        entry, value = self.entry, self._session.design.get(self.entry.path)
        tip = f"{entry.path}: {entry.allowed or entry.meaning or 'see docs/notation.md'}"
        if entry.control is Control.FLAG:
            self._field = ui.switch(entry.label, value=bool(entry.default if value is None else value))
            self._field.on_value_change(lambda event: self._give(event.value)).tooltip(tip)
        elif entry.control is Control.CHOICE:
            self._field = ui.select(list(entry.choices), label=entry.label, value=self._word(value))
            self._field.props("dense options-dense stack-label").on_value_change(
                lambda event: self._give(event.value)
            ).tooltip(tip)
        elif entry.control is Control.ROWS:
            rows = "none" if value is None else f"{len(value)} rows"
            self._field = ui.input("measured free shape", value=rows).props("dense readonly").tooltip(tip)
        else:
            self._build_text(value, tip)
        self._mark(value)

    def _build_text(self, value: Any, tip: str) -> None:
        entry = self.entry
        self._field = ui.input(entry.label, value=entry.text(value)).props("dense stack-label debounce=0")
        self._field.props["aria-label"] = f"{entry.path} {entry.label}"
        if entry.default is not None:
            self._field.props["placeholder"] = entry.text(entry.default)
        elif not entry.is_required:
            self._field.props["placeholder"] = NOT_GIVEN
        self._field.tooltip(tip)
        self._field.on("keydown.enter", self._typed).on("blur", self._typed)
        self._sliders = ui.element("div").classes("sliders")
        self._build_sliders()

    def _build_sliders(self) -> None:
        self._sliders.clear()
        with self._sliders:
            made = sliders_of(self.entry, self._text())
            for number, slider in enumerate(made):
                name = f"{self.entry.path} {'xy'[number]}" if len(made) > 1 else self.entry.path
                self._build_slider(slider, number, name)

    def _build_slider(self, slider: Slider, number: int, name: str) -> None:
        shown = ui.slider(min=slider.low, max=slider.high, step=slider.step, value=slider.value)
        shown.props["aria-label"] = f"slide {name}"
        shown.props("dense").on(
            "update:model-value",
            lambda event: self._slid(slider, number, event.args),
            throttle=THROTTLE,
        )

    def _slid(self, slider: Slider, number: int, value: Any) -> None:
        """A slider moved: its text stands in the field, and the case follows."""
        if not isinstance(value, int | float):
            return
        text = slider.text(float(value))
        if self.entry.control is Control.PAIR:
            parts = [part.strip() for part in self._text().split(",")]
            if len(parts) != 2:
                return
            parts[number] = text
            text = ", ".join(parts)
        self._field.value = text
        self._give(self.entry.given(text))

    def _typed(self) -> None:
        """A text was typed: the case follows, and the slider is made for it."""
        value = self.entry.given(str(self._field.value or ""))
        if value != self._session.design.get(self.entry.path):
            self._give(value)
            self._build_sliders()

    def _text(self) -> str:
        """The text of the field, or of the default where it is empty."""
        return str(self._field.value or "") or self.entry.text(self.entry.default)

    def _word(self, value: Any) -> str | None:
        word = self.entry.default if value is None else value
        return word if word in self.entry.choices else None

    def _give(self, value: Any) -> None:
        self._session.change(self.entry.path, value)
        self._mark(value)

    def _mark(self, value: Any) -> None:
        """Mark what is assumed: a default that the case does not state."""
        assumed = value is None and not self.entry.is_required
        self._field.classes(add="assumed") if assumed else self._field.classes(remove="assumed")
        if self.entry.control is Control.CHOICE:  # a choice has no placeholder
            if self._word(value) is None:
                self._field.props["display-value"] = NOT_GIVEN
            else:
                self._field.props.pop("display-value", None)
            self._field.update()


class CasePanel:
    """All keys by tables.

    Parameters
    ----------
    session : Session
        Whose case is edited.
    model : type of Case
        Whose keys are shown: with the table of a registered wall where the design has one.
    on_toggle : callable
        Called when a table was added or taken away.
    """

    def __init__(self, session: Session, model: type[Case], on_toggle: Callable[[], None]) -> None:
        self._session, self._on_toggle = session, on_toggle
        self._controls: dict[str, KeyControl] = {}
        self._folds: dict[str, ui.expansion] = {}
        self._general = ui.label().classes("refusal").props("role=alert")
        for section in sections(model):
            self._build(section)
        self.show_problems()

    def show_problems(self) -> None:
        """Show each problem beside its control, whose table is unfolded, and what belongs to none above all."""
        problems = self._session.problems
        for name in {path.rpartition(".")[0] for path in problems} & self._folds.keys():
            self._folds[name].set_value(True)
        for path, control in self._controls.items():
            control.refuse(problems.get(path, ""))
        others = [f"{key}: {text}" if key else text for key, text in problems.items() if key not in self._controls]
        self._general.set_text("; ".join(others))
        self._general.set_visibility(bool(others))

    def _build(self, section: FormSection) -> None:
        """A table that is folded is built when it is opened: most pages never need it."""
        is_there = not section.name or section.name in self._session.design.tables or not section.is_optional
        opened = section.name in OPEN_AT_FIRST and is_there
        fold = self._folds[section.name] = ui.expansion(section.name or "case", value=opened)
        with fold.classes("table-of-case"):
            fold.props["caption"] = _short(section.title) if section.name else ""
            fold.props("dense switch-toggle-side")
            place = ui.element("div")
        if opened:
            self._fill(section, place, is_there=is_there)
        else:
            fold.on_value_change(lambda event: self._unfold(section, place, is_there=is_there) if event.value else None)

    def _unfold(self, section: FormSection, place: ui.element, *, is_there: bool) -> None:
        if not place.default_slot.children:
            self._fill(section, place, is_there=is_there)
            self.show_problems()

    def _fill(self, section: FormSection, place: ui.element, *, is_there: bool) -> None:
        with place:
            if section.is_optional:
                switch = ui.switch(f"with {section.name}", value=is_there)
                switch.on_value_change(lambda event: self._toggle(section.name, bool(event.value)))
            if is_there:
                for entry in section.entries:
                    self._controls[entry.path] = KeyControl(entry, self._session)

    def _toggle(self, name: str, wanted: bool) -> None:
        """Add an empty table, whose missing keys are then asked for, or take one away."""
        self._session.change(name, {} if wanted else None)
        self._on_toggle()


def _short(title: str) -> str:
    """A title without what stands behind a colon, a semicolon or in brackets."""
    return title.partition(":")[0].partition(";")[0].partition(" (")[0]
