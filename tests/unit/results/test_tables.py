"""An answer as tables of text: what the terminal prints, a page shows and a file holds."""

from __future__ import annotations

from dataclasses import replace

from petalfoil.analysis import known_verbs
from petalfoil.analysis.declaration import Analysis
from petalfoil.results.summary import rows
from petalfoil.results.tables import TextColumn, tables_of
from tests.cases import case


def verb(name: str) -> Analysis:
    found = known_verbs.find(name)
    assert found is not None
    return found


def test_a_point_gives_the_lines_of_the_printed_table() -> None:
    check = verb("check")
    run = check.start(case("paper_n8"), {})
    (table,) = tables_of(check.answer(run))
    assert table.columns == ()
    assert table.lines == [tuple(row) for row in rows(run.records()[0])]


def test_a_series_gives_a_line_for_each_point() -> None:
    curve = verb("curve")
    run = curve.start(case("plain_journal", **{"model.kind": "2d"}), {"eccentricities": [0.0, 5e-6]})
    for _ in curve.advance(run):
        pass
    (table,) = tables_of(curve.answer(run))
    assert [line[0] for line in table.lines] == ["1", "2"]
    assert all(len(line) == len(table.columns) for line in table.lines)


def test_a_series_shows_no_bar_of_rounding() -> None:
    """A displacement of 1e-21 m is 0 at every point, as in the table of a single point."""
    curve = verb("curve")
    run = curve.start(case("plain_journal", **{"model.kind": "2d"}), {"eccentricities": [0.0, 5e-6]})
    for _ in curve.advance(run):
        pass
    answer = curve.answer(run)
    rounding, bars = {"eccentricity_x": 1e-21}, {"eccentricity_x": 1e-20, "peak_pressure": 2e3}
    records = [replace(record, scalars=record.scalars | rounding, errors=bars) for record in answer.records]
    (table,) = tables_of(replace(answer, records=tuple(records)))
    place = [column.words for column in table.columns].index("e_x [µm]")
    assert [line[place] for line in table.lines] == ["0", "0"]
    assert sum("±" in cell for line in table.lines for cell in line) == 2


def test_the_words_of_a_column_are_one_line() -> None:
    assert TextColumn("contact\nfraction", "%").words == "contact fraction [%]"
    assert TextColumn("point").words == "point"
