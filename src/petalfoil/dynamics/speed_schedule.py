"""Speed of the shaft over time: straight pieces, constant before the first and after the last."""

from __future__ import annotations

from dataclasses import dataclass

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

    def speed(self, t: float) -> float:
        """Angular speed at `t` [rad/s]."""
        return float(np.interp(t, self.times, self.speeds))

    def acceleration(self, t: float) -> float:
        """Angular acceleration just after `t` [rad/s^2]."""
        k = int(np.searchsorted(self.times, t, side="right"))
        if k == 0 or k == len(self.times):
            return 0.0
        return float((self.speeds[k] - self.speeds[k - 1]) / (self.times[k] - self.times[k - 1]))

    def angle(self, t: float) -> float:
        """Angle turned since time zero [rad]; exact."""
        return self._turned(t) - self._turned(0.0)

    def _turned(self, t: float) -> float:
        """Angle turned since the first instant [rad]."""
        first = self.times[0]
        if t <= first:
            return float((t - first) * self.speeds[0])
        inside = self.times[(self.times > first) & (self.times < t)]
        knots = np.concatenate([[first], inside, [t]])
        at = np.interp(knots, self.times, self.speeds)
        return float(np.sum(0.5 * (at[1:] + at[:-1]) * np.diff(knots)))

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
