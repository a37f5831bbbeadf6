"""Small cases that were once refused or answered wrongly: read, and say what they say."""

from __future__ import annotations

import math

import pytest

from petalfoil.case import Case
from tests.cases import FAULTS

NAMES = sorted(path.stem for path in FAULTS.glob("*.toml"))


@pytest.mark.parametrize("name", NAMES)
def test_every_case_is_read(name: str) -> None:
    one = Case.load(FAULTS / f"{name}.toml")
    assert Case.from_toml(one.to_toml()) == one


ANSWERED = {
    "asperities_in_time": "regression/test_orbit_counts.py"
    "::test_a_motion_whose_balance_has_no_points_costs_what_contacts_at_nodes_cost",
    "dollar_title": "unit/plot/test_style.py::test_a_title_with_dollar_signs_is_drawn_as_it_stands",
    "escape_title": "unit/test_text.py::test_nothing_that_a_terminal_obeys_is_left",
    "flat_1072": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "flat_1083": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "flat_1091": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "flat_1103": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "flat_1160": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "flat_1248": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "flat_1300": "verification/test_hard_bearings.py::test_has_an_equilibrium",
    "free_shape_12_points": "unit/case/test_plausibility.py::test_a_table_stretched_to_reach_the_edge_is_warned_of",
    "free_shape_last_row_rounded": "verification/test_measured_shape.py"
    "::test_a_last_row_rounded_below_the_edge_is_solved",
    "krpm": "contract/test_faults.py::test_units_of_a_north_american_drawing",
    "ross_half_speed_whirl": "verification/test_ross_table.py::test_the_default_table_tells_the_growth_rate",
    "stress_14GPa": "unit/case/test_plausibility.py::test_fourteen_gigapascals_are_warned_of",
    "turbocharger": "verification/test_contact_slopes.py::test_stiffness_of_a_turbocharger_bearing_has_a_limit",
    "two_bearings_plain": "verification/test_two_bearings.py::test_the_conical_mode_loses_stability_first",
    "verbs_5000": "verification/test_hard_bearings.py::test_a_threshold_speed_where_equilibria_overlap",
    "verbs_5001": "verification/test_orbit_heat.py::test_a_random_bearing_whose_motion_hardly_ends_is_told",
    "zero_load": "verification/test_zero_load.py::test_the_journal_is_where_no_force_is",
}
"""Test of the right answer to each."""


def test_every_fault_has_a_test_of_its_answer() -> None:
    """Which reads the case: its file stands in the module, whole or with its number left open."""
    assert sorted(ANSWERED) == NAMES
    for name, test in ANSWERED.items():
        path, function = test.split("::")
        code = (FAULTS.parent / path).read_text(encoding="utf-8")
        stem, _, number = name.partition("_")
        assert f"def {function}(" in code, test
        assert f"{name}.toml" in code or (f'f"{stem}_{{number}}.toml"' in code and number in code), name


def test_units_of_a_north_american_drawing() -> None:
    one = Case.load(FAULTS / "krpm.toml")
    assert one.operation.speed == pytest.approx(1000.0 * math.pi, rel=1e-14)
    assert one.surface.contact_film_thickness == pytest.approx(20e-6 * 0.0254, rel=1e-14)
    assert one.operation.load == pytest.approx((0.0, -6.0 * 0.45359237 * 9.80665), rel=1e-14)
