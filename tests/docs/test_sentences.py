"""Results in sentences have a source: the section names a command or links to the page that has the numbers.

Result-like is a number with a unit, a percentage, a ratio or a power of ten in running text. Numbers of code, formulas
and links, tables (`test_provenance`), printed output (`test_console`) and constants beside their name
(`test_constants`) are left out. Sections whose numbers are given, not computed, are named in `GIVEN`.
"""

from __future__ import annotations

import ast
import re
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

from tests.docs.test_provenance import COMMAND, DAY, RUNS, pages, rows
from tests.docs.test_stated import STATED
from tests.docs.texts import DOCS, ROOT, name_of, text, tree

UNIT = (
    r"(?:%|µm|nm|mm|kN|N·m|N s/m|kN/m|N|rpm|K|kg|MB|GB|s|ms|minutes?|seconds?|hours?|Hz|rad/s|µrad|kPa|MPa|GPa|W/K|W|"
    r"µJ|J|times|fold|factorisations|solves)"
)
RESULT = re.compile(rf"(?<![\w.,§])\d[\d ]*(?:\.\d+)?[\s-]{UNIT}(?![\w/])|\d+\.\d+(?!\.)|± ?\d|\d+e-\d|\d-fold")

NO_RESULT = re.compile(
    r"^```.*?^```"  # code and printed output
    r"|^:::.*?^:::"
    r"|\$\$.*?\$\$|\$[^$]*\$"  # formulas
    r"|!\[[^\]]*\]\([^)]*\)"  # what a picture shows, said to whom does not see it
    r"|\[[^\]]*\]\([^)]*\)|<https?:[^>]*>"  # links and what they are called
    r"|[^\s(]+(?:\s\w+|\s%)?\s\(`[^)]*\)"  # constants beside their name
    r"|`[^`\n]*`"
    r"|\((?:[\d.]+(?:, |–)?)+\)|(?:[Ss]ection|[Ff]igures?|[Tt]ables?) [\d.]+|as in \d\.\d|^#+ .*?$"  # labels
    r"|(?:Python|NumPy|SciPy|ROSS|numba|CoolProp|petalfoil|openairbearing|with|and) \d+\.\d+(?:\.\d+)?(?= |,|;|\.|\))",
    re.MULTILINE | re.DOTALL,
)

HEADING = re.compile(r"^```.*?^```|^(#{1,4} )", re.MULTILINE | re.DOTALL)
"""A heading, or a block of code, whose comments are none."""

SOURCE = re.compile(
    r"\]\((?:[\w./-]*/)?(?:decisions/\d|validation/|grid-accuracy|accuracy-3d|elastica|rig-friction|recorded)"
)
"""A link to a page whose numbers have a command or a day."""

GIVEN = {
    "how-to/measured-free-shape.md#a-measured-free-shape": "a rule for the file",
    "how-to/metals.md#petals-of-a-named-metal": "values of sources that stand there",
    "how-to/unequal-petals.md#petals-that-differ": "the scatter of an example",
    "how-to/unequal-petals.md#one-petal-at-a-time": "the change that the command is asked for",
    "how-to/unequal-petals.md#what-is-approximate": "5 µm over twice 26 mm",
    "theory.md#2-foil-pack": "5 µm over twice 26 mm",
    "examples/gallery/plot_sensitivity.py": "the change that is asked for",
    "examples/notebooks/first_bearing.py": "a load",
    "examples/tutorials/plot_size_a_turbocharger_bearing.py": "requirements and dimensions",
    "examples/tutorials/plot_stiffness_damping_whirl.py": "a mass",
}
"""Sections and scripts with numbers that are no results, and what they are. Results of a script are what it prints."""


def sections(page: Path) -> dict[str, str]:
    """Text below each heading of a page by the name of the page and the anchor of the heading."""
    if page.suffix == ".py":
        return {name(page): prose(page)}
    headings = [found.start() for found in HEADING.finditer(text(page)) if found[1]]
    parts = [text(page)[start:end] for start, end in pairwise([*headings, len(text(page))])]
    return {f"{name(page)}#{anchor(part.splitlines()[0])}": part for part in parts}


def prose(script: Path) -> str:
    """What a script of the gallery or a tutorial says on its page: the docstring on top and its comments."""
    comments = [line.removeprefix("#") for line in text(script).splitlines() if line.startswith("#")]
    return (ast.get_docstring(tree(script)) or "") + "\n\n" + "\n".join(line.strip() for line in comments)


