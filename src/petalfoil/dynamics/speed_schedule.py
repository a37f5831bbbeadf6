"""Speed of the shaft over time: straight pieces, constant before the first and after the last."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from petalfoil.errors import UsageError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Schedule:
    """Speeds at instants, straight lines between them.

    Attributes
    ----------
    times : (k,) array
        Instants, increasing [s].
    speeds : (k,) array
        Angular speeds there [rad/s].
    """

    times: Array
    speeds: Array

    @classmethod
    def through(cls, points: list[tuple[float, float]]) -> Schedule:
        """A schedule through (time [s], speed [rad/s]).

        Raises
        ------
        UsageError
            Time goes back or stands still, a speed is negative or not a number, or there is no point.
        """
        if not points:
            raise UsageError("a speed schedule needs at least one point, a pair (time, speed)")
        times, speeds = np.array(points, dtype=np.float64).T
        if not (np.all(np.isfinite(times)) and np.all(np.isfinite(speeds))):
            raise UsageError(f"a speed schedule needs finite times and speeds, got {times.tolist()}, {speeds.tolist()}")
        if np.any(np.diff(times) <= 0.0):
            late = int(np.argmax(np.diff(times) <= 0.0))
            raise UsageError(
                f"the speed schedule goes back in time: {times[late + 1]:g} s comes after {times[late]:g} s; give "
                "each time once, the later after the earlier"
            )
        if np.any(speeds < 0.0):
            raise UsageError(f"the speed schedule has a negative speed, {speeds.min():g} rad/s; allowed: 0 or more")
        return cls(times, speeds)

    @property
    def top(self) -> float:
        """Highest speed [rad/s]."""
        return float(self.speeds.max())

    @cached_property
    def _knots(self) -> tuple[list[float], list[float], list[float]]:
        """Instants [s], speeds there [rad/s] and angles turned since the first [rad].

        Steps in time ask for them often: plain numbers take a tenth of what arrays of one take.
        """
        times, speeds = self.times.tolist(), self.speeds.tolist()
        pieces = zip(pairwise(times), pairwise(speeds), strict=True)
        angles = accumulate((0.5 * (w0 + w1) * (t1 - t0) for (t0, t1), (w0, w1) in pieces), initial=0.0)
        return times, speeds, list(angles)

    def speed(self, t: float) -> float:
        """Angular speed at `t` [rad/s]."""
        times, speeds, _ = self._knots
        k = bisect_right(times, t)
        return speeds[k - 1] + self.acceleration(t) * (t - times[k - 1]) if k else speeds[0]

    def acceleration(self, t: float) -> float:
        """Angular acceleration just after `t` [rad/s^2]."""
        times, speeds, _ = self._knots
        k = bisect_right(times, t)
        return 0.0 if k in (0, len(times)) else (speeds[k] - speeds[k - 1]) / (times[k] - times[k - 1])

    def angle(self, t: float) -> float:
        """Angle turned since time zero [rad]; exact."""
        return self._turned(t) - self._turned(0.0)

    def _turned(self, t: float) -> float:
        """Angle turned since the first instant [rad]."""
        times, speeds, angles = self._knots
        k = max(bisect_right(times, t) - 1, 0)
        return angles[k] + 0.5 * (speeds[k] + self.speed(t)) * (t - times[k])

    def instant(self, angle: float) -> float:
        """Time at which the shaft has turned by `angle` [s]; infinite if it never does."""
        if angle <= 0.0:
            return 0.0
        knots = [t for t in self.times if t > 0.0]
        start = 0.0
        for knot in [*knots, np.inf]:
            w, a, turned = self.speed(start), self.acceleration(start), self.angle(start)
            left = angle - turned
            reach = root(w, a, left)
            if start + reach <= knot:
                return start + reach
            start = float(knot)
        return float("inf")


def root(w: float, a: float, left: float) -> float:
    """Time after which `w t + a t^2 / 2` is `left`; infinite if never."""
    if a == 0.0:
        return left / w if w > 0.0 else float("inf")
    under = w * w + 2.0 * a * left
    return 2.0 * left / (w + float(np.sqrt(under))) if under >= 0.0 and w + np.sqrt(under) > 0.0 else float("inf")
