"""What `stability` says first: whether the rotor is stable, and by how much."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from petalfoil.case import NEUTRAL, NEUTRAL_DAMPING, Case, neutral
from petalfoil.dynamics.critical_mass import Whirl
from petalfoil.dynamics.natural_modes import Mode
from petalfoil.results.record import Record

RPM = 30.0 / math.pi


@dataclass(frozen=True)
class RotorVerdict:
    """Whether the rotor is stable, in words."""

    verdict: str

    @classmethod
    def of(cls, case: Case, whirl: Whirl, mass: float, modes: Sequence[Mode] | None = None) -> RotorVerdict:
        """That of a rotor of `mass` [kg] at the case's speed, of any rotor where that is nan.

        Modes that grow decide, where there are modes, then those that are neutral. Without them a rotor whose whirl is
        neutral at no mass is called neither: its stability is then the same for all masses.
        """
        critical = f"critical mass {whirl.mass:.4g} kg" if math.isfinite(whirl.mass) else "no mass is critical"
        if math.isnan(mass):
            beyond = {0.0: "unstable for any rotor mass", math.inf: "no rotor mass is critical"}
            return cls(beyond.get(whirl.mass, f"a rotor is stable up to the {critical}"))
        carried = f"mass of {mass:.4g} kg on this bearing" if case.bearings == 1 else f"rotor of {mass:.4g} kg"
        least = min(modes or (), key=lambda mode: mode.damping_ratio, default=None)
        if least is not None and least.is_neutral:
            growth, hertz = (part * case.operation.speed for part in (least.s.real, least.s.imag / (2.0 * math.pi)))
            return cls(f"{carried}: {NEUTRAL}, growth rate {growth:.2g} 1/s at {hertz:.4g} Hz ({critical})")
        growing = max((mode for mode in modes or () if mode.grows), key=lambda mode: mode.s.real, default=None)
        if growing is None and whirl.mass > mass:
            known = modes is not None or math.isfinite(whirl.mass)
            return cls(f"{carried}: stable ({critical})" if known else f"{carried}: {critical}")
        ratio = whirl.ratio if growing is None else float(growing.s.imag)
        whirling = "" if math.isnan(ratio) else f", whirls at about {ratio * case.operation.speed * RPM:.0f} rpm"
        return cls(f"{carried}: unstable{whirling} ({critical})")


@dataclass(frozen=True)
class MassMargin:
    """Critical mass over the mass of the rotor; None where nothing tells its mass."""

    mass_margin: float | None

    @classmethod
    def of(cls, whirl: Whirl, mass: float) -> MassMargin:
        """That of a rotor of `mass` [kg]; nan where nothing tells it."""
        return cls(None if math.isnan(mass) else whirl.mass / mass)


def stability_of(record: Record) -> str:
    """Whether the rotor of a point of a Campbell diagram is stable, neutral or unstable.

    The mode that is damped least decides; a rotor above the critical mass is unstable all the same.
    """
    heavy = float(record.scalars["critical_mass"]) <= float(record.scalars["rotor_mass"])
    ratios = np.asarray(record.fields["damping_ratio"], dtype=np.float64)
    least = float(np.nanmin(ratios, initial=np.inf))
    if abs(least) < NEUTRAL_DAMPING:
        return NEUTRAL
    return "unstable" if heavy or least < 0.0 else "stable"


def neutral_by_error(record: Record) -> Record:
    """The record with a verdict that says neutral where error bars of growth rates leave open whether a mode grows."""
    growth, bar = (record.fields.get(name) for name in ("mode_growth_rate", "mode_growth_rate_error"))
    told = str(record.scalars.get("verdict", ""))
    if growth is None or bar is None or not np.size(growth) or not told or NEUTRAL in told:
        return record
    rate, error = (np.asarray(values, dtype=np.float64) for values in (growth, bar))
    if np.any(rate - error > 0.0) or not np.any(rate + error > 0.0):
        return record
    least = int(np.nanargmax(rate + error))
    hertz = float(record.fields["natural_frequency"][least]) / (2.0 * math.pi)
    words = f"{NEUTRAL} within its error bar, growth rate {rate[least]:.2g} ± {error[least]:.2g} 1/s at {hertz:.4g} Hz"
    verdict = f"{told.partition(': ')[0]}: {words}"
    scalars = {**record.scalars, "verdict": verdict}
    return replace(record, scalars=scalars, warnings=(*record.warnings, *neutral(scalars)))
