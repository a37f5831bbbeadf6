"""Pieces of the page: what they say, and that they say it safely."""

from __future__ import annotations

import math

from petalfoil.report import html, tables
from petalfoil.report.study import Loads, Row, divided
from petalfoil.report.tables import Table
from petalfoil.report.variations import REFERENCE


def test_text_is_escaped_and_its_indices_set_low() -> None:
    assert html.prose("R_j < 1 & p_a") == "R<sub>j</sub> &lt; 1 &amp; p<sub>a</sub>"
    assert html.prose("figure6_7_flat.csv") == "figure6_7_flat.csv"


def test_columns_of_numbers_stand_to_the_right() -> None:
    page = html.table(Table(("what", "N"), (("a", "1.5"), ("b", "–"))), marked=[1])
    assert '<th>what</th><th class="n">N</th>' in page
    assert '<tr><td>a</td><td class="n">1.5</td></tr>' in page
    assert '<tr class="marked"><td>b</td><td class="n">–</td></tr>' in page


def test_a_row_of_the_study_tells_what_fits() -> None:
    few, many = Loads(6, (1.0, 2.0, 4.0), 10.0, 0.0), Loads(10, (1.7, 4.2, 10.0), 25.0, 0.3)
    row = Row(REFERENCE, (few, many))
    assert row.ratios == (1.7, 2.1, 2.5)
    assert (row.typical, row.push_ratio, row.share) == (2.1, 2.5, 0.3)
    assert row.twofold
    assert row.two_to_four
    (cells,) = tables.study((row,)).rows
    assert cells == (REFERENCE.says, "1.70", "2.10", "2.50", "2.50", "30%", "two-fold, 2–4")


def test_a_ratio_of_nothing_is_no_number() -> None:
    assert math.isnan(divided(3.0, 0.0))
    assert math.isnan(divided(-1.0, 2.0))
    assert tables.text(math.nan, 2) == "–"
