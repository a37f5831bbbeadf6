"""Elements of a page without external references: tables, figures inside the file, a style for screen and print."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Iterable
from html import escape

from matplotlib.figure import Figure

from petalfoil.report.page_tables import TextTable

STYLE = """
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: #222; background: #fff;
       max-width: 62rem; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.7rem; line-height: 1.2; margin-bottom: .3rem; }
h2 { font-size: 1.25rem; margin: 2.2rem 0 .6rem; border-bottom: 1px solid #ccc; padding-bottom: .2rem; }
p.note, figcaption { color: #555; font-size: .9rem; }
nav { font-size: .9rem; display: flex; flex-wrap: wrap; gap: .2rem 1.1rem; }
a { color: #0072B2; } sub { line-height: 0; font-size: .75em; }
figure { margin: 1rem 0; break-inside: avoid; } figure img { width: 100%; height: auto; }
.pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; margin-bottom: 1.2rem; }
.pair figure { margin: 0; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: .85rem; margin: .8rem 0; }
th, td { padding: .3rem .55rem; text-align: left; vertical-align: top; border-bottom: 1px solid #e3e3e3; }
th { border-bottom: 2px solid #999; font-weight: 600; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr { break-inside: avoid; }
.verdict { width: 8.5rem; font-weight: 600; }
span.note { color: #777; }
.met { color: #00724f; } .unmet { color: #b34700; } .elsewhere { color: #8a6100; }
tr.marked td { background: #eef7f2; }
@media (max-width: 50rem) { .pair { grid-template-columns: 1fr; } }
@media print { body { max-width: none; margin: 0; font-size: 10pt; } nav { display: none; } a { color: inherit; } }
"""


def page(title: str, body: Iterable[str]) -> str:
    """The page as HTML."""
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(title)}</title>'
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head>{head}<style>{STYLE}</style></head><body>\n'
        + "\n".join(body)
        + ("\n</body></html>\n")
    )


def prose(text: str) -> str:
    """Plain text; indices of symbols such as `R_j` and `p_a` become subscripts."""
    return re.sub(r"\b([A-Za-zφδ])_([A-Za-z]+)\b", r"\1<sub>\2</sub>", escape(text))


def paragraph(text: str, kind: str = "") -> str:
    """A paragraph of plain text."""
    return f"<p{_class(kind)}>{prose(text)}</p>"


def bullets(items: Iterable[str]) -> str:
    """A list of plain texts."""
    return "<ul>" + "".join(f"<li>{prose(item)}</li>" for item in items) + "</ul>"


def section(name: str, heading: str) -> str:
    """A heading with an anchor for the navigation."""
    return f'<h2 id="{name}">{prose(heading)}</h2>'


def table(content: TextTable, marked: Iterable[int] = ()) -> str:
    """A table. Columns of numbers are aligned to the right; the rows `marked` are highlighted."""
    kinds = ["n" if all(_is_number(row[k]) for row in content.rows) else "" for k in range(len(content.head))]
    head = "".join(f"<th{_class(kind)}>{prose(text)}</th>" for kind, text in zip(kinds, content.head, strict=True))
    chosen, lines = set(marked), []
    for number, row in enumerate(content.rows):
        cells = "".join(f"<td{_class(kind)}>{prose(text)}</td>" for kind, text in zip(kinds, row, strict=True))
        lines.append(f"<tr{_class('marked' if number in chosen else '')}>{cells}</tr>")
    return f'<div class="scroll"><table><thead><tr>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'


def picture(fig: Figure, caption: str, width: float | None = None) -> str:
    """A figure inside the page, as SVG, drawn for a `width` [inch] of its own if given."""
    if width is not None:
        fig.set_size_inches(width, width * fig.get_figheight() / fig.get_figwidth())
    buffer = io.BytesIO()
    fig.savefig(buffer, format="svg", metadata={"Date": None})
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    image = f'<img alt="{escape(caption)}" src="data:image/svg+xml;base64,{data}">'
    return f"<figure>{image}<figcaption>{prose(caption)}</figcaption></figure>"


def pair(first: str, second: str) -> str:
    """Two elements side by side."""
    return f'<div class="pair">{first}{second}</div>'


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""


def _is_number(text: str) -> bool:
    return bool(text) and all(letter in "0123456789.,+-−–×%e" for letter in text)
