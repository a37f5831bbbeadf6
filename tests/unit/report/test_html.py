"""Elements of the page: text, tables, escapes."""

from __future__ import annotations

import math

from petalfoil.report import html, page_tables
from petalfoil.report.assumptions import REFERENCE, AssumptionResult, PackLoads, ratio
from petalfoil.report.page_tables import PageTable


def test_text_is_escaped_and_its_indices_set_low() -> None:
    assert html.prose("R_j < 1 & p_a") == "R<sub>j</sub> &lt; 1 &amp; p<sub>a</sub>"
    assert html.prose("figure6_7_2d.csv") == "figure6_7_2d.csv"


def test_columns_of_numbers_stand_to_the_right() -> None:
    page = html.table(PageTable(("what", "N"), (("a", "1.5"), ("b", "–"))), marked=[1])
    assert '<th>what</th><th class="n">N</th>' in page
    assert '<tr><td>a</td><td class="n">1.5</td></tr>' in page
    assert '<tr class="marked"><td>b</td><td class="n">–</td></tr>' in page


def test_the_row_of_an_assumption_names_the_claims_it_agrees_with() -> None:
    few, many = PackLoads(6, (1.0, 2.0, 4.0), 10.0, 0.0), PackLoads(10, (1.7, 4.2, 10.0), 25.0, 0.3)
    row = AssumptionResult(REFERENCE, (few, many))
    assert row.ratios == (1.7, 2.1, 2.5)
    assert (row.median_ratio, row.normal_force_ratio, row.contact_fraction) == (2.1, 2.5, 0.3)
    assert row.twofold
    assert row.two_to_four
    (cells,) = page_tables.assumption_ratios((row,)).rows
    assert cells == (REFERENCE.description, "1.70", "2.10", "2.50", "2.50", "30%", "two-fold, 2–4")


def test_the_ratio_to_a_load_that_is_not_positive_is_nan() -> None:
    assert math.isnan(ratio(3.0, 0.0))
    assert math.isnan(ratio(-1.0, 2.0))
    assert page_tables.text(math.nan, 2) == "–"
