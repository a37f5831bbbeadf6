"""A rigid shaft in two bearings that do not share its load evenly: unequal, askew, or not equally far from it (O7).

    F_1 + F_2 + F = 0,    sum_k (z_k F_k + M_k) + M = 0

with the places `z_k` of the bearings from the mass centre, their forces and moments on the journals, and the load. The
shaft's position is `q = (x, y, a_x, a_y)`; the journal in bearing `k` is at `(x, y) + z_k a` and has the slopes `a` on
top of those at which the bearing stands askew. Each bearing alone under its part of the load by statics is the start;
Newton's method on `q` follows, both bearings being in equilibrium at each of its steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.heat_results import network_in_time
from petalfoil.analysis.support import Support
from petalfoil.analysis.tilted_journal import at_same_state
from petalfoil.case import Case, Which
from petalfoil.dynamics.rotor_motion import moment_on_rotor
from petalfoil.equilibrium.heated import heated
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import FORCE_TOLERANCE
from petalfoil.equilibrium.whole_length import balance_from_nothing
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem
from petalfoil.system.heat_network import HeatNetwork
from petalfoil.system.loaded import LEAST_LOAD
from petalfoil.system.temperatures import Temperatures

Array = NDArray[np.float64]
Vector = tuple[float, float]

STEPS = 40
"""Newton steps of the shaft: four to six are the rule."""

FARTHEST = 1.0
"""Longest move of a journal in a step, in reference films."""

SMALLER = 0.25
"""Part of a step that is tried where the whole one leads to no equilibrium."""

INCLINED = (1.0, 0.25, 0.0)
"""Parts of the slope through both journals alone at which the shaft is tried first."""

ORDINALS = ("first", "second")


@dataclass(frozen=True)
class RotorInBearings:
    """A rotor and its two bearings.

    Attributes
    ----------
    case : Case
        The rotor with its bearings.
    load : (x, y)
        Load on the rotor [N].
    supports : pair of Support
        The bearings.
    """

    case: Case
    load: Vector
    supports: tuple[Support, ...]

    @classmethod
    def of(cls, case: Case, load: Vector) -> RotorInBearings:
        """The rotor of `case` under a load [N]."""
        if case.rotor is None:
            raise ValueError("this case has no rotor")
        alone = [one.replace(**{"model.symmetry": False}) for one in case.supports]
        networks = [HeatNetwork.of(one) for one in alone]
        return cls(case, load, tuple(Support(*each) for each in zip(alone, case.rotor.places, networks, strict=True)))

    @cached_property
    def loads(self) -> Array:
        """Load on the rotor and its moment about the mass centre, (4,) [N, N m]."""
        return np.concatenate([self.load, moment_on_rotor(self.case, self.load)])

    @property
    def span(self) -> float:
        """Distance of the bearings [m]."""
        first, second = self.supports
        return second.place - first.place

    def unit(self, pair: list[Solution]) -> Array:
        """What forces and moments on the shaft are compared with, (4,) [N, N m]."""
        least = LEAST_LOAD * pair[0].problem.layout.scales.force
        size = max(float(np.hypot(*self.loads[:2])), float(np.hypot(*self.loads[2:])) / (0.5 * self.span), least)
        return size * np.array([1.0, 1.0, 0.5 * self.span, 0.5 * self.span])

    def shares(self) -> tuple[Vector, Vector]:
        """What each bearing carries by statics, its own moments left out [N]."""
        force, moment = self.loads[:2], self.loads[2:]
        second = (moment - self.supports[0].place * force) / self.span
        x, y = force - second
        return (float(x), float(y)), (float(second[0]), float(second[1]))

    def at(self, speed: float, known: Solution | None = None) -> Solution:
        """The equilibrium at a speed [rad/s], from one at another if it is `known`: a bearing and its `other`.

        Raises
        ------
        ConvergenceError
            A bearing does not carry its part of the load, or the shaft has no equilibrium.
        """
        if known is None or known.other is None:
            pair = self.alone(speed)
        else:
            both = list(zip(self.supports, self.in_order(known), self.shares(), strict=True))
            if any(support.tilts for support in self.supports):
                pair = [support.at_speed(one, speed) for support, one, _ in both]
            else:  # without moments of their own statics says what each bearing carries
                pair = [support.carrying(one, speed, share) for support, one, share in both]
        pair = self.balanced(pair)
        residual = self.residual(pair)
        former: list[Solution | None] = [None, None]
        if known is not None and known.other is not None:
            former = [*self.in_order(known)]
        states = zip(self.supports, pair, former, strict=True)
        pair = [reported(support.case, replace(one, load=-one.unbalanced), near) for support, one, near in states]
        residual = max(residual, self.residual(pair))
        told, other = reversed(pair) if self.turned else pair
        path = "balanced with the load on the shaft of both bearings"
        return replace(told, other=other, shaft_residual=residual, solution_path=path)

    @property
    def turned(self) -> bool:
        """Whether results describe the second bearing."""
        return self.case.rotor is not None and self.case.rotor.results_of is Which.SECOND

    def in_order(self, found: Solution) -> list[Solution]:
        """The states of the first and the second bearing.

        Raises
        ------
        ValueError
            There is only one.
        """
        if found.other is None:
            raise ValueError("this is the state of one bearing")
        pair = [found, found.other]
        return pair[::-1] if self.turned else pair

    def told(self, found: Solution) -> Case:
        """The bearing that results describe by itself, at its slopes."""
        return self._alone_at(found, int(self.turned))

    def untold(self, found: Solution) -> Case:
        """The other bearing by itself, at its slopes; `found` is its state."""
        return self._alone_at(found, int(not self.turned))

    def _alone_at(self, found: Solution, number: int) -> Case:
        support = self.supports[number]
        changes: dict[str, object] = {"operation.speed": self.case.operation.speed}
        if support.tilts:
            changes["operation.tilt"] = support.slopes(found)
        return support.case.replace(**changes)

    def alone(self, speed: float) -> list[Solution]:
        """Each bearing under its part of the load, the shaft parallel to the line through both."""
        found = []
        for support, load, ordinal in zip(self.supports, self.shares(), ORDINALS, strict=True):
            case = support.case.replace(**{"operation.speed": speed})
            problem = build_problem(case)
            try:
                wanted = np.array(load) / problem.layout.scales.force
                one = balance_from_nothing(problem, wanted)
                one = one if support.network is None else heated(one, support.network)
            except ConvergenceError as failure:
                size = float(np.hypot(*load))
                text = f"the {ordinal} bearing, which carries {size:.4g} N of the load: {failure}"
                raise type(failure)(text, history=failure.history, advice=failure.advice) from failure
            free = support.problem.at(displacement=support.askew / problem.layout.scales.length)
            e = free.displacement.copy()
            e[:2] = one.problem.displacement[:2]
            found.append(replace(at_same_state(free.at(displacement=e), one), load=None))
        return found

    def balanced(self, pair: list[Solution]) -> list[Solution]:
        """Newton's method on the position of the shaft, from states of both bearings (O7)."""
        q, pair = self._joined(pair)
        for step in range(STEPS):
            current_run().note("shaft", step=step, imbalance=self.residual(pair))
            if self.residual(pair) <= FORCE_TOLERANCE:
                return pair
            K = sum(support.resists(one) for support, one in zip(self.supports, pair, strict=True))
            change: Array = np.asarray(np.linalg.solve(K, self.left(pair)), dtype=np.float64)
            length = min(1.0, FARTHEST / max(self._films(change), 1e-300))
            q, pair = self._stepped(pair, q, length * change)
        raise ConvergenceError(
            f"the shaft in two bearings found no equilibrium in {STEPS} steps: "
            f"{self.residual(pair):.2g} of the load is left over",
            history=current_run().history,
            advice="lower the load, or ask for each bearing alone under its part of it",
        )

    def left(self, pair: list[Solution]) -> Array:
        """Force and moment left over on the shaft, (4,) [N, N m]."""
        pushed = sum(support.force(one) for support, one in zip(self.supports, pair, strict=True))
        return np.asarray(self.loads + pushed)

    def position(self, found: Solution) -> Array:
        """Position of the mass centre and slopes of the shaft, (4,) [m, rad]."""
        return self._through(self.in_order(found))

    def position_at_nodes(self, found: Solution) -> Array:
        """The same with contacts at nodes, where a motion has them."""
        return self._through([replace(one, elements=None, lines=None) for one in self.in_order(found)])

    def residual(self, pair: list[Solution]) -> float:
        """Force and moment left over on the shaft, over the load [1]."""
        return float(np.linalg.norm(self.left(pair) / self.unit(pair)))

    def in_time(self, before: list[Temperatures | None], step: float) -> RotorInBearings:
        """The same a time `step` [s] after the temperatures `before`; None for those of a bearing that begins."""
        later = []
        for support, warm in zip(self.supports, before, strict=True):
            network = network_in_time(support.case)
            later.append(replace(support, network=network.after(warm or network.start, step)))
        return replace(self, supports=tuple(later))

    def _joined(self, pair: list[Solution]) -> tuple[Array, list[Solution]]:
        """Both bearings on one shaft: through both journals, or less inclined about the one that is displaced less."""
        through, sizes = self._through(pair), [float(np.hypot(*one.problem.displacement[:2])) for one in pair]
        anchor = int(np.argmin(sizes))
        place, still = self.supports[anchor].place, pair[anchor].problem
        inclined = INCLINED if np.any(through[2:]) else INCLINED[:1]
        for part in inclined:
            slopes = part * through[2:]
            q = np.concatenate([still.displacement[:2] * still.layout.scales.length - place * slopes, slopes])
            try:
                return q, self._moved(pair, q)
            except ConvergenceError as failure:
                last = failure
                current_run().note("shaft", inclined=part, outcome=str(failure))
        raise last

    def _stepped(self, pair: list[Solution], q: Array, change: Array) -> tuple[Array, list[Solution]]:
        """The shaft after a step, or after a smaller part of it where a bearing finds no equilibrium.

        Raises
        ------
        ConvergenceError
            The bearings do not follow that either.
        """
        try:
            return q + change, self._moved(pair, q + change)
        except ConvergenceError as failure:
            current_run().note("shaft", outcome=str(failure))
        return q + SMALLER * change, self._moved(pair, q + SMALLER * change)

    def _moved(self, pair: list[Solution], q: Array) -> list[Solution]:
        return [support.moved(one, q) for support, one in zip(self.supports, pair, strict=True)]

    def _through(self, pair: list[Solution]) -> Array:
        """Position of the shaft through the centres of both journals, (4,)."""
        first, second = (one.position[:2] * one.problem.layout.scales.length for one in pair)
        slopes = (second - first) / self.span
        return np.concatenate([first - self.supports[0].place * slopes, slopes])

    def _films(self, change: Array) -> float:
        """Largest move of a journal by a change of `q`, in reference films."""
        moves = (support.by_shaft @ change / support.problem.layout.scales.length for support in self.supports)
        return max(float(np.linalg.norm(move)) for move in moves)
