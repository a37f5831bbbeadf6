"""The analyses as tabs, generated from their declarations: arguments, run, chart, table."""

from __future__ import annotations

import inspect
import re
from typing import Any

from nicegui import ui

from petalfoil.analysis import known_verbs
from petalfoil.analysis.arguments import Argument, Flag, StoredResult
from petalfoil.analysis.declaration import Analysis
from petalfoil.results.tables import TextTable
from petalfoil.studio.charts import axes_of, chart_of, is_drawn, titled, usual_axes
from petalfoil.studio.downloads import download_menu
from petalfoil.studio.form import label_of_argument, with_labels
from petalfoil.studio.page_session import Session
from petalfoil.studio.protocol import FoundAnswer
from petalfoil.studio.state import ShownResult
from petalfoil.studio.tasks import found_analysis
from petalfoil.studio.themes import DARK, LIGHT, Theme

EXAMPLES = re.compile(r'"([^"]+)"')
"""Examples in the help text of an argument: the first stands in the field of one that must be given."""


class QuestionPanel:
    """One analysis: its arguments and its answer.

    Parameters
    ----------
    verb : str
        Its name.
    session : Session
        Whose case is asked about.
    """

    def __init__(self, verb: str, session: Session) -> None:
        self.verb, self._session = verb, session
        self._analysis: Analysis = found_analysis(verb)
        self._fields: dict[str, Any] = {}
        self._axes: list[str] = []
        self._drawn: Any = None
        self._built_for: ShownResult | None = None
        ui.label(self._analysis.summary).classes("summary")
        with ui.element("div").classes("arguments"):
            for name, argument in self._analysis.arguments.items():
                if not isinstance(argument, StoredResult):
                    self._fields[name] = self._field(name, argument)
        with ui.row().classes("run"):
            ui.button(f"Run {verb}", icon="play_arrow", on_click=self.run).props("no-caps unelevated")
            download_menu(session, lambda: session.answers.get(verb), with_case=False)
            self._note = ui.label().classes("grid-note").props("aria-live=polite")
        self._failure = ui.label().classes("refusal").props("role=alert")
        self._answer = ui.element("div").classes("answer")
        self.show()

    def run(self) -> None:
        """Ask the question with the arguments as they are typed."""
        given = {name: field.value for name, field in self._fields.items()}
        self._session.ask(self.verb, {name: value for name, value in given.items() if value not in ("", None, False)})

    def show(self) -> None:
        """Show the answer, or why there is none."""
        failure = with_labels(self._session.failures.get(self.verb, ""), self._analysis.arguments)
        self._failure.set_text(failure)
        self._failure.set_visibility(bool(failure))
        shown = self._session.answers.get(self.verb)
        if shown is None:
            return
        is_old = shown.toml != self._session.design.to_toml()
        self._note.set_text("belongs to a former case: run it again" if is_old else f"{shown.found.seconds:.2g} s")
        if shown is not self._built_for:
            self._built_for = shown
            self._build(shown.found)

    def redraw(self) -> None:
        """Draw the chart in the colours of the page."""
        shown = self._session.answers.get(self.verb)
        if shown is not None and self._drawn is not None:
            self._drawn.update_figure(chart_of(shown.found, self._axes, self._theme()))

    def _theme(self) -> Theme:
        return DARK if self._session.is_dark else LIGHT

    def _field(self, name: str, argument: Argument) -> Any:
        default = self._analysis.default(name)
        label, help_text = label_of_argument(name), with_labels(argument.help, self._analysis.arguments)
        if isinstance(argument, Flag):
            return ui.switch(label, value=False).props("dense").tooltip(help_text)
        must = default is inspect.Parameter.empty
        example = EXAMPLES.search(argument.help)
        field = ui.input(label, value=example[1] if example and must else "").props("dense stack-label")
        field.tooltip(help_text)
        hint = f"such as {example[1]}" if example else argument.metavar.lower()
        field.props["placeholder"] = hint if must or default is None else argument.text(default)
        field.props["aria-label"] = f"{self.verb} {label}"
        return field

    def _build(self, found: FoundAnswer) -> None:
        self._answer.clear()
        with self._answer:
            names = ["stiffness", "damping"] if "stiffness" in found.arrays else axes_of(found)
            names = names if is_drawn(found) else []
            self._axes = names[:1] if "stiffness" in found.arrays else list(usual_axes(names)) if len(names) > 1 else []
            self._choices(names)
            if self._axes or "time" in found.arrays:
                kind = "motion-chart" if "frame_pressure" in found.arrays else "line-chart"
                self._drawn = ui.plotly(chart_of(found, self._axes, self._theme())).classes(f"chart {kind}")
                self._drawn.props["aria-label"] = f"chart of {found.verb}"
            for warning in (*found.warnings, *found.failures):
                ui.label(warning).classes("warning")
            for table in found.tables:
                show_table(table)

    def _choices(self, names: list[str]) -> None:
        """What is drawn over what, where there is a choice."""
        if not self._axes:
            return
        with ui.row().classes("axes"):
            for number, name in enumerate(self._axes):
                label = "draw" if number == len(self._axes) - 1 else "over"
                words = {one: one if one in ("stiffness", "damping") else titled(one) for one in names}
                choice = ui.select(words, value=name, label=label).props("dense")
                choice.on_value_change(lambda event, number=number: self._choose(number, event.value))

    def _choose(self, number: int, name: str) -> None:
        self._axes[number] = name
        self.redraw()


def show_table(content: TextTable) -> None:
    """A table of text; its cells are text, whatever they hold."""
    width = max((len(line) for line in content.lines), default=0)
    headings = [column.words for column in content.columns]
    columns: list[dict[str, Any]] = [
        {
            "name": str(k),
            "field": str(k),
            "label": headings[k] if headings else "",
            "align": "left" if k == 0 or (not headings and k == width - 1) else "right",
        }
        for k in range(len(headings) or width)
    ]
    rows = [{"id": number, **dict(zip(map(str, range(width)), line))} for number, line in enumerate(content.lines)]  # noqa: B905 - lines may be short
    if content.title:
        ui.label(content.title).classes("heading")
    table = ui.table(columns=columns, rows=rows, row_key="id").classes("results").props("dense hide-pagination")
    table.props["rows-per-page-options"] = [0]
    if not headings:
        table.props("hide-header").classes("list")


class Questions:
    """All analyses; a tab is built when it is opened for the first time.

    Parameters
    ----------
    session : Session
        Whose case is asked about.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._open: dict[str, QuestionPanel] = {}
        verbs = known_verbs.summaries()
        with ui.tabs().props("dense no-caps inline-label align=left outside-arrows mobile-arrows") as tabs:
            for verb, summary in verbs.items():
                ui.tab(verb).tooltip(summary)
        self._panels = {verb: ui.element("div").classes("question") for verb in verbs}
        tabs.on_value_change(lambda event: self._show(str(event.value)))
        tabs.set_value("curve" if "curve" in verbs else next(iter(verbs)))

    def show(self) -> None:
        """Show new answers."""
        for question in self._open.values():
            question.show()

    def redraw(self) -> None:
        """Draw all charts anew."""
        for question in self._open.values():
            question.redraw()

    def _show(self, verb: str) -> None:
        """Show one analysis; the others are hidden, since a chart must stay in the page to keep its size."""
        for name, panel in self._panels.items():
            panel.set_visibility(name == verb)
        if verb not in self._open:
            with self._panels[verb]:
                self._open[verb] = QuestionPanel(verb, self._session)
