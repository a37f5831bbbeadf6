"""An answer as tables of text: what the terminal prints, a page shows and a file holds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from petalfoil.analysis import known_verbs
from petalfoil.analysis.coefficient_tables import TABLES
from petalfoil.analysis.declaration import Analysis
from petalfoil.results.answer import Answer
from petalfoil.results.layout import Series, SinglePoint
from petalfoil.results.record import Record
from petalfoil.results.summary import rows
from petalfoil.results.tables import TextColumn, TextTable, tables_of
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


def point(speed: float, **more: float | str) -> Record:
    """A point of a series."""
    return Record(analysis="curve", title="", scalars={"speed": speed, "converged": True, **more})


def told(*records: Record) -> list[tuple[str, ...]]:
    """Lines below the table of a series."""
    _, *below = tables_of(Answer(verb="curve", layout=Series(), records=records))
    return [line for table in below for line in table.lines]


def test_a_series_tells_the_path_of_its_friction() -> None:
    """Once for all points; which points where they differ; nothing without friction."""
    assert told(point(1.0), point(2.0)) == []
    assert told(point(1.0, friction_path="relaxed"), point(2.0, friction_path="relaxed")) == [
        ("petal friction", "relaxed", "")
    ]
    assert told(point(1.0, friction_path="assembled"), point(2.0, friction_path="relaxed")) == [
        ("petal friction", "assembled (points 1)", ""),
        ("petal friction", "relaxed (points 2)", ""),
    ]


def matrices(**more: float) -> Record:
    """Stiffness at one frequency, of a journal that tilts where entries of the other blocks are given."""
    blocks = {"stiffness": 1e6, "damping": 2.0, **more}
    fields = {name: value * np.array([[[1.0, 0.1], [0.2, 1.0]]]) for name, value in blocks.items()}
    coords = {"whirl_frequency": np.array([500.0]), "row": np.arange(2), "column": np.arange(2)}
    return Record(
        analysis="coefficients", title="", scalars={"speed": 1e3, "converged": True}, fields=fields, coords=coords
    )


def headed(record: Record) -> list[TextTable]:
    """Tables with columns."""
    layout = SinglePoint(array_tables=TABLES)
    return [
        table for table in tables_of(Answer(verb="coefficients", layout=layout, records=(record,))) if table.columns
    ]


def test_coefficients_of_a_journal_that_tilts_have_a_table_for_each_block() -> None:
    """Entries that couple displacement and slopes are there, and 0 where they are rounding."""
    assert verb("coefficients").layouts  # declares the fields
    (alone,) = headed(matrices())
    assert alone.title == ""
    others = {"force_tilt": 1e-9, "moment_displacement": 30.0, "moment_tilt": 400.0}
    tilting = headed(matrices(**{f"stiffness_{name}": value for name, value in others.items()}))
    assert [table.columns[3].words for table in tilting] == [f"{name} N{unit}" for name, unit in UNITS]
    assert [table.lines[0][3] for table in tilting] == ["1000000", "0", "30.00", "400.0"]
    assert all(table.title for table in tilting)
    assert tilting[0].lines == alone.lines


UNITS = (("K_xx", "/m"), ("K_xa", ""), ("K_ax", ""), ("K_aa", " m"))
