"""The results of the present state beside those of the pinned one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from nicegui import ui

from petalfoil.results.summary import cell, in_order, shown_as, with_bar
from petalfoil.studio.downloads import quiet_button
from petalfoil.studio.page_session import Session
from petalfoil.studio.protocol import FoundAnswer
from petalfoil.studio.state import ShownResult

HIDDEN = {
    "solution_path", "known_equilibria", "factorizations", "iterations", "wall_time", "force_residual",
    "contact_model", "nodal_force_difference",
}  # fmt: skip
"""How the state was computed: shown where it is asked for."""
ANGLES = ("deg",)
"""Units of what differs by an amount, not by a part: an angle has no zero of its own."""
FIGURE = {"classes": "figure"}
COLUMNS = (
    {"name": "label", "label": "result", "field": "label", "align": "left"},
    {"name": "pinned", "label": "A", "field": "pinned", "align": "right", **FIGURE},
    {"name": "now", "label": "now", "field": "now", "align": "right", **FIGURE},
    {"name": "bar", "label": "±", "field": "bar", "align": "right", **FIGURE},
    {"name": "difference", "label": "difference", "field": "difference", "align": "right", **FIGURE},
    {"name": "unit", "label": "", "field": "unit", "align": "left"},
)
LEVELS = '<q-td :props="props" :class="props.row.level">{{ props.value }}</q-td>'
"""A cell whose colour is that of its row; its text is text, whatever it holds."""
JUDGED_ALONE = {"residual"}
"""Results whose difference from A says nothing: both are below their limit or not."""
LEAST_DIFFERENCE = 1e-4
"""Difference over the pinned value that is shown as none."""
LEAST_TURN = 1e-3
"""Difference of two angles that is shown as none [deg]."""


class ResultsPanel:
    """A table of results with warnings below.

    Parameters
    ----------
    session : Session
        Whose results are shown.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._heading = ui.label().classes("grid-note")
        self._table = ui.table(columns=[], rows=[], row_key="name").classes("results").props("dense")
        self._table.props["rows-per-page-options"] = [0]
        self._table.props("hide-pagination")
        self._table.add_slot("body-cell-now", LEVELS)
        self._table.add_slot("body-cell-label", LEVELS)
        self._all = ui.switch("how it was computed", value=False, on_change=self.show).props("dense size=xs")
        self._bars = quiet_button("Error bars", "straighten", session.ask_bars)
        self._bars.tooltip("Solve the case on two more grids; of a 2-D case this happens by itself")
        self._warnings = ui.element("div").classes("warnings").props("aria-live=polite")

    def show(self, _: object = None) -> None:
        """Show the present state."""
        shown, pinned = self._session.state, self._session.pinned
        if shown is None:
            return
        self._heading.set_text(_heading(shown))
        self._bars.set_visibility(not shown.is_coarse and not shown.found.bars)
        self._heading.classes(add="coarse") if shown.is_coarse else self._heading.classes(remove="coarse")
        rows = rows_of(shown.found, None if pinned is None else pinned.found)
        wanted = {
            "pinned": pinned is not None,
            "difference": pinned is not None,
            "bar": any(row["bar"] for row in rows),
        }
        self._table.columns = [dict(column) for column in COLUMNS if wanted.get(column["name"], True)]
        self._table.rows = [row for row in rows if self._all.value or row["name"] not in HIDDEN]
        self._table.update()
        self._warnings.clear()
        with self._warnings:
            for warning in (*shown.found.warnings, *shown.found.failures):
                ui.label(warning).classes("warning")


def _heading(shown: ShownResult) -> str:
    grid = f"{shown.found.grid}, {shown.found.seconds:.2g} s"
    return f"first answer, coarse 2-D: {grid}" if shown.is_coarse else f"{shown.found.verb}: {grid}"


def rows_of(found: FoundAnswer, pinned: FoundAnswer | None) -> list[dict[str, Any]]:
    """Rows of the table: values to the digits of the printed table, error bars, and the difference from A.

    Parameters
    ----------
    found : FoundAnswer
        The present state.
    pinned : FoundAnswer or None
        The pinned one.
    """
    before: Mapping[str, Any] = {} if pinned is None else pinned.scalars
    warned = {warning.partition(":")[0].strip() for warning in found.warnings}
    rows = []
    for name in in_order(found.scalars):
        value, bar = found.scalars[name], ""
        shown = cell(name, value)
        text = shown.value
        if name in found.bars and isinstance(value, float):
            (text,), bar = with_bar(name, [value], found.bars[name])
        rows.append(
            {
                "name": name,
                "label": shown.label,
                "now": text,
                "bar": bar,
                "unit": shown.unit,
                "pinned": cell(name, before[name]).value if name in before else "",
                "difference": "" if name in HIDDEN | JUDGED_ALONE else _difference(name, before, value),
                "level": level_of(name, value, warned),
            }
        )
    return rows


def level_of(name: str, value: object, warned: set[str]) -> str:
    """Colour of a row: failed, warned of, or plain."""
    if name == "status" and not str(value).startswith("converged"):
        return "failed"
    return "warned" if name in warned else ""


def _size(name: str, before: Mapping[str, Any]) -> float:
    """What a difference is measured by: the value of A; of a component, the length of its vector."""
    stem, _, axis = name.rpartition("_")
    pair = [before.get(f"{stem}_{one}") for one in "xy"] if axis in ("x", "y") else [before.get(name)]
    return math.hypot(*(float(value) for value in pair if isinstance(value, float | int)))


def _difference(name: str, pinned: Mapping[str, Any], now: Any) -> str:
    """Difference from A in percent, of an angle in degrees; a word where words differ."""
    before = pinned.get(name)
    if before is None or isinstance(before, bool | str) or isinstance(now, bool | str):
        return "changed" if before is not None and before != now else ""
    if not (math.isfinite(before) and math.isfinite(now)) or before == now:
        return ""
    shown = shown_as(name)
    if shown.unit in ANGLES:
        turned = math.remainder(shown.factor * (now - before), 360.0)
        return "" if abs(turned) < LEAST_TURN else f"{turned:+.3g} {shown.unit}"
    size = _size(name, pinned)
    if size == 0.0:
        return "from 0"
    part = (now - before) / size
    return "" if abs(part) < LEAST_DIFFERENCE else f"{100.0 * part:+.3g} %"
