"""What `stability` says first: whether a rotor of a mass is stable; and where the film is not modelled."""

from __future__ import annotations

import math

import pytest

from petalfoil.analysis.rotor_verdict import MassMargin, RotorVerdict
from petalfoil.analysis.threshold import beyond_the_model, told_with_mach
from petalfoil.dynamics.critical_mass import Whirl
from petalfoil.dynamics.natural_modes import Mode
from tests.cases import case

PLAIN = case("plain_journal", **{"operation.speed": "10000 rpm"})
PAIR = case("two_plain_bearings")


@pytest.mark.parametrize(
    ("mass", "critical", "words"),
    [
        (1.2, 73.4, "mass of 1.2 kg on this bearing: stable (critical mass 73.4 kg)"),
        (1.2, math.inf, "mass of 1.2 kg on this bearing: no mass is critical"),
        (80.0, 73.4, "mass of 80 kg on this bearing: unstable, whirls at about 4800 rpm (critical mass 73.4 kg)"),
        (math.nan, 73.4, "a rotor is stable up to the critical mass 73.4 kg"),
        (math.nan, 0.0, "unstable for any rotor mass"),
        (math.nan, math.inf, "no rotor mass is critical"),
    ],
)
def test_mass_and_critical_mass_make_the_verdict(mass: float, critical: float, words: str) -> None:
    assert RotorVerdict.of(PLAIN, Whirl(critical, 0.48), mass).verdict == words


def mode(s: complex) -> Mode:
    return Mode(s=s, participation=1.0, direction=1.0, tilt=0.0)


def test_a_mode_that_grows_decides() -> None:
    """No mass is critical where all are stable, and where none is."""
    decaying, growing = mode(-0.1 + 0.9j), mode(0.05 + 0.48j)
    free = Whirl(math.inf, math.nan)
    told = RotorVerdict.of(PLAIN, free, 2.0, [decaying]).verdict
    assert told == "mass of 2 kg on this bearing: stable (no mass is critical)"
    told = RotorVerdict.of(PLAIN, free, 2.0, [decaying, growing]).verdict
    assert told == "mass of 2 kg on this bearing: unstable, whirls at about 4800 rpm (no mass is critical)"


def test_the_margin_is_a_ratio_of_masses() -> None:
    assert MassMargin.of(Whirl(3.0, 0.5), 2.0).mass_margin == 1.5
    assert MassMargin.of(Whirl(3.0, 0.5), math.nan).mass_margin is None


def test_two_bearings_carry_a_rotor() -> None:
    assert RotorVerdict.of(PAIR, Whirl(9.0, 0.5), 4.0).verdict == "rotor of 4 kg: stable (critical mass 9 kg)"


def test_speeds_past_the_model_are_told() -> None:
    sound, radius = math.sqrt(1.4 * PLAIN.gas.gas_constant * PLAIN.gas.temperature), PLAIN.bearing.journal_radius
    assert beyond_the_model(PLAIN, 0.69 * sound / radius) == ""
    assert "Mach 3.6 there" in beyond_the_model(PLAIN, 3.6 * sound / radius)
    assert beyond_the_model(PLAIN, math.nan) == ""
    fast = 3.6 * sound / radius
    assert told_with_mach(PLAIN, fast, "") == f"threshold speed: {beyond_the_model(PLAIN, fast)}"
    assert told_with_mach(PLAIN, fast, "the mass jumps") == f"the mass jumps, and {beyond_the_model(PLAIN, fast)}"
    assert told_with_mach(PLAIN, math.nan, "no threshold speed") == "no threshold speed"
