"""Pages without external references, from the templates of this folder: elements, figures inside the file."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable
from functools import cache
from html import escape
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from matplotlib.figure import Figure

from petalfoil.report.page_tables import PageTable


@cache
def templates() -> Environment:
    """The templates: everything is escaped, and a name that a template misses is an error."""
    loader = PackageLoader("petalfoil.report")
    made = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    made.filters |= {"prose": prose, "image": image, "kinds": kinds}
    return made


def page(title: str, body: Iterable[str]) -> str:
    """The page as HTML, from elements that are HTML."""
    return templates().get_template("page.html").render(title=title, body=[Markup(part) for part in body])


def prose(text: str) -> Markup:
    """Plain text; indices of symbols such as `R_j` and `p_a` become subscripts, code and line breaks stay."""
    lowered = re.sub(r"\b([A-Za-zφδ])_([A-Za-z]+)\b", r"\1<sub>\2</sub>", escape(text))
    coded = re.sub(r"`([^`]+)`", r"<code>\1</code>", lowered)
    return Markup(coded.replace("\n", "<br>"))


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    return _element("paragraph", text, kind)


def bullets(items: Iterable[str]) -> str:
    """A list of plain texts."""
    return _element("bullets", list(items))


def section(name: str, heading: str) -> str:
    """A heading with an anchor for the navigation."""
    return _element("section", name, heading)


def table(content: PageTable, marked: Iterable[int] = ()) -> str:
    """A table. Columns of numbers are aligned to the right; the rows `marked` are highlighted."""
    return _element("table", content, kinds(content), set(marked))


def picture(fig: Figure, caption: str, width: float | None = None) -> str:
    """A figure inside the page, as SVG, drawn for a `width` [inch] of its own if given."""
    return _element("picture", image(fig, width), caption)


def pair(first: str, second: str) -> str:
    """Two elements side by side."""
    return _element("pair", Markup(first), Markup(second))


def image(fig: Figure, width: float | None = None) -> str:
    """A figure as an address that holds it, drawn for a `width` [inch] of its own if given."""
    if width is not None:
        fig.set_size_inches(width, width * fig.get_figheight() / fig.get_figwidth())
    buffer = io.BytesIO()
    fig.savefig(buffer, format="svg", metadata={"Date": None})
    return f"data:image/svg+xml;base64,{base64.b64encode(buffer.getvalue()).decode('ascii')}"


def kinds(content: PageTable) -> list[str]:
    """Style class of each column: "n" for numbers, by the table's own word or because all cells are."""
    width = max(len(line) for line in (content.head, *content.rows))
    if content.left:
        words = {k % width for k in content.left}
        return ["" if k in words else "n" for k in range(width)]
    return ["n" if all(_is_number(row[k]) for row in content.rows) else "" for k in range(width)]


def _element(name: str, *arguments: Any) -> str:
    return str(getattr(templates().get_template("elements.html").module, name)(*arguments))


def _is_number(text: str) -> bool:
    return bool(text) and all(letter in "0123456789.,+-−–×%e" for letter in text)
