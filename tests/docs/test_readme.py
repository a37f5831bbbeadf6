"""What the README shows works: its case loads, its command prints what stands there, its Python runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer

from petalfoil.case import Case
from petalfoil.cli.app import app
from tests.docs.console import blocks, missing
from tests.docs.test_pages import anchors
from tests.docs.texts import ROOT, text

README = ROOT / "README.md"

LONGEST = 113
"""Lines: who decides whether to try a program reads no more. What is longer has its page in the documentation."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the README's case."""
    path = tmp_path_factory.mktemp("readme")
    (case,) = blocks(README, "toml")
    (path / "case.toml").write_text(case, encoding="utf-8")
    return path


def test_the_case_is_the_paper_s() -> None:
    (case,) = blocks(README, "toml")
    mine, paper = Case.from_toml(case), Case.load(ROOT / "examples" / "paper_n8.toml")
    assert mine.bearing == paper.bearing
    assert mine.petals == paper.petals
    assert mine.gas.viscosity == paper.gas.viscosity


def test_the_command_prints_what_stands_there(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (console,) = blocks(README, "console")
    monkeypatch.chdir(folder)
    assert missing(console) == []


@pytest.mark.slow
def test_the_python_prints_what_stands_there(folder: Path) -> None:
    (code,), (shown,) = blocks(README, "python"), blocks(README, "text")
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True)
    assert done.stdout == shown
    assert (folder / "point.png").read_bytes().startswith(b"\x89PNG")


def test_the_main_commands_are_named() -> None:
    verbs = set(re.findall(r"`petalfoil (\w+)", text(README)))
    group: Any = typer.main.get_command(app)
    assert {"check", "solve", "balance", "liftoff", "coefficients", "stability", "report", "studio"} <= verbs
    assert verbs <= set(group.list_commands(typer.Context(group)))


def test_links_lead_somewhere() -> None:
    for link in re.findall(r"\]\(([^)\s]+)\)", text(README)):
        if "://" not in link:
            file, _, anchor = link.partition("#")
            assert (ROOT / file).exists(), link
            assert not anchor or anchor in anchors(ROOT / file), link


def test_the_targets_of_make_exist() -> None:
    targets = set(re.findall(r"^([a-z-]+):", text(ROOT / "Makefile"), re.MULTILINE))
    named = set(re.findall(r"\bmake ([a-z-]+)", text(README)))
    assert {"demo", "docs"} <= named <= targets


def test_it_is_short_and_has_a_picture_of_the_bearing_and_one_of_the_studio() -> None:
    assert len(text(README).splitlines()) <= LONGEST
    pictures = re.findall(r"^!\[.*\]\((.*)\)$", text(README), re.MULTILINE)
    assert pictures == ["docs/images/petal_bearing.png", "docs/images/studio.png"]


def test_the_pictures_are_small() -> None:
    pictures = sorted((ROOT / "docs" / "images").glob("*.png"))
    assert {"orbit.png", "petal_bearing.png"} <= {path.name for path in pictures}
    assert all(path.stat().st_size < 300_000 for path in pictures)
