"""Bearings that found no equilibrium, or no end, once."""

from __future__ import annotations

import math

import numpy as np
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
    """The bracket of the threshold lost its change of sign, and the search ended in a ValueError.

    With contact points a whirl grows at ratios of 0.03 to 6: all masses from 0.16 g to 6 kg whirl, and the critical
    mass is the smallest. It was the largest, beside a rotor of 0.18 kg whose mode grows.
    """
    case = Case.load(FAULTS / "verbs_5000.toml").replace(**{"model.contacts": contacts})
    found = petalfoil.stability(case)
    grows = bool(np.any(found.mode_growth_rate > 0.0))
    assert grows == (contacts == "points") == (found.critical_mass.item() < found.rotor_mass.item())
    assert grows == (0.0 < found.threshold_speed.item() < case.operation.speed)
    assert math.isinf(found.critical_mass.item()) == (contacts == "nodes")
    assert "jumps" in found.status.item()
