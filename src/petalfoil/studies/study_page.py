"""The page of a study: figures, what failed and why, and what was asked, from its labelled data alone."""

from __future__ import annotations

from html import escape
from pathlib import Path

import xarray as xr

from petalfoil import plot
from petalfoil.report import html
from petalfoil.report.page_tables import PageTable
from petalfoil.results.atomic import replacing
from petalfoil.studies import study_summary
from petalfoil.studies.study_store import FIGURES, PAGE

MOST_REASONS = 10
MOST_CASES = 6


def write_page(folder: Path, ds: xr.Dataset) -> None:
    """Write figures and page into the folder of a study."""
    (folder / FIGURES).mkdir(exist_ok=True)
    pictures = []
    for name, fig in plot.study_figures(ds).items():
        plot.save(fig, folder / FIGURES / f"{name}.png")
        pictures.append(html.picture(fig, name.replace("_", " ")))
    body = [
        f"<h1>{escape(str(ds.attrs['title']) or ds.attrs['analysis'])}</h1>",
        html.paragraph(study_summary.headline(ds)),
        *(html.table(PageTable(heads, lines)) for heads, lines in study_summary.tables(ds)),
        *pictures,
        *_failures(ds),
        html.section("asked", "What was asked"),
        html.bullets(study_summary.asked(ds)),
        html.section("case", "Base case"),
        f"<pre>{escape(str(ds.attrs['case']))}</pre>",
    ]
    with replacing(folder / PAGE) as temporary:
        temporary.write_text(html.page(str(ds.attrs["title"]) or "study", body), encoding="utf-8")


def _failures(ds: xr.Dataset) -> list[str]:
    told = study_summary.reasons(ds)
    if not told:
        return []
    most = list(told.items())[:MOST_REASONS]
    rows = tuple((f"{len(cases)}: {'; '.join(cases[:MOST_CASES])}", text) for text, cases in most)
    return [html.section("failed", "Cases without an answer"), html.table(PageTable(("cases", "reason"), rows))]
