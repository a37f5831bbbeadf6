"""A panel that runs a study of many designs and draws what it found; a point of the drawing opens its case."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

from nicegui import events, ui

from petalfoil.studio.page_session import Session
from petalfoil.studio.themes import DARK, LIGHT, Theme

Found = TypeVar("Found")


class StudyPanel(ABC, Generic[Found]):
    """Run, refusal, answer; what is asked for stands above them.

    Parameters
    ----------
    session : Session
        Whose case is varied.
    kind : str
        Kind of the study among the session's failures.
    """

    def __init__(self, session: Session, kind: str) -> None:
        self._session = session
        self._kind = kind
        self._built_for: Found | None = None
        self._drawn: Any = None

    def _below(self, run: str, icon: str, note: str) -> None:
        """Build what stands below the questions, and show what the session has found."""
        with ui.row().classes("run"):
            ui.button(run, icon=icon, on_click=self.run).props("no-caps unelevated")
            self._note = ui.label(note).classes("grid-note")
        self._failure = ui.label().classes("refusal").props("role=alert")
        self._answer = ui.element("div").classes("answer")
        self.show()

    def show(self) -> None:
        """Show the answer, or why there is none."""
        failure = self._session.failures.get(self._kind, "")
        self._failure.set_text(failure)
        self._failure.set_visibility(bool(failure))
        found = self._found()
        if found is None or found is self._built_for:
            return
        self._built_for = found
        self._note.set_text(self._summary(found))
        self._answer.clear()
        with self._answer:
            self._fill(found)

    def redraw(self) -> None:
        """Draw the answer in the colours of the page."""
        if self._built_for is not None and self._drawn is not None:
            self._drawn.update_figure(self._figure(self._built_for))

    def _draw(self, found: Found) -> Any:
        """The drawing, whose points open their cases."""
        self._drawn = ui.plotly(self._figure(found)).classes("chart")
        self._drawn.on("plotly_click", self._clicked)
        return self._drawn

    def _clicked(self, event: events.GenericEventArguments) -> None:
        """Open the case of the point that was clicked."""
        if self._built_for is not None and event.args.get("points"):
            self._session.open_place(self._place(self._built_for, event.args["points"][0]))

    @property
    def _theme(self) -> Theme:
        return DARK if self._session.is_dark else LIGHT

    @abstractmethod
    def run(self) -> None:
        """Begin the study."""

    @abstractmethod
    def _found(self) -> Found | None:
        """What the session has found; None before."""

    @abstractmethod
    def _summary(self, found: Found) -> str:
        """What was found, in a line."""

    @abstractmethod
    def _fill(self, found: Found) -> None:
        """Build the answer."""

    @abstractmethod
    def _figure(self, found: Found) -> Any:
        """The drawing's figure."""

    @abstractmethod
    def _place(self, found: Found, point: dict[str, Any]) -> dict[str, Any]:
        """Values of the parameters at a point of the drawing, as they are typed."""
