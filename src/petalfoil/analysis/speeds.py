"""A bearing under a load followed over speed: each balance from the one before."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.friction_told import follows_path
from petalfoil.analysis.heat_results import network_in_time, warm_up_step, with_heat
from petalfoil.analysis.other_bearing import worst_contact
from petalfoil.analysis.resume import is_same
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.case import Case
from petalfoil.equilibrium.friction_under_load import LoadedPath
from petalfoil.equilibrium.led_points import led, with_nodal_contacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import balance_cold, rebalance
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import friction_of
from petalfoil.system.loaded import load_of
from petalfoil.system.temperatures import Temperatures

Array = NDArray[np.float64]

CLIMB = (0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Parts of a speed through which it is climbed to from rest."""


@dataclass
class SpeedLine:
    """Balances of one load at changing speeds, each on the branch of the one before.

    Attributes
    ----------
    case : Case
        The bearing.
    load : (x, y)
        Load on the rotor [N]: two bearings carry half of it each.
    known : Solution or None
        The last balance.
    temperatures : Temperatures or None
        The last temperatures of a heat network: those before the next step of a warm-up.
    gradually : bool
        Raise the friction power gradually where Newton's method does not lead from the last temperatures to the next.
    seeks : bool
        Look for contacts on petals with continuous slopes; else all balances keep contacts at nodes.
    leads : bool
        Let contact points lead from one balance to the next, without a solution with contacts at nodes beside it.
        Derivatives need that one: where a point begins or ends, they are its.
    rotor : RotorInBearings or None
        The rotor, where its bearings do not share the load evenly.
    others : list
        Temperatures of both its bearings in a warm-up.
    path : LoadedPath or None
        Friction between the petals, where it is followed from the assembled pack at rest.
    from_rest : bool
        Follow it unless the case says otherwise.
    """

    case: Case
    load: tuple[float, float]
    known: Solution | None = None
    temperatures: Temperatures | None = None
    gradually: bool = True
    seeks: bool = True
    leads: bool = True
    base: CoupledProblem = field(init=False)
    rotor: RotorInBearings | None = None
    others: list[Temperatures | None] = field(default_factory=list)
    path: LoadedPath | None = field(init=False, default=None)
    from_rest: bool = False

    def __post_init__(self) -> None:
        if not self.case.shares_evenly:
            self.rotor = RotorInBearings.of(self.case, self.load)
            self.base = self.rotor.supports[int(self.rotor.turned)].problem
            return
        self.base = self._centred()
        friction = friction_of(self.case, self.base.layout)
        if friction is not None and follows_path(self.case, by_default=self.from_rest):
            self.path = LoadedPath(friction, load_of(self.case, self.load, self.base.layout))

    def _centred(self) -> CoupledProblem:
        """The bearing with a centred journal: that of a balance at hand, if it is at the temperatures of the case."""
        if self.known is None or self.known.problem.temperatures is not None:
            return build_problem(self.case.replace(**{"operation.eccentricity": (0.0, 0.0)}))
        problem = self.known.problem
        return problem.at(displacement=np.zeros_like(problem.displacement))

    def at(self, speed: float, after: float | None = None) -> Solution:
        """The balance at `speed` [rad/s], followed from the last one.

        With a heat network its temperatures are steady, or those `after` a time [s] in which they began from the last.

        Raises
        ------
        ConvergenceError
            None was found.
        """
        if self.rotor is not None:
            return self._on_shaft(self.rotor, speed, after)
        layout = self.base.layout
        problem, load = self.base.at(bearing_number=layout.bearing_number(speed)), load_of(self.case, self.load, layout)
        if self.path is not None:
            return self._with_friction(self.path, problem)
        warm, before = self.temperatures, self.known
        leads = self.seeks and self.leads
        led_here = led(before, problem, load) if before is not None and leads else None
        if led_here is not None:
            self.known = led_here
            return led_here
        if before is not None:
            self.known = before = with_nodal_contacts(before)
        if warm is None and after is not None:
            warm = network_in_time(self.case).start
        if self.known is None:
            found = balance_cold(problem.at(temperatures=warm), load)
        else:
            found = rebalance(self.known, problem.at(temperatures=warm), load)
        if after is None or warm is None:
            self.known = with_heat(self.case, found, gradually=self.gradually)
        else:
            self.known = warm_up_step(self.case, found, warm, after)
        self.temperatures = self.known.problem.temperatures
        self.known = (
            reported(self.case, self.known, before) if self.seeks else replace(self.known, elements_sought=True)
        )
        return self.known

    def _with_friction(self, path: LoadedPath, problem: CoupledProblem) -> Solution:
        """The same with the friction forces of the way from the last balance, or from the assembled pack at rest."""
        start = self.known or path.set_down(self.base)
        found = None if start is None else path.run_up(start, problem)
        if found is None:
            where = "while it was loaded at rest" if start is None else "on the way to this speed"
            raise ConvergenceError(
                f"the path of the pack with friction was lost {where}",
                history=current_run().history,
                advice='take more speeds or another grid; surface.friction_history = "relaxed" leaves the path out',
            )
        self.known = found
        return found

    def _on_shaft(self, rotor: RotorInBearings, speed: float, after: float | None) -> Solution:
        """The same of a rotor whose bearings do not share the load evenly."""
        if after is not None:
            rotor = rotor.in_time(self.others or [self.temperatures, None], after)
        try:
            self.known = rotor.at(speed, self.known)
        except ConvergenceError:
            if self.known is None:
                raise
            self.known = rotor.at(speed)
        self.temperatures = self.known.problem.temperatures
        self.others = [one.problem.temperatures for one in rotor.in_order(self.known)]
        return self.known

    def climb(self, speed: float) -> Solution:
        """The balance at `speed` on the branch that the loaded pack takes from rest.

        Raises
        ------
        ConvergenceError
            It was lost on the way.
        """
        self.known = None
        for part in (1.0,) if self.path is not None else CLIMB:
            found = self.at(part * speed)
        return found

    def regain(self, speeds: Sequence[float], last: Record) -> None:
        """Stand at the `last` stored point of a line through `speeds` [rad/s], to go on from there.

        Its balance is looked for from nothing; where that is another, along the speeds.
        """
        self.known = None
        if not last.converged or (self.path is None and self._arrived(speeds[-1:], last)):
            return
        self._arrived(speeds, last)

    def _arrived(self, speeds: Sequence[float], last: Record) -> bool:
        """Follow the line through `speeds`; whether it ends at the stored point."""
        found = self.known = None
        for speed in speeds:
            try:
                found = self.at(speed)
            except ConvergenceError:
                found = self.known = None
        if found is None:
            return False
        x, y = found.position[:2] * self.base.layout.scales.length
        return is_same(last, {"eccentricity_x": float(x), "eccentricity_y": float(y)})

    def contact_fraction(self, speed: float) -> float:
        """Contact fraction at `speed`, of two bearings that of the one which touches more [1]."""
        return worst_contact(self.case, self.at(speed))
