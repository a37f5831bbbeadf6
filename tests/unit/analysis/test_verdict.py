"""What `stability` says first: whether a rotor of a mass is stable; and where the film is not modelled."""

from __future__ import annotations

import math

import pytest

from petalfoil.analysis.stability import RotorVerdict
from petalfoil.analysis.threshold import beyond_the_model
from petalfoil.dynamics.critical_mass import Whirl
from tests.cases import case

PLAIN = case("plain_journal", **{"operation.speed": "10000 rpm"})
PAIR = case("two_plain_bearings")


@pytest.mark.parametrize(
    ("mass", "critical", "words"),
    [
        (1.2, 73.4, "mass of 1.2 kg on this bearing: stable (critical mass 73.4 kg)"),
        (1.2, math.inf, "mass of 1.2 kg on this bearing: stable (as for any mass)"),
        (80.0, 73.4, "mass of 80 kg on this bearing: unstable, whirls at about 4800 rpm (critical mass 73.4 kg)"),
        (math.nan, 73.4, "a rotor is stable up to the critical mass 73.4 kg"),
        (math.nan, 0.0, "unstable for any rotor mass"),
        (math.nan, math.inf, "stable for any rotor mass"),
    ],
)
def test_mass_and_critical_mass_make_the_verdict(mass: float, critical: float, words: str) -> None:
    assert RotorVerdict.of(PLAIN, Whirl(critical, 0.48), mass).verdict == words


def test_two_bearings_carry_a_rotor() -> None:
    assert RotorVerdict.of(PAIR, Whirl(9.0, 0.5), 4.0).verdict == "rotor of 4 kg: stable (critical mass 9 kg)"


def test_speeds_past_the_model_are_told() -> None:
    sound, radius = math.sqrt(1.4 * PLAIN.gas.gas_constant * PLAIN.gas.temperature), PLAIN.bearing.journal_radius
    assert beyond_the_model(PLAIN, 0.69 * sound / radius) == ""
    assert "Mach 3.6 there" in beyond_the_model(PLAIN, 3.6 * sound / radius)
    assert beyond_the_model(PLAIN, math.nan) == ""
