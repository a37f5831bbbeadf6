"""What pages show below a command is what it prints."""

from __future__ import annotations

from pathlib import Path

import pytest

from petalfoil.cli.new import StartingWall, starting_case
from tests.docs.console import alike, blocks, missing, shown
from tests.docs.texts import DOCS, ROOT

WITH_OUTPUT = [
    pytest.param(block, id=f"{page.stem}-{number}")
    for page in sorted(DOCS.rglob("*.md"))
    for number, block in enumerate(block for block in blocks(page, "console") if shown(block)[1])
    if block.startswith("$ petalfoil ") and block.count("$ ") == 1
]


def test_pages_show_what_commands_print() -> None:
    assert len(WITH_OUTPUT) >= 8


@pytest.mark.slow
@pytest.mark.parametrize("block", WITH_OUTPUT)
def test_the_command_prints_what_stands_there(block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Commands about `case.toml` are about the one that `petalfoil new` writes."""
    (tmp_path / "case.toml").write_text(starting_case(StartingWall.PETALS), encoding="utf-8")
    monkeypatch.chdir(tmp_path if " case.toml" in shown(block)[0] else ROOT)
    assert missing(block) == []


def test_another_line_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    block = "$ petalfoil check \\\n    examples/bump_foil.toml\nmean free path 67.26 nm\n...\nmean free path 67.26 nm\n"
    assert missing(block) == ["mean free path 67.26 nm"]  # it is printed once


@pytest.mark.parametrize(
    ("other", "same"),
    [
        ("force  16.8607 N", True),
        ("force    16.8608   N", True),
        ("force  16.8609 N", False),
        ("force  16.861 N", False),
        ("force  16.8607 kN", False),
        ("force  16.8607 N 1", False),
    ],
)
def test_lines_are_alike_but_for_rounding(other: str, same: bool) -> None:
    assert alike("force   16.8607  N", other) is same


def test_a_page_without_output_is_not_asked(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("```console\n$ petalfoil curve case.toml \\\n    --resume curve.nc\n```\n", encoding="utf-8")
    (block,) = blocks(page, "console")
    assert shown(block) == ("petalfoil curve case.toml      --resume curve.nc", [])
