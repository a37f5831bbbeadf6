"""The page: header, case, pictures, results, questions, history; it follows its session."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from nicegui import events, ui

from petalfoil.case import Case
from petalfoil.errors import DefinitionError
from petalfoil.results.summary import cell
from petalfoil.studio.case_panel import CasePanel
from petalfoil.studio.charts import empty, film_chart, space_chart
from petalfoil.studio.design import MOST_BYTES, Design
from petalfoil.studio.downloads import download_menu, quiet_button
from petalfoil.studio.look import STYLE
from petalfoil.studio.map_panel import MapPanel
from petalfoil.studio.optimum_panel import OptimumPanel
from petalfoil.studio.page_session import Session
from petalfoil.studio.questions import Questions
from petalfoil.studio.results_panel import ResultsPanel
from petalfoil.studio.section_chart import has_section, section_chart
from petalfoil.studio.state import Aspect, Tried
from petalfoil.studio.themes import DARK, LIGHT, Theme
from petalfoil.text import for_terminal

HISTORY = ("bearing_force", "min_film_thickness", "peak_pressure", "contact_fraction", "friction_torque")
"""Results that the list of tried designs shows."""

PAST = ("History", "Map", "Optimum", "Log")
"""Tabs below: what was tried, studies, and the log."""


class Page:
    """The page of a session in one tab of a browser.

    Parameters
    ----------
    session : Session
        What it shows.
    is_wide : bool
        Whether the case has its place beside the pictures from the start.
    """

    def __init__(self, session: Session, *, is_wide: bool) -> None:
        self.session = session
        self._is_wide = is_wide
        self._space: Any = None
        self._showers: dict[Aspect, Callable[[], None]] = {}

    async def build(self) -> None:
        """Build the page part by part; in between others are served."""
        self._dark = ui.dark_mode(self.session.is_dark)
        ui.add_css(STYLE)
        ui.colors(primary="#0072B2", negative="#B3261E", warning="#8A5A00")
        self._build_header()
        self._drawer = ui.left_drawer(value=self._is_wide).props("width=340 breakpoint=900 bordered").classes("drawer")
        board = ui.element("main").classes("board")
        parts = {
            "pictures of the bearing": ("pictures", self._build_pictures),
            "results": ("numbers", self._build_numbers),
            "questions": ("questions", self._build_questions),
            "history": ("past", self._build_past),
        }
        with self._drawer:
            self._build_case()
        for name, (kind, build) in parts.items():
            await asyncio.sleep(0.0)
            with board, ui.element("section").classes(kind).props(f'aria-label="{name}"'):
                build()
        self._showers = {
            Aspect.DESIGN: self._rebuild_case,
            Aspect.PROBLEMS: self._case_panel_problems,
            Aspect.STATE: self._show_state,
            Aspect.STATUS: self._show_status,
            Aspect.ANSWERS: self._show_answers,
            Aspect.TRIED: self._show_tried,
            Aspect.LOG: self._show_log,
        }
        for shower in (self._show_state, self._show_status, self._show_tried, self._show_log):
            shower()

    def changed(self, aspect: Aspect) -> None:
        """Follow the session."""
        with self._drawer.client:
            self._showers[aspect]()

    # ------------------------------------------------------------------------------------------ building

    def _build_header(self) -> None:
        with ui.header(elevated=False).classes("top"):
            quiet_button("", "menu", lambda: self._drawer.toggle(), "case")
            ui.label("petalfoil studio").classes("brand")
            self._title = ui.label().classes("title")
            self._grid = ui.label().classes("grid-of-case")
            ui.element("div").classes("spring")
            self._words = ui.label().classes("status").props("aria-live=polite")
            self._progress = ui.linear_progress(0.0, show_value=False).classes("progress")
            self._progress.props["aria-label"] = "progress"
            self._cancel = quiet_button("Cancel", "stop", self.session.cancel)
            self._upload = ui.upload(on_upload=self._uploaded, on_rejected=self._rejected, max_file_size=MOST_BYTES)
            self._upload.props('auto-upload accept=".toml"').classes("hidden")
            quiet_button("Open", "folder_open", lambda: self._upload.run_method("pickFiles"))
            download_menu(self.session, lambda: self.session.state, with_case=True)
            quiet_button("", "contrast", self._toggle_dark, "light or dark")
        self._failure = ui.label().classes("failure").props("role=alert")

    def _build_case(self) -> None:
        ui.label("Case").classes("heading")
        self._case_column = ui.element("div").classes("case")
        self._rebuild_case()

    def _build_pictures(self) -> None:
        with ui.row().classes("bar"):
            self._view = ui.toggle({"section": "Cross-section", "space": "3-D"}, value="section")
            self._view.props("dense no-caps unelevated").on_value_change(self._show_state)
            self._pin = quiet_button("Pin as A", "push_pin", self.session.pin)
        self._section_place = ui.element("div").classes("chart section-chart")
        with self._section_place:
            self._section = ui.plotly(empty(self._theme(), "computing …")).classes("fill")
        self._section.props["aria-label"] = "cross-section of the bearing"
        self._space_place = ui.element("div").classes("chart section-chart")
        self._film = ui.plotly(empty(self._theme(), "")).classes("chart film-chart")
        self._film.props["aria-label"] = "pressure and film thickness over the bushing angle"

    def _build_numbers(self) -> None:
        ui.label("Results").classes("heading")
        self._results = ResultsPanel(self.session)

    def _build_questions(self) -> None:
        ui.label("Questions").classes("heading")
        self._questions = Questions(self.session)

    def _build_past(self) -> None:
        with ui.tabs().props("dense no-caps align=left") as tabs:
            for name in PAST:
                ui.tab(name)
        panels = {name: ui.element("div") for name in PAST}

        def show(chosen: str) -> None:
            for name, panel in panels.items():
                panel.set_visibility(name == chosen)

        tabs.on_value_change(lambda event: show(str(event.value)))
        tabs.set_value("History")
        with panels["History"]:
            self._build_history()
        with panels["Map"]:
            self._map = MapPanel(self.session)
        with panels["Optimum"]:
            self._optimum = OptimumPanel(self.session)
        with panels["Log"]:
            self._log = ui.element("div").classes("log").props("role=log")

    def _build_history(self) -> None:
        self._tried = ui.table(columns=_history_columns(), rows=[], row_key="number").classes("results history")
        self._tried.props("dense hide-pagination").props["rows-per-page-options"] = [0]
        self._tried.on(
            "rowClick", lambda event: self.session.go_back(int(event.args[1]["number"])), [[], ["number"], None]
        )
        ui.label("A click opens the design again.").classes("grid-note")

    def _show_answers(self) -> None:
        self._questions.show()
        self._map.show()
        self._optimum.show()

    # ------------------------------------------------------------------------------------------ following

    def _theme(self) -> Theme:
        return DARK if self.session.is_dark else LIGHT

    def _rebuild_case(self) -> None:
        case = self.session.case()  # what is wrong is told to the panel that is still there
        self._case_column.clear()
        with self._case_column:
            self._case_panel = CasePanel(self.session, Case if case is None else type(case), self._rebuild_case)

    def _case_panel_problems(self) -> None:
        self._case_panel.show_problems()

    def _show_state(self, _: Any = None) -> None:
        """Draw the present state, and its numbers."""
        shown, pinned, theme = self.session.state, self.session.pinned, self._theme()
        self._results.show()
        self._grid.set_text("" if shown is None else shown.found.grid)
        self._pin.set_text("Unpin A" if shown and pinned and pinned.toml == shown.toml else "Pin as A")
        is_space = self._view.value == "space"
        self._section_place.set_visibility(not is_space)
        self._space_place.set_visibility(is_space)
        if not is_space and self._space is not None:
            self._space.delete()
            self._space = None
        if shown is None or not has_section(shown.found):
            return
        if is_space:
            self._show_space(theme)
        else:
            self._section.update_figure(section_chart(shown.found, theme))
        ghost = pinned.found if pinned is not None and has_section(pinned.found) else None
        self._film.update_figure(film_chart(shown.found, ghost, theme))

    def _show_space(self, theme: Theme) -> None:
        """The 3-D view, which alone needs WebGL, is there while it is looked at."""
        if self.session.state is None:
            return
        chart = space_chart(self.session.state.found, theme)
        if self._space is None:
            with self._space_place:
                self._space = ui.plotly(chart).classes("fill")
        else:
            self._space.update_figure(chart)

    def _show_status(self) -> None:
        status, title = self.session.status, str(self.session.design.tables.get("title", ""))
        self._title.set_text(for_terminal(title)[:120])
        self._words.set_text(status.words)
        is_running = status.part is not None
        self._progress.set_visibility(is_running)
        self._cancel.set_visibility(is_running)
        self._progress.set_value(status.part or 0.0)
        self._failure.set_text(status.failure)
        self._failure.set_visibility(bool(status.failure))
        self._questions.show()

    def _show_tried(self) -> None:
        self._tried.rows = [_history_row(tried) for tried in reversed(self.session.tried)]
        self._tried.update()

    def _show_log(self) -> None:
        self._log.clear()
        with self._log:
            for line in reversed(self.session.log):
                ui.label(line)

    # ------------------------------------------------------------------------------------------ doing

    def _toggle_dark(self) -> None:
        self.session.is_dark = not self.session.is_dark
        self._dark.set_value(self.session.is_dark)
        self._show_state()
        self._questions.redraw()
        self._map.redraw()
        self._optimum.redraw()

    async def _uploaded(self, event: events.UploadEventArguments) -> None:
        """Open a case that was uploaded; what is no case is refused."""
        read = await event.file.read()
        size = len(read)
        self._upload.reset()
        try:
            if size > MOST_BYTES:
                raise DefinitionError(f"the file has {size:,} bytes; a case has up to {MOST_BYTES:,}")
            self.session.open(Design.from_toml(read.decode("utf-8-sig")), "opened a file")
        except UnicodeDecodeError:
            ui.notify("the file is no text in UTF-8", type="negative")
        except DefinitionError as error:
            ui.notify(f"the file is refused: {error}", type="negative", multi_line=True)

    def _rejected(self) -> None:
        ui.notify(f"a case is a TOML file of up to {MOST_BYTES // 1024} kB", type="negative")


def _history_columns() -> list[dict[str, Any]]:
    names = [(name, cell(name, 0.0)) for name in HISTORY]
    shown = [(name, f"{one.label} [{one.unit}]" if one.unit else one.label, "right") for name, one in names]
    ends = [("number", "#", "right"), ("change", "change", "left")]
    return [
        {"name": n, "field": n, "label": text, "align": side}
        for n, text, side in (*ends, *shown, ("grid", "grid", "left"))
    ]


def _history_row(tried: Tried) -> dict[str, Any]:
    values = {name: cell(name, tried.scalars[name]).value for name in HISTORY if name in tried.scalars}
    return {"number": tried.number, "change": for_terminal(tried.change)[:80], "grid": tried.grid, **values}
