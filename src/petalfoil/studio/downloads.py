"""What leaves the page as a file: the case, the lines of Python, data, tables, figures, a report."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable
from typing import Any

from nicegui import ui

from petalfoil.studio.page_session import Session
from petalfoil.studio.protocol import FoundAnswer, Work
from petalfoil.studio.state import ShownResult
from petalfoil.text import for_terminal

MADE = {
    "NetCDF, all data": (Work.NETCDF, "application/x-netcdf"),
    "Figure, PNG": (Work.PNG, "image/png"),
    "Figure, SVG": (Work.SVG, "image/svg+xml"),
    "Report, one HTML page": (Work.REPORT, "text/html"),
}
"""Files that a worker makes, by the text of the menu."""


def quiet_button(text: str, icon: str, on_click: Callable[[], Any] | None = None, name: str = "") -> ui.button:
    """A button without a box; one without text has a name for screen readers."""
    button = ui.button(text, icon=icon, on_click=on_click, color=None).props("unelevated dense no-caps")
    button.props["aria-label"] = name or text
    return button.classes("quiet")


def csv_of(found: FoundAnswer) -> str:
    """The tables of a result as CSV, a blank line between two."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    for number, table in enumerate(found.tables):
        if number:
            writer.writerow([])
        if table.title:
            writer.writerow([table.title])
        if table.columns:
            writer.writerow([column.words for column in table.columns])
        writer.writerows(harmless(line) for line in table.lines)
    return text.getvalue()


def harmless(line: tuple[str, ...]) -> list[str]:
    """Cells that no spreadsheet takes for a formula; numbers stay numbers."""
    return [f"'{cell}" if cell[:1] in ("=", "@", "\t") else for_terminal(cell) for cell in line]


def file_name(session: Session, suffix: str) -> str:
    """A name for a download from the title of the case: letters, digits and hyphens."""
    title = str(session.design.tables.get("title", ""))
    plain = re.sub(r"[^A-Za-z0-9]+", "-", title).strip("-").lower()[:40]
    return f"{plain or 'bearing'}.{suffix}"


def download_menu(session: Session, shown: Callable[[], ShownResult | None], *, with_case: bool) -> None:
    """A button with a menu of files of a result.

    Parameters
    ----------
    session : Session
        Whose result it is.
    shown : callable
        The result; None where there is none yet.
    with_case : bool
        Whether the menu also has the case.
    """
    with quiet_button("Save", "download"), ui.menu():
        if with_case:
            ui.menu_item("Case, TOML", lambda: save_case(session))
        ui.menu_item("Table, CSV", lambda: _save_csv(session, shown()))
        for text, (work, kind) in MADE.items():
            ui.menu_item(text, lambda work=work, kind=kind: _save_made(session, shown(), work, kind))
        ui.menu_item("Lines of Python", lambda: show_python(session, shown()))


def save_case(session: Session) -> None:
    """Download the case as it is typed."""
    ui.download.content(session.design.to_toml(), file_name(session, "toml"), "application/toml")


def show_python(session: Session, shown: ShownResult | None) -> None:
    """Show the lines of Python that ask the same."""
    verb = "solve" if shown is None else shown.found.verb
    text = session.design.python(verb, {} if shown is None else shown.arguments)
    with ui.dialog(value=True) as dialog, ui.card().classes("python"):
        ui.label("The same from Python").classes("heading")
        ui.textarea(value=text).props('readonly autogrow outlined input-class="code" aria-label="lines of Python"')
        quiet_button("Close", "close", dialog.close)
    dialog.on("hide", dialog.delete)


def _save_csv(session: Session, shown: ShownResult | None) -> None:
    if shown is None:
        ui.notify("there is no result yet")
        return
    ui.download.content(csv_of(shown.found), file_name(session, "csv"), "text/csv")


async def _save_made(session: Session, shown: ShownResult | None, work: Work, kind: str) -> None:
    """Let a worker make a file, and download it."""
    if shown is None:
        ui.notify("there is no result yet")
        return
    content = await session.file(work, shown)
    if isinstance(content, str):
        ui.notify(content, type="negative")
    else:
        ui.download.content(content, file_name(session, work.value), kind)
