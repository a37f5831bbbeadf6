"""Numbers of a page have a command and a day: on the page itself, or in a row of `docs/validation/recorded-runs.md`.

A page counts where it has tables or captions of measured numbers. `test_sentences` asks the same of running text.
"""

from __future__ import annotations

import calendar
import re
from pathlib import Path

from tests.docs.console import blocks, shown
from tests.docs.texts import DOCS, ROOT, text

RUNS = DOCS / "validation" / "recorded-runs.md"

NUMBER = re.compile(r"(?<![\w.])\d+\.\d+|\d\s?%|±")
COMMAND = re.compile(r"petalfoil [a-z]+[ `]|python (?:-m )?[\w./]+|make [a-z-]+|pytest |tests/\S+\.py")
DAY = re.compile(rf"\d{{4}}-\d\d-\d\d|\d{{1,2}} (?:{'|'.join(calendar.month_name[1:])}) \d{{4}}")

NO_RESULTS = {
    "notation.md": "ranges and units of keys",
    "theory.md": "constants of the methods, which tests/docs/test_constants.py compares with the code",
    "how-to/metals.md": "values of the sources that stand there; tests compare them with the code",
    "convergence-help.md": "constants, compared with the code",
    "start/first-bearing.md": "an example of units",
}
"""Pages with numbers that no run of petalfoil gives, and what they are."""


def measured(page: Path) -> list[str]:
    """Rows of tables and captions of a page that hold numbers; printed output is compared by `test_console`."""
    words = re.sub(r"^```.*?^```", "", text(page), flags=re.MULTILINE | re.DOTALL)
    rows = [line for line in words.splitlines() if line.startswith("|") and NUMBER.search(line)]
    captions = [block for block in words.split("\n\n") if block.startswith("*") and NUMBER.search(block)]
    return rows + [caption for caption in captions if not caption.startswith(("**", "* "))]


def rows() -> list[tuple[str, str, str]]:
    """Cells of the table of recorded runs."""
    lines = [line.strip("|").split("|") for line in text(RUNS).splitlines() if line.startswith("| ")]
    return [(numbers, command, day) for numbers, command, day in lines[1:]]


def recorded() -> set[Path]:
    """Pages that a row of the table names."""
    links = [link for numbers, _, _ in rows() for link in re.findall(r"\]\(([^)#\s]+)", numbers)]
    return {(RUNS.parent / link).resolve() for link in links}


def pages() -> list[Path]:
    """Pages that are written by hand."""
    written = {"gallery", "worked", "reference"}
    return [path for path in sorted(DOCS.rglob("*.md")) if not written & set(path.parts) and path != RUNS]


def test_measured_numbers_have_a_command_and_a_day() -> None:
    known, lost = recorded(), []
    for page in pages():
        name = page.relative_to(DOCS).as_posix()
        own = COMMAND.search(text(page)) and DAY.search(text(page))
        if (
            measured(page)
            and name not in NO_RESULTS
            and page not in known
            and not own
            and "decisions" not in page.parts
        ):
            lost.append(name)
    assert lost == [], "name the command and the day there, or in a row of docs/validation/recorded-runs.md"


def test_decisions_have_a_day() -> None:
    decisions = sorted((DOCS / "decisions").glob("[0-9]*.md"))
    assert len(decisions) > 20
    assert [path.name for path in decisions if not re.search(rf"^Taken on ({DAY.pattern})\.$", text(path), re.M)] == []


def test_recorded_runs_have_commands_that_exist_and_days() -> None:
    assert len(rows()) > 10
    for numbers, command, day in rows():
        assert COMMAND.search(command) or "commands" in command, numbers
        assert DAY.search(day), numbers
        for script in re.findall(r"python ([\w./]+\.py)|`pytest [^`]*?(tests/[\w./]+\.py)", command):
            assert all((ROOT / name).is_file() for name in script if name), command


def test_the_accuracy_of_grids_is_told_alike() -> None:
    row = re.compile(r"^\| [23]-D, .*$", re.MULTILINE)
    told = row.findall(text(DOCS / "validation" / "grid-accuracy.md"))
    assert len(told) == 5
    assert [row.findall(text(DOCS / page)) for page in ("validation/trust.md", "how-to/choose-the-grid.md")] == [
        told
    ] * 2


def test_pages_without_results_are_still_there() -> None:
    assert [name for name in NO_RESULTS if not measured(DOCS / name)] == []


def test_numbers_are_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "| a | 3.2 N |\n|---|---|\n| b | c |\n\n*Drawn at 12 %.*\n\n```text\n| 4.5 |\n```\n", encoding="utf-8"
    )
    assert measured(page) == ["| a | 3.2 N |", "*Drawn at 12 %.*"]
    assert [shown(block) for block in blocks(page, "text")] == [("| 4.5 |", [])]
