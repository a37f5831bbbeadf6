"""What `stability` says first: whether a rotor of a mass is stable; and where the film is not modelled."""

from __future__ import annotations

import math

import numpy as np
import pytest

from petalfoil.analysis.rotor_verdict import MassMargin, RotorVerdict, neutral_by_error, stability_of
from petalfoil.analysis.threshold import beyond_the_model, told_with_mach
from petalfoil.dynamics.critical_mass import Whirl
from petalfoil.dynamics.natural_modes import Mode
from petalfoil.results import Record
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


@pytest.mark.parametrize("growth", [-0.9e-4, 0.9e-4])
def test_a_mode_that_hardly_grows_or_decays_is_neutral(growth: float) -> None:
    """Damping ratios within 1e-4 of zero, unless another mode grows by more."""
    free, hardly = Whirl(math.inf, math.nan), mode(complex(growth, 1.0))
    speed = PLAIN.operation.speed
    told = f"neutral, growth rate {growth * speed:.2g} 1/s at {speed / (2.0 * math.pi):.4g} Hz (no mass is critical)"
    assert RotorVerdict.of(PLAIN, free, 2.0, [hardly, mode(-0.1 + 0.9j)]).verdict.endswith(f": {told}")
    assert "unstable, whirls at" in RotorVerdict.of(PLAIN, free, 2.0, [hardly, mode(1.1e-4 + 1.0j)]).verdict
    assert "stable (no" in RotorVerdict.of(PLAIN, free, 2.0, [mode(-1.1e-4 + 1.0j)]).verdict


def rotor_with(growth: list[float], bars: list[float] | None = None, critical: float = math.inf) -> Record:
    frequency = np.full(len(growth), 1e4)
    fields = {"mode_growth_rate": np.array(growth), "natural_frequency": frequency,
              "damping_ratio": -np.array(growth) / frequency}  # fmt: skip
    if bars is not None:
        fields["mode_growth_rate_error"] = np.array(bars)
    scalars = {"verdict": "rotor of 4 kg: stable (no mass is critical)", "critical_mass": critical, "rotor_mass": 2.0}
    return Record(analysis="stability", scalars=scalars, fields=fields, coords={"mode": np.arange(1, len(growth) + 1)})


@pytest.mark.parametrize(
    ("growth", "critical", "told"),
    [([-5.0, -3.0], math.inf, "stable"), ([-5.0, -0.9], math.inf, "neutral"), ([-5.0, 0.9], 1.0, "neutral"),
     ([0.9, 5.0], math.inf, "unstable"), ([-5.0], 1.0, "unstable"), ([math.nan], 3.0, "stable")],
)  # fmt: skip
def test_a_point_of_a_campbell_diagram_is_stable_neutral_or_unstable(
    growth: list[float], critical: float, told: str
) -> None:
    assert stability_of(rotor_with(growth, critical=critical)) == told


@pytest.mark.parametrize(
    ("growth", "bars", "neutral"),
    [([-5.0, -3.0], [1.0, 2.0], False), ([-5.0, -3.0], [1.0, 4.0], True), ([3.0, -5.0], [4.0, 1.0], True),
     ([3.0, -5.0], [2.0, 9.0], False), ([-5.0, -3.0], [math.nan, 4.0], True)],
)  # fmt: skip
def test_error_bars_that_leave_open_whether_a_mode_grows_make_it_neutral(
    growth: list[float], bars: list[float], neutral: bool
) -> None:
    told = neutral_by_error(rotor_with(growth, bars))
    assert ("neutral within its error bar" in str(told.scalars["verdict"])) is neutral
    assert str(told.scalars["verdict"]).startswith("rotor of 4 kg: ")
    assert any("structural damping" in warning for warning in told.warnings) is neutral


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
