"""An answer as one page of HTML that stands alone: figure, tables, warnings, case."""

from __future__ import annotations

from collections.abc import Iterator

from petalfoil import __version__
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot import summary
from petalfoil.report.html import bullets, page, paragraph, picture, section, table
from petalfoil.report.page_tables import PageTable
from petalfoil.results.answer import Answer
from petalfoil.results.tables import TextTable, tables_of
from petalfoil.text import for_html, for_terminal

HEADS = {3: ("result", "value", "unit"), 4: ("result", "value", "error bar", "unit")}
"""Headings of lines that explain themselves, by their length."""


def one_page(answer: Answer, case_toml: str) -> str:
    """The report of an answer.

    Parameters
    ----------
    answer : Answer
        Answer of any analysis.
    case_toml : str
        Its case.

    Returns
    -------
    str
        A page without external references.
    """
    title = for_terminal(answer.title) or "Petal gas bearing"
    body = [f"<h1>{for_html(title)}</h1>", paragraph(f"petalfoil {__version__}, {answer.verb}", "note")]
    body += _figure(answer)
    body += [section("results", "Results"), *(table(_for_page(one)) for one in tables_of(answer))]
    remarks = [for_terminal(remark) for remark in (*answer.warnings, *answer.failures())]
    if remarks:
        body += [section("warnings", "Warnings"), bullets(remarks)]
    lines = "\n".join(for_html(line) for line in case_toml.strip().splitlines())
    body += [section("case", "Case"), f"<pre>{lines}</pre>"]
    return page(title, body)


def _figure(answer: Answer) -> Iterator[str]:
    """The figure of the answer, or why there is none."""
    try:
        yield picture(summary(answer.to_dataset()), f"{answer.verb}: {for_terminal(answer.title)}")
    except (ConvergenceError, UsageError) as reason:
        yield paragraph(f"Nothing is drawn: {reason}", "note")


def _for_page(content: TextTable) -> PageTable:
    """A table as the report writes it, foreign texts as one line each."""
    widest = max((len(line) for line in content.lines), default=3)
    head = tuple(column.words for column in content.columns) or HEADS[widest]
    lines = (line if len(line) == widest else (*line, *[""] * (widest - len(line))) for line in content.lines)
    return PageTable(head, tuple(tuple(map(for_terminal, line)) for line in lines))
