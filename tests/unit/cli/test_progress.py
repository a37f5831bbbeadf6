"""The bar: only at a terminal, only for work over a second, never on standard output."""

from __future__ import annotations

import io
import sys
import time

import pytest

from petalfoil.cli import progress


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
