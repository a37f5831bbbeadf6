"""What `stability` says first: whether the rotor is stable, and by how much."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from petalfoil.case import Case
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

        Modes that grow decide, where there are modes. Without them a rotor whose whirl is neutral at no mass is called
        neither: its stability is then the same for all masses.
        """
        critical = f"critical mass {whirl.mass:.4g} kg" if math.isfinite(whirl.mass) else "no mass is critical"
        if math.isnan(mass):
            beyond = {0.0: "unstable for any rotor mass", math.inf: "no rotor mass is critical"}
            return cls(beyond.get(whirl.mass, f"a rotor is stable up to the {critical}"))
        carried = f"mass of {mass:.4g} kg on this bearing" if case.bearings == 1 else f"rotor of {mass:.4g} kg"
        growing = max((mode for mode in modes or () if mode.s.real > 0.0), key=lambda mode: mode.s.real, default=None)
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


def is_stable(record: Record) -> bool:
    """Whether the rotor of a point of a Campbell diagram is stable: below the critical mass, and no mode grows."""
    heavy = float(record.scalars["critical_mass"]) <= float(record.scalars["rotor_mass"])
    return not heavy and not np.any(np.asarray(record.fields["mode_growth_rate"], dtype=np.float64) > 0.0)
