"""The bar: only at a terminal, only for work over a second, never on standard output."""

from __future__ import annotations

import io
import sys
import time
import types

import pytest

import petalfoil
from petalfoil.analysis import progress_bar as progress
from tests.cases import case


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def at_terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    """Put a terminal in the place of standard error (in the test itself: pytest takes the streams back before it)."""
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    return stream


def test_silent_without_a_terminal(monkeypatch, capsys) -> None:
    monkeypatch.setattr(progress, "DELAY", 0.0)
    monkeypatch.setenv("FORCE_COLOR", "1")
    with progress.bar("solve") as report:
        report(0.5, "half")
        time.sleep(0.05)
    assert capsys.readouterr() == ("", "")


def test_silent_for_short_work(monkeypatch) -> None:
    terminal = at_terminal(monkeypatch)
    with progress.bar("solve") as report:
        report(0.5, "half")
    assert terminal.getvalue() == ""


def test_appears_while_one_long_step_is_running(monkeypatch, capsys) -> None:
    terminal = at_terminal(monkeypatch)
    monkeypatch.setattr(progress, "DELAY", 0.01)
    with progress.bar("solve") as report:
        report(0.42, "Newton [m]")
        deadline = time.monotonic() + 10.0
        while "42%" not in terminal.getvalue() and time.monotonic() < deadline:
            time.sleep(0.01)
        shown = terminal.getvalue()
    assert "Newton [m]" in shown
    assert "42%" in shown
    assert capsys.readouterr().out == ""


def test_gives_the_terminal_back_when_the_work_fails(monkeypatch) -> None:
    terminal = at_terminal(monkeypatch)
    monkeypatch.setattr(progress, "DELAY", 0.01)
    hidden, shown = "\x1b[?25l", "\x1b[?25h"

    def fail() -> None:
        with progress.bar("solve"):
            deadline = time.monotonic() + 10.0
            while hidden not in terminal.getvalue() and time.monotonic() < deadline:
                time.sleep(0.01)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail()
    text = terminal.getvalue()
    assert text.rindex(shown) > text.rindex(hidden)


class Cell:
    """Output of a cell of a notebook."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def display(self, line: dict[str, str], **_: object) -> Cell:
        self.lines.append(line["text/plain"])
        return self

    def update(self, line: dict[str, str], **_: object) -> None:
        self.lines.append(line["text/plain"])


def test_a_notebook_has_a_line_that_vanishes(monkeypatch: pytest.MonkeyPatch) -> None:
    cell = Cell()
    shell = types.SimpleNamespace(get_ipython=lambda: types.SimpleNamespace(kernel=1))
    monkeypatch.setitem(sys.modules, "IPython", shell)
    monkeypatch.setitem(sys.modules, "IPython.display", types.SimpleNamespace(display=cell.display))
    with progress.bar("solve") as report:
        report(0.1, "too short to be shown")
    assert cell.lines == []
    monkeypatch.setattr(progress, "DELAY", 0.0)
    monkeypatch.setattr(progress, "REWRITE", 0.0)
    with progress.bar("solve") as report:
        report(0.25, "film")
        report(0.5, "")
    assert cell.lines == ["film: 25%", "solve: 50%", ""]


def test_a_call_without_progress_shows_the_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = at_terminal(monkeypatch)
    monkeypatch.setattr(progress, "DELAY", 0.0)
    petalfoil.solve(case("paper_n6", **{"model.cells_per_pitch": 8}))
    assert "solve" in terminal.getvalue()


def test_steps_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level("DEBUG", logger="petalfoil"):
        petalfoil.solve(case("paper_n6", **{"model.cells_per_pitch": 8}))
    told = [record.getMessage() for record in caplog.records]
    assert any(line.startswith("film: barrier ") for line in told)
    assert told[-1] == "solve: converged"
