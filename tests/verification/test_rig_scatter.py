"""The rig's lift-off speed for petals that are 5 um thinner and thicker, on the grid of its case file."""

from __future__ import annotations

import pytest

import petalfoil
from petalfoil.case import Case
from tests.cases import EXAMPLES

LOAD = 46.4
"""Of the paper's first experiment [N]."""


@pytest.mark.slow
def test_five_micrometres_of_thickness_change_the_lift_off_speed_by_a_factor_of_two() -> None:
    """Thicker petals fill the clearance: two thirds more speed than nominal, twice that of thinner ones."""
    rig = Case.load(EXAMPLES / "rig.toml")
    thin, own, thick = (
        float(
            petalfoil.liftoff(rig.replace(**{"petals.thickness": rig.petals.thickness + change}), loads=LOAD)[
                "liftoff_speed"
            ].item()
        )
        for change in (-5e-6, 0.0, 5e-6)
    )
    assert thick / thin == pytest.approx(2.0, rel=0.05)
    assert thick / own == pytest.approx(5.0 / 3.0, rel=0.03)