def name(page: Path) -> str:
    """A page of the site by its place there, another by its place in the repository."""
    return page.relative_to(DOCS if DOCS in page.parents else ROOT).as_posix()


def anchor(heading: str) -> str:
    """The anchor that MyST gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lstrip("# ").lower()).strip().replace(" ", "-")


def results(words: str) -> list[str]:
    """Sentences with numbers that look like results."""
    lines = [line for line in words.splitlines() if not line.startswith(("|", "    "))]
    plain = NO_RESULT.sub("", "\n".join(lines))
    sentences = re.split(r"(?<=[.:;])\s+|\n\n", plain)
    return [" ".join(one.split()) for one in sentences if RESULT.search(one)]


@cache
def speaking() -> dict[str, list[str]]:
    """Commands of the table of recorded runs by the pages and sections that they speak for."""
    found: dict[str, list[str]] = {
        "README.md#petalfoil": [command for numbers, command, _ in rows() if "README" in numbers]
    }
    for numbers, command, _ in rows():
        for link in re.findall(r"\]\(([^)\s]+)\)", numbers):
            page, mark, heading = link.partition("#")
            found.setdefault(f"{name((RUNS.parent / page).resolve())}{mark}{heading}", []).append(command)
    return found


def has_source(page: Path, section: str, words: str) -> bool:
    """Whether somebody can say where the results of a section come from."""
    told = speaking().get(section, []) + speaking().get(name(page), [])
    if any("commands on th" not in command for command in told):
        return True
    dated = DAY.search(text(page)) or name(page) in speaking()
    return bool(SOURCE.search(words) or "`tests/" in words or (dated and COMMAND.search(words)) or computed(words))


def computed(words: str) -> bool:
    """Whether `test_stated` computes a sentence of a section anew."""
    plain = " ".join(words.split())
    return any(re.search(re.sub(r"\\\{.*?\\\}", "[-\\\\d.]+", re.escape(sentence)), plain) for _, sentence, _ in STATED)


def unsourced(page: Path) -> list[str]:
    """Sections of a page with results that have no source."""
    return [
        section
        for section, words in sections(page).items()
        if results(words) and section not in GIVEN and not has_source(page, section, words)
    ]


SCRIPTS = [
    path
    for folder in ("gallery", "tutorials", "notebooks")
    for path in sorted((ROOT / "examples" / folder).glob("*.py"))
]
TEXTS = [ROOT / "README.md", *(page for page in pages() if "decisions" not in page.parts), *SCRIPTS]
"""All that the site shows, but decisions: they have a day each (`test_provenance`)."""


@pytest.mark.parametrize("page", TEXTS, ids=name_of)
def test_results_in_sentences_have_a_source(page: Path) -> None:
    lost = unsourced(page)
    assert lost == [], (
        "name the command (and the day), link to the page that has the numbers, or add a sentence to STATED"
    )


def test_exceptions_are_still_there() -> None:
    stated = {section for page in TEXTS for section, words in sections(page).items() if results(words)}
    assert set(GIVEN) <= stated


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("The film is 3.2 µm thick. It is thin.", ["The film is 3.2 µm thick."]),
        ("It takes 40 % more,\nor 12 N.", ["It takes 40 % more, or 12 N."]),
        ("Equal to 1e-6; the journal's speed is 26-fold.", ["Equal to 1e-6;", "the journal's speed is 26-fold."]),
        ("A limit of 0.2 (`TRUST`) and 1e-10\n(`heat_rows.BALANCE`) hold.", []),
        ("See [theory, 9.8](theory.md#98), (7.1), Figure 2.1 and `--load 20.5`.\n\n| 3.2 N |\n\n    4.2 N", []),
        ("```text\n3.2 N\n```\nAnd $x = 3.2$ in Python 3.11.", []),
    ],
)
def test_results_are_told_from_other_numbers(words: str, found: list[str]) -> None:
    assert results(words) == found


def test_a_section_without_a_source_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.docs.test_sentences.DOCS", tmp_path)
    page = tmp_path / "page.md"
    page.write_text(
        "# A page\n\n1.2 N.\n\n```toml\n# 3\n```\n\n## Its end\n\n3.4 N (`tests/a.py`).\n", encoding="utf-8"
    )
    assert unsourced(page) == ["page.md#a-page"]
