"""Bearings that found no equilibrium, or no end, once."""

from __future__ import annotations

import math

import pytest

import petalfoil
from petalfoil.analysis.solve import point
from petalfoil.case import Case
from tests.cases import FAULTS


@pytest.mark.parametrize(
    "number",
    [
        1083,  # a film that asked for a negative pressure behind a contact
        1091,  # a contact tied to a node that rounding blurs
        pytest.param(1248, marks=pytest.mark.slow),  # unstable in the time of the gas, at rest with a damped wall
        pytest.param(1072, marks=pytest.mark.slow),
        pytest.param(1103, marks=pytest.mark.slow),
        pytest.param(1160, marks=pytest.mark.slow),
        pytest.param(1300, marks=pytest.mark.slow),
    ],
)
def test_has_an_equilibrium(number: int) -> None:
    """With contacts at nodes, which are what is looked for; contact points begin there."""
    found = point(Case.load(FAULTS / f"flat_{number}.toml").replace(**{"model.contacts": "nodes"})).scalars
    assert found["residual"] <= 1e-10  # type: ignore[operator]
    assert found["mass_balance_error"] <= 1e-9  # type: ignore[operator]
    assert found["reaction_balance_error"] <= 1e-9  # type: ignore[operator]
    assert 0.0 <= found["contact_fraction"] <= 1.0  # type: ignore[operator]


@pytest.mark.slow
@pytest.mark.parametrize("contacts", ["nodes", "points"])
def test_a_threshold_speed_where_equilibria_overlap(contacts: str) -> None:
    """The bracket of the threshold lost its change of sign, and the search ended in a ValueError."""
    found = petalfoil.stability(Case.load(FAULTS / "verbs_5000.toml").replace(**{"model.contacts": contacts}))
    assert found.threshold_speed.item() > 0.0
    assert math.isinf(found.critical_mass.item()) == (contacts == "nodes")
    assert "jumps" in found.status.item()
