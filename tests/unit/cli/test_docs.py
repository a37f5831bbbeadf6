"""`petalfoil docs` opens the pages at hand, or the address that the project names, or says how to build them."""

from __future__ import annotations

from email.message import Message
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest
from typer.testing import CliRunner

from petalfoil.cli import docs
from petalfoil.cli.app import app


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[str]:
    """Addresses that are opened; no pages are at hand."""
    addresses: list[str] = []
    monkeypatch.setattr(docs.webbrowser, "open", lambda address: addresses.append(address) or True)
    monkeypatch.setattr(docs, "SITES", (tmp_path / "site", tmp_path / "build"))
    return addresses


def test_the_pages_at_hand_are_opened(opened: list[str], tmp_path: Path) -> None:
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "index.html").write_text("built")
    result = CliRunner().invoke(app, ["docs"])
    assert (result.exit_code, opened) == (0, [(tmp_path / "build" / "index.html").as_uri()])
    assert result.stdout.strip() == opened[0]
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "index.html").write_text("installed")
    result = CliRunner().invoke(app, ["docs", "--no-browser"])
    assert result.stdout.strip() == (tmp_path / "site" / "index.html").as_uri()
    assert len(opened) == 1


def test_else_the_address_that_the_project_names(opened: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    named = Message()
    named["Project-URL"] = "Paper, https://doi.org/10.3390/math11132901"
    named["Project-URL"] = "Documentation, https://docs.example/petalfoil"
    monkeypatch.setattr(docs, "metadata", lambda name: named)
    assert CliRunner().invoke(app, ["docs"]).exit_code == 0
    assert opened == ["https://docs.example/petalfoil"]


def test_without_either_it_says_how_to_build_them(opened: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(name: str) -> Message:
        raise PackageNotFoundError(name)

    for answer in (unknown, lambda name: Message()):
        monkeypatch.setattr(docs, "metadata", answer)
        result = CliRunner().invoke(app, ["docs"])
        assert result.exit_code == 2
        assert "make docs" in result.stderr
    assert opened == []


def test_without_a_browser_it_says_so(monkeypatch: pytest.MonkeyPatch, opened: list[str], tmp_path: Path) -> None:
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "index.html").write_text("installed")
    monkeypatch.setattr(docs.webbrowser, "open", lambda address: False)
    result = CliRunner().invoke(app, ["docs"])
    assert result.exit_code == 0
    assert "no browser could be started" in result.stderr
