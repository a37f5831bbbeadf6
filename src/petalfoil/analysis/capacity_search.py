"""The largest loads over direction and speed, each from the state of the one before."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from petalfoil.analysis.load_limit import NONE_KEPT, Capacity, largest_load
from petalfoil.analysis.load_ray import LEAST, Limits, LoadRay
from petalfoil.analysis.operating_point import at
from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.results.record import Array
from petalfoil.solvers.near_factor import FactorAtHand

FIRST = 0.1
"""First load that is looked at, over ambient pressure times length times diameter."""
STILL_BEYOND = "is beyond its limit under the load that came nearest to it at the speed before"
"""What is said of a speed at which no load keeps to the limits, after one where none does either."""
SMALLEST = 1.0 + 1e-9
"""Load over the smallest one that is looked at, up to which it is that one: it is followed to rounding."""
STEEPEST = 2.0
"""Largest power of the speed by which a first load at another speed is foretold."""


@dataclass(frozen=True)
class CapacityRequest:
    """Limits, and the directions of the load [rad]."""

    limits: Limits
    directions: Array


@dataclass
class CapacitySearch:
    """The searches of one bearing, each from the state of the one before.

    Attributes
    ----------
    case : Case
        The bearing.
    asked : CapacityRequest
        Limits and directions.
    known : dict
        State at the capacity by direction, of the speed before.
    loads : dict
        By direction, the last two speeds [rad/s] and capacities [N], and by how much the capacity grows with the speed
        there, logarithm over logarithm.
    beyond : dict
        By direction, where no load kept to the limits at the speed before: the load that came nearest [N], its state.
    hand : FactorAtHand
        The last factor of a search for a limit.
    """

    case: Case
    asked: CapacityRequest
    known: dict[float, Solution] = field(default_factory=dict)
    loads: dict[float, list[tuple[float, float, float]]] = field(default_factory=dict)
    beyond: dict[float, tuple[float, Solution]] = field(default_factory=dict)
    hand: FactorAtHand = field(default_factory=FactorAtHand)

    def at(self, speed: float) -> list[Capacity]:
        """The capacity in each direction at a speed [rad/s]."""
        here, found = at(self.case, speed, (0.0, 0.0)), []
        beside: tuple[float, Solution] | None = None
        for angle in map(float, self.asked.directions):
            direction = (round(math.cos(angle), 15), round(math.sin(angle), 15))
            ray = LoadRay(here, direction, self.asked.limits, points_alone=True, hand=self.hand)
            capacity = self.still_none(angle, ray) or self.sought(angle, ray, beside)
            if capacity.at is not None:
                beside = capacity.at.size, capacity.at.found.answer
                self.known[angle] = beside[1]
                self.loads[angle] = [*self.loads.get(angle, [])[-1:], (speed, beside[0], ray.growth(capacity.at))]
            found.append(replace(capacity, sought_anew=ray.lost))
        return found

    def sought(self, angle: float, ray: LoadRay, beside: tuple[float, Solution] | None) -> Capacity:
        """The capacity by a search from that at the speed before, else in the direction `beside`, else from nothing."""
        start = (self.guess(angle, ray.case.operation.speed), self.known[angle]) if angle in self.known else beside
        ray.start_from(None if start is None else start[1])
        capacity = largest_load(ray, FIRST * ray.unit if start is None else start[0])
        if capacity.at is None and ray.nearest is not None:
            self.beyond[angle] = ray.nearest.size, ray.nearest.found.answer
            self.known.pop(angle, None)
        return capacity

    def still_none(self, angle: float, ray: LoadRay) -> Capacity | None:
        """That no load keeps to the limits, as at the speed before; None where that is not known.

        It is looked at where it came nearest: if that load is beyond its limit still, the others are.
        """
        if angle not in self.beyond:
            return None
        size, state = self.beyond.pop(angle)
        ray.start_from(state)
        nearest = ray.under_known_load() or ray.at(size, by_nodes=True)
        if isinstance(nearest, str):
            return None
        if nearest.margin >= 0.0:  # from there the search begins
            self.known[angle] = nearest.found.answer
            self.loads[angle] = [(ray.case.operation.speed, size, math.nan)]
            return None
        self.beyond[angle] = size, nearest.found.answer
        least = nearest if size <= SMALLEST * LEAST * ray.unit else None
        return Capacity(None, f"{NONE_KEPT}: {nearest.limit} {STILL_BEYOND}", smallest=least)

    def guess(self, angle: float, speed: float) -> float:
        """The capacity at a speed by the power law of the last one, which changes as between the last two [N]."""
        *earlier, (before, size, growth) = self.loads[angle]
        step, bend = math.log(speed / before), 0.0
        if earlier and earlier[0][0] != before:
            apart = math.log(before / earlier[0][0])
            mean = math.log(size / earlier[0][1]) / apart
            growth = mean if math.isnan(growth) else growth
            bend = 2.0 * (growth - mean) / apart
        exponent = 0.0 if math.isnan(growth) else growth + 0.5 * bend * step
        return size * float((speed / before) ** min(max(exponent, -STEEPEST), STEEPEST))
