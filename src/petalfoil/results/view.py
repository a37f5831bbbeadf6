"""A result as a notebook shows it: the tables of the command line, in place of xarray's list of variables.

::

    result = petalfoil.balance(case, "20 N")
    result.petalfoil
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import zip_longest

import xarray as xr

from petalfoil.results.answer import Answer
from petalfoil.results.layout import Layout, Series, SinglePoint
from petalfoil.results.study import GridStudy
from petalfoil.results.tables import TextTable, tables_of


@xr.register_dataset_accessor("petalfoil")  # type: ignore[no-untyped-call]
class ResultView:
    """The accessor ``petalfoil`` of a dataset: its tables as text and as HTML.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of any analysis.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    def tables(self) -> tuple[TextTable, ...]:
        """The tables; none of a result that has other dimensions than points and grids."""
        layout = _layout(self._ds)
        return () if layout is None else tuple(tables_of(Answer.stored(self._ds, layout)))

    def __repr__(self) -> str:
        """The tables as lines of text."""
        lines = [self._heading()]
        for table in self.tables():
            head = [tuple(column.words for column in table.columns)] if table.columns else []
            lines += _aligned([*head, *table.lines])
        return "\n".join([*lines, *map("Warning: {}".format, self._warnings())])

    def _repr_html_(self) -> str:
        found = self.tables()
        if not found:
            return str(self._ds._repr_html_())
        warnings = "".join(f"<p>Warning: {escape(text)}</p>" for text in self._warnings())
        return f"<b>{escape(self._heading())}</b>{''.join(map(_html, found))}{warnings}"

    def _heading(self) -> str:
        return f"{self._ds.attrs.get('analysis', 'result')}: {self._ds.attrs.get('title', '')}".rstrip(": ")

    def _warnings(self) -> list[str]:
        return str(self._ds.attrs.get("warnings", "")).splitlines()


def _layout(ds: xr.Dataset) -> Layout | None:
    """The layout that the dimensions tell."""
    if "analysis" not in ds.attrs or {"load", "speed"} & set(map(str, ds.dims)):
        return None
    if "grid" in ds.dims:
        return GridStudy(conclude=lambda records: ())
    return Series() if "point" in ds.dims else SinglePoint()


def _aligned(rows: list[tuple[str, ...]]) -> Iterator[str]:
    """Rows with columns of one width: the first to the left, the others to the right."""
    widths = [max(map(len, column)) for column in zip_longest(*rows, fillvalue="")]
    for row in rows:
        cells = [text.rjust(width) for text, width in zip(row[1:], widths[1:], strict=False)]
        yield "  ".join([row[0].ljust(widths[0]), *cells]).rstrip()


def _html(table: TextTable) -> str:
    def cells(row: tuple[str, ...], tag: str) -> str:
        return "".join(f"<{tag}>{escape(text)}</{tag}>" for text in row)

    head = f"<tr>{cells(tuple(column.words for column in table.columns), 'th')}</tr>" if table.columns else ""
    rows = "".join(f"<tr>{cells(row, 'td')}</tr>" for row in table.lines)
    return f"<table>{head}{rows}</table>"
