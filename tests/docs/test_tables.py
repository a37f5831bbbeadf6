"""Every table of the pages on validation has a script that writes it, and the script the table."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from benchmarks.page_tables import lines, standing
from benchmarks.validation_tables import TABLES

from tests import fuzz, fuzz_verbs
from tests.docs.console import alike
from tests.docs.texts import DOCS, ROOT, text
from tests.verification.test_rig_table1 import script

PAGES = [
    *(path for path in sorted((DOCS / "validation").glob("*.md")) if path.name != "recorded-runs.md"),
    *(DOCS / name for name in ("paper-values.md", "random-bearings.md", "validation-rig.md")),
]
MARKED = re.compile(r"<!-- table ([\w-]+) -->\n\n.*?\n\n<!-- end of table \1 -->", re.DOTALL)

SCRIPTS = {
    "accuracy-3d.md": ("benchmarks/accuracy_3d.py",),
    "grid-accuracy.md": ("benchmarks/grid_accuracy.py",),
    "paper-values.md": ("examples/paper_values.py",),
    "random-bearings.md": ("tests/fuzz.py", "tests/fuzz_verbs.py"),
    "rig-friction.md": ("examples/rig_friction.py",),
    "validation-rig.md": ("examples/rig_report.py", "examples/rig_study.py"),
}
"""What writes the tables of a page that have no marks."""

GIVEN = {
    "| what | against | at this grid |": "what tests compare, and how closely they ask for it",
    "| what the paper gives | what can be compared | where |": "words",
    "| | value | |": "what the paper prints, what is assumed",
    "| searched | from | to |": "ranges that were chosen",
    "| path | estimate | |": "estimates, each with its formula",
    "| bearing | petals | steps along the path | times that it turns | processor time |": "what one long test follows",
    "| | petal bearing of the paper | test rig of the paper | single-pad bump foil | measured bump foil |": (
        "what publications print; a test below compares the last row with the page"
    ),
}
"""Heads of tables that no run gives, and what they are."""

MINUTES = ("capacity", "heat", "small-motions")
"""Tables of which one row is computed by the slow tests; together they take a minute."""


def tables(words: str) -> list[list[str]]:
    """Tables of a text as lines, those within lists too."""
    found = re.findall(r"(?:^ *\|.*\n)+", words + "\n", re.MULTILINE)
    return [[line.strip() for line in table.splitlines()] for table in found]


def cells(line: str) -> list[str]:
    """Cells of a row."""
    return [cell.strip() for cell in line.strip("|").split("|")]


def written_by(table: list[str], script: Path) -> bool:
    """Whether all words of the head of a table stand in a script."""
    return all(word in text(script) for word in re.findall(r"[^\W\d_]{3,}", table[0]))


def test_a_table_has_a_script_that_writes_it() -> None:
    lost = []
    for page in PAGES:
        scripts = [ROOT / name for name in SCRIPTS.get(page.name, ())]
        assert all(script.name in text(page) or f"tests.{script.stem} " in text(page) for script in scripts)
        for table in tables(MARKED.sub("", text(page))):
            if table[0] not in GIVEN and not any(written_by(table, script) for script in scripts):
                lost.append((page.name, table[0]))
    assert lost == [], "let benchmarks/validation_tables.py write it, or name the script or what it holds"


def test_what_is_given_is_still_there() -> None:
    heads = {table[0] for page in PAGES for table in tables(text(page))}
    assert set(GIVEN) <= heads


def test_tables_of_long_runs_have_the_heads_and_labels_of_their_scripts() -> None:
    random = tables(text(DOCS / "random-bearings.md"))
    labels = {table[0]: [cells(line)[0] for line in table[2:]] for table in random}
    assert labels[fuzz.HEAD] == list(fuzz.GROUPS)
    assert sorted(labels[fuzz_verbs.HEAD]) == sorted(f"`{verb}`" for verb in fuzz_verbs.RUNS)
    assert script("rig_study").table([]) in text(DOCS / "validation-rig.md")


def test_marks_are_those_of_the_script() -> None:
    marks = [
        (path.relative_to(DOCS).as_posix(), name) for path in DOCS.rglob("*.md") for name in MARKED.findall(text(path))
    ]
    assert sorted(marks) == sorted((table.page, name) for name, table in TABLES.items())


@pytest.mark.parametrize("name", TABLES)
def test_a_table_has_the_head_and_rows_of_the_script(name: str) -> None:
    page = text(DOCS / TABLES[name].page)
    there = standing(name, page)
    assert list(lines(name, TABLES[name], [], page)) == there
    assert len(there) == 2 + len(TABLES[name].rows)
    assert len({len(cells(line)) for line in there}) == 1


def recomputed(name: str, *labels: str) -> list[tuple[str, str]]:
    """Lines of a table on its page and computed anew that differ by more than rounding."""
    page = text(DOCS / TABLES[name].page)
    pairs = zip(standing(name, page), lines(name, TABLES[name], list(labels or TABLES[name].rows), page), strict=True)
    return [(there, now) for there, now in pairs if not alike(there, now)]


@pytest.mark.parametrize(
    ("name", "label"),
    [
        ("way-of-a-petal", "23.089 mm"),
        pytest.param("capacity", "contact film thickness 2 µm", marks=pytest.mark.slow),
        pytest.param("heat", "7 W/K | +0 K", marks=pytest.mark.slow),
        pytest.param("small-motions", "turbocharger", marks=pytest.mark.slow),
    ],
)
def test_a_row_is_what_the_script_computes(name: str, label: str) -> None:
    assert recomputed(name, label) == []


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in MINUTES else pytest.mark.slow) for name in TABLES]
)
def test_a_table_is_what_the_script_computes(name: str) -> None:
    assert recomputed(name) == []


def test_a_table_without_a_script_is_seen() -> None:
    (table,) = tables("Words.\n\n  | pad | load |\n  |---|---:|\n  | odd | 1.2 N |\n\nMore.")
    assert table == ["| pad | load |", "|---|---:|", "| odd | 1.2 N |"]
    assert not written_by(table, ROOT / "examples" / "rig_report.py")


def test_the_summary_of_published_bearings_is_that_of_their_tables() -> None:
    page = text(DOCS / "validation" / "published-bearings.md")
    (summary,) = [line for line in page.splitlines() if line.startswith("| comes out |")]
    forces = re.search(r"gives ([\d.]+), [\d.]+ and ([\d.]+) N for 6, 8 and 10 petals", page)
    assert forces is not None
    assert f"{float(forces[2]) / float(forces[1]):.1f}-fold, hinged" in summary
    assert "1.8 to 2.5-fold, clamped" in summary
    assert "1.8 to 2.5 times from 6 to 10 petals" in " ".join(text(DOCS / "validation" / "trust.md").split())
    floors = [float(cells(line)[-1]) for line in standing("capacity", page) if "contact film thickness" in line]
    assert f"{min(floors):.1f} to {max(floors):.1f} times it" in summary
    (films,) = [cells(line)[2:] for line in standing("mid-plane", page) if line.startswith("| 45 000 | film")]
    assert f"{float(films[0]):.0f} to {float(films[-1]):.0f} µm at the mid-plane" in summary
    experiments = re.findall(r"^\| [456]\d\.\d \| 1.*$", text(DOCS / "validation-rig.md"), re.MULTILINE)
    rig = [cells(line) for line in experiments]
    torque, speed = (max(abs(float(row[k].strip("+−% "))) for row in rig) for k in (3, 6))
    assert len(rig) == 3
    assert f"torque within {torque:.0f} %, lift-off within {speed:.1f} %" in summary
