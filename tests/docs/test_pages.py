"""Pages: what they point at exists, and what they quote is said by the code."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from tests.docs.texts import DOCS, ROOT, labels_in, modules, name_of, pages, text, theory_labels, tree

PAGES = pytest.mark.parametrize("path", pages(), ids=name_of)


def slug(heading: str) -> str:
    """Anchor that a renderer gives to a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def anchors(path: Path) -> set[str]:
    """Anchors of a page."""
    return {slug(heading) for heading in re.findall(r"^#+ (.*)$", text(path), re.MULTILINE)}


@PAGES
def test_links_lead_somewhere(path: Path) -> None:
    links = [link for link in re.findall(r"\]\(([^)\s]+)\)", text(path)) if "://" not in link]
    for link in links:
        file, _, anchor = link.partition("#")
        target = (path.parent / file).resolve() if file else path
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@PAGES
def test_equations_that_a_page_quotes_are_in_the_theory(path: Path) -> None:
    assert labels_in(text(path)) - set(theory_labels()) == set()


@PAGES
def test_the_targets_of_make_exist(path: Path) -> None:
    known = set(re.findall(r"^([a-z-]+):", text(ROOT / "Makefile"), re.MULTILINE))
    named = {word for call in re.findall(r"`make ([a-z -]+)`", text(path)) for word in call.split()}
    assert named - known == set()


@PAGES
def test_mathematics_is_closed(path: Path) -> None:
    blocks = text(path).split("$$")
    assert len(blocks) % 2 == 1
    assert all("\n\n" not in block.strip("\n") for block in blocks[1::2]), "a blank line ends a formula"
    outside = [line for block in blocks[::2] for line in re.sub(r"`[^`\n]*`", "", block).splitlines()]
    assert [line for line in outside if line.count("$") % 2] == []


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
    numbers = [int(path.name[:3]) for path in sorted((DOCS / "decisions").glob("*.md"))]
    assert numbers == list(range(1, len(numbers) + 1))
