"""Tables between marks of a page: what stands there, and what a script computes in its place.

A table stands between `<!-- table NAME -->` and `<!-- end of table NAME -->`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

DOCS = Path(__file__).parents[1] / "docs"

Row = Callable[[], tuple[str, ...]]
"""Computes the cells of a row behind its label."""


@dataclass(frozen=True)
class Table:
    """A table of a page: its columns, and its rows by what stands before the computed cells."""

    page: str  # in `docs`
    head: str
    rows: dict[str, Row]
    words: tuple[int, ...] = (0,)
    """Columns of words; the others are numbers, flush right."""

    def alignment(self) -> str:
        """Line below the head."""
        return "|" + "".join("---|" if k in self.words else "---:|" for k in range(self.head.count("|") - 1))


def marked(name: str) -> re.Pattern[str]:
    """What stands between the marks of a table."""
    return re.compile(rf"(<!-- table {name} -->\n\n)(.*?)(\n\n<!-- end of table {name} -->)", re.DOTALL)


def standing(name: str, page: str) -> list[str]:
    """Lines of a table as they stand on the text of a page."""
    found = marked(name).search(page)
    if found is None:
        raise SystemExit(f"the page has no <!-- table {name} --> with an end")
    return found[2].splitlines()


def lines(name: str, table: Table, labels: list[str], page: str) -> Iterator[str]:
    """Lines of a table: rows with the labels computed anew, the others as they stand on the text of a page."""
    before = standing(name, page)
    yield from (table.head, table.alignment())
    for label, row in table.rows.items():
        if label in labels:
            yield f"| {label} | {' | '.join(row())} |"
        else:
            yield from (line for line in before if line.startswith(f"| {label} |"))


def write(name: str, table: Table, labels: list[str]) -> None:
    """Compute rows of a table and put them on its page."""
    err = Console(stderr=True, markup=False, highlight=False, soft_wrap=True)
    path, done = DOCS / table.page, []
    page = path.read_text(encoding="utf-8")
    for line in lines(name, table, labels, page):
        err.print(line)
        done.append(line)
    text = "\n".join(done)
    path.write_text(marked(name).sub(lambda found: found[1] + text + found[3], page), encoding="utf-8")
