"""Pages: what they point at exists, and what they quote is said by the code."""

from __future__ import annotations

import ast
import re
from pathlib import Path

from tests.docs.texts import DOCS, ROOT, labels_in, modules, name_of, pages, text, theory_labels, tree


def slug(heading: str) -> str:
    """Anchor that a renderer gives to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(path: Path) -> set[str]:
    """Anchors of a page."""
    return {slug(heading) for heading in re.findall(r"^#+ (.*)$", text(path), re.MULTILINE)}


def links(path: Path) -> list[str]:
    """Links of a page to files and headings of the repository."""
    return [link for link in re.findall(r"\]\(([^)\s]+)\)", text(path)) if "://" not in link]


def leads_somewhere(path: Path, link: str) -> bool:
    """Whether a link on the page `path` has a target."""
    file, _, anchor = link.partition("#")
    target = (path.parent / file).resolve() if file else path
    return target.exists() and (not anchor or anchor in anchors(target))


def open_mathematics(path: Path) -> list[str]:
    """Formulas of a page that do not end, and lines with a single `$`."""
    blocks = re.sub(r"^```.*?^```", "", text(path), flags=re.MULTILINE | re.DOTALL).split("$$")
    if len(blocks) % 2 == 0:
        return ["an odd number of $$"]
    broken = [block for block in blocks[1::2] if "\n\n" in block.strip("\n")]  # a blank line ends a formula
    outside = [line for block in blocks[::2] for line in re.sub(r"`[^`\n]*`", "", block).splitlines()]
    return broken + [line for line in outside if line.count("$") % 2]


def test_links_lead_somewhere() -> None:
    every = [(path, link) for path in pages() for link in links(path)]
    assert len(every) > 20
    assert [(name_of(path), link) for path, link in every if not leads_somewhere(path, link)] == []


def test_equations_that_a_page_quotes_are_in_the_theory() -> None:
    known = set(theory_labels())
    quoted = {name_of(path): labels_in(text(path)) for path in pages()}
    assert {name: labels - known for name, labels in quoted.items() if labels - known} == {}


def test_the_targets_of_make_exist() -> None:
    known = set(re.findall(r"^([a-z-]+):", text(ROOT / "Makefile"), re.MULTILINE))
    calls = [(path, call) for path in pages() for call in re.findall(r"`make ([a-z -]+)`", text(path))]
    assert calls
    assert [(name_of(path), word) for path, call in calls for word in call.split() if word not in known] == []


def test_mathematics_is_closed() -> None:
    assert {name_of(path): found for path in pages() if (found := open_mathematics(path))} == {}


def test_the_reader_of_mathematics_reads(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("A $x$ and `$`.\n\n$$\na\n\nb\n$$\nOne $ alone.\n", encoding="utf-8")
    assert open_mathematics(page) == ["\na\n\nb\n", "One $ alone."]


def spoken() -> set[str]:
    """Every constant text of the code."""
    return {
        " ".join(node.value.split())
        for path in modules()
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }


def test_messages_that_the_help_quotes_are_said_by_the_code() -> None:
    quoted = re.findall(r'`"([a-z][^"`]*)"`', text(DOCS / "convergence-help.md"))
    said = spoken()
    assert len(quoted) > 10
    assert [message for message in quoted if not any(message in constant for constant in said)] == []


def test_decisions_are_numbered_without_gaps() -> None:
    numbers = [int(path.name[:3]) for path in sorted((DOCS / "decisions").glob("[0-9]*.md"))]
    assert numbers == list(range(1, len(numbers) + 1))
