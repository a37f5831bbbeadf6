"""Natural modes of a rotor over speed: their branches, and the speeds at which the unbalance meets one.

A branch keeps its place among the `BRANCHES` of all points: a mode belongs to the branch whose mode at the speed before
is nearest. A mode that is near none begins another branch; a branch without a mode has none at this speed (nan).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from petalfoil.results.record import Record

Floats = NDArray[np.float64]
Modes = Mapping[str, NDArray[Any]]
"""Results of modes by name, (k,) each."""

BRANCHES = 8
"""Most branches: a rotor in two bearings has four cylindrical and conical modes, and some of film and petals."""

LONGEST_STEP = 0.5
"""Relative distance of two modes beyond which one does not continue the other."""

SHAPE = 0.25
"""Weight of whirl direction and tilt in the distance of two modes: it parts branches that cross."""

CRITICAL = "critical_speed"


class Branches:
    """Places of the modes of each point among the branches.

    Attributes
    ----------
    before : dict of array
        Modes of the point before by branch, (BRANCHES,) each; nan where a branch has none.
    speed : float
        Its speed [rad/s]; nan before the first point.
    """

    def __init__(self) -> None:
        self.before: dict[str, Floats] = {}
        self.speed = float("nan")

    def placed(self, modes: Modes, speed: float) -> dict[str, Floats]:
        """The modes (k,) of the point at `speed` [rad/s] by branch, and the critical speeds since the one before."""
        places = self._places(modes, speed / self.speed)
        by_branch = {}
        for name, values in modes.items():
            column = np.full(BRANCHES, np.nan)
            column[places[places >= 0]] = values.astype(float)[places >= 0]
            by_branch[name] = column
        by_branch[CRITICAL] = self._critical(by_branch["natural_frequency"], speed)
        self.before, self.speed = by_branch, speed
        return by_branch

    def regain(self, record: Record) -> None:
        """Go on behind a stored point."""
        self.before = {name: values.astype(float) for name, values in record.fields.items()}
        self.speed = float(record.scalars["speed"])

    def _places(self, modes: Modes, faster: float) -> NDArray[np.intp]:
        """Branch of each mode; -1 for one beyond the last branch. `faster` is the speed over the one before."""
        from scipy.optimize import linear_sum_assignment  # 0.2 s: only where it is needed

        count = len(modes["natural_frequency"])
        places, free = np.full(count, -1), list(range(BRANCHES))
        if self.before:
            known = np.flatnonzero(np.isfinite(self.before["natural_frequency"].astype(float)))
            apart = distances({name: self.before[name].astype(float)[known] for name in modes}, modes, faster)
            for old, new in zip(*linear_sum_assignment(np.minimum(apart, 2.0 * LONGEST_STEP)), strict=True):
                if apart[old, new] < LONGEST_STEP:
                    places[new] = known[old]
            free = [k for k in free if k not in known] + [int(k) for k in known if k not in places]
        for new in np.flatnonzero(places < 0)[: len(free)]:
            places[new] = free.pop(0)
        return places

    def _critical(self, frequency: Floats, speed: float) -> Floats:
        """Speeds since the point before at which a mode has the frequency of the speed, on a straight line [rad/s]."""
        critical = np.full(BRANCHES, np.nan)
        if not self.before:
            return critical
        ahead = frequency.astype(float) - speed
        behind = self.before["natural_frequency"].astype(float) - self.speed
        crossed = np.isfinite(ahead) & np.isfinite(behind) & (np.sign(ahead) != np.sign(behind))
        share = behind[crossed] / (behind[crossed] - ahead[crossed])
        critical[crossed] = self.speed + share * (speed - self.speed)
        return critical


def distances(one: Modes, other: Modes, faster: float) -> Floats:
    """Distance of modes in frequency and growth rate, over their size, and in shape; (one, other) [1].

    Frequencies of petals hardly change with the speed, those of a film grow with it: both are expected, and the nearer
    one counts. `faster` is the factor between the speeds.
    """

    def between(name: str, factor: float = 1.0) -> Floats:
        difference: Floats = np.abs(factor * one[name].astype(float)[:, None] - other[name].astype(float)[None, :])
        return difference

    size = np.hypot(other["natural_frequency"].astype(float), other["mode_growth_rate"].astype(float))
    moved = np.minimum(between("natural_frequency"), between("natural_frequency", faster))
    apart = np.hypot(moved, between("mode_growth_rate")) / np.maximum(size, np.finfo(float).tiny)
    for shape in ("whirl_direction", "mode_tilt"):
        if shape in one and shape in other:
            apart = apart + SHAPE * between(shape)
    return np.asarray(apart)
