"""A rigid rotor on its bearing, or in two of them where it may tilt: what its stability is asked of.

Load and mass of a rotor in two bearings are those of the whole rotor. Where they are equal and its mass centre is
half-way, each carries half of the load and the shaft stays parallel in equilibrium: the state of one bearing is that of
both. Elsewhere each has a state of its own.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from petalfoil.analysis.impedance import elastic, on_elements
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.analysis.tilted_journal import free_to_tilt, held
from petalfoil.case import Case, ModelKind
from petalfoil.dynamics.critical_mass import Whirl, neutral_whirl, whirl_impedance
from petalfoil.dynamics.joint_motion import JointMotion
from petalfoil.dynamics.natural_modes import Mode, natural_modes
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.dynamics.rubbing_modes import NeutralWhirls, RubbingRotor
from petalfoil.dynamics.rubbing_whirl import RubbingWhirl
from petalfoil.equilibrium.element_response import ElementMotion
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.equilibrium.followed_points import followed
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import JournalMotion
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import UsageError
from petalfoil.system.loaded import load_of


@dataclass(frozen=True)
class RotorOnBearings:
    """A rigid rotor and what it runs in.

    Attributes
    ----------
    case : Case
        The bearing; where the rotor runs in two of them, on the grid of its whole length.
    mass : float
        Mass of the rotor [kg]; nan where none is known.
    amplitude : float or None
        Amplitude of the whirl at which petals rub [m]; None where they stick.
    harmonics : int
        Fewest harmonics of their slips; 0 for as many as they need.
    """

    case: Case
    mass: float
    amplitude: float | None = None
    harmonics: int = 0

    @cached_property
    def inertia(self) -> Inertia:
        """Its inertia; in two bearings with the moments of inertia of the case."""
        rotor = self.case.rotor
        if rotor is None or rotor.span is None:
            return Inertia.of_mass(self.mass)
        whole = rotor.model_copy(update={"mass": self.mass})
        return Inertia.of(whole.with_inertias(self.case.bearing.journal_radius))

    def impedance(self, answer: Solution) -> Impedance:
        """The impedance of the bearing, or of both, about the equilibrium of one; see `motion`."""
        return whirl_impedance(self.motion(answer))

    def motion(self, answer: Solution) -> JournalMotion:
        """Small motions of the bearing, or of both, about the equilibrium of one.

        Raises
        ------
        ConvergenceError
            The pack is bottomed out.
        """
        if self.case.bearings == 1:
            return elastic(self.case, held(self.case, answer))
        return self._joint(answer)

    def followed(self, last: JournalMotion, speed: float, load: tuple[float, float] | None) -> Impedance | None:
        """The impedance at another speed [rad/s], contacts followed from `last`.

        The position is followed under a `load` (x, y) [N], and stays where that is None. The result is None for
        contacts at nodes, for two bearings, with a heat network, and where the equilibrium is lost.
        """
        if not isinstance(last, ElementMotion) or self.case.bearings > 1:
            return None
        problem = last.problem
        wanted = None if load is None else load_of(self.case, load, problem.layout)
        if problem.temperatures is not None:
            return None
        if wanted is not None and (last.contacts.gradient is None or len(wanted) != len(problem.displacement)):
            return None
        there = problem.at(bearing_number=problem.layout.bearing_number(speed))
        near = last.contacts
        try:
            found = followed(near, there, wanted) if isinstance(near, PointContacts) else near.at(there, wanted)
            return whirl_impedance(on_elements(self.case, found)[0])
        except NoPointsError as failure:
            current_run().note("followed", outcome=str(failure))
            return None

    def _joint(self, answer: Solution) -> JointMotion:
        """Small motions of both bearings; where they share the load evenly, those of one are those of the other.

        Raises
        ------
        UsageError
            The state is that of one bearing, held in place.
        """
        rotor = RotorInBearings.of(self.case, (0.0, 0.0))
        per_lever = 1.0 / (0.5 * rotor.span)
        slopes = np.diag([1.0, 1.0, per_lever, per_lever])  # from slopes times the lever
        first, second = (support.by_shaft @ slopes for support in rotor.supports)
        if self.case.shares_evenly:
            tilts = self.case.model.kind is ModelKind.THREE_D
            one = elastic(self.case, free_to_tilt(self.case, answer) if tilts else answer)
            return JointMotion((one, one), (first, second))
        if answer.other is None:
            raise UsageError(
                "the stability of a rotor on unequal bearings is about its balance: give a load, or operation.load"
            )
        both = zip(rotor.supports, rotor.in_order(answer), strict=True)
        return JointMotion(tuple(elastic(support.case, state) for support, state in both), (first, second))

    def whirl(self, impedance: Impedance, speed: float) -> Whirl:
        """The first neutral whirl at a speed [rad/s]; with an amplitude one that goes on with it."""
        if self.amplitude is None:
            return neutral_whirl(impedance, speed, None if self.case.bearings == 1 else self.inertia)
        inertia = Inertia.of_mass(1.0) if self.case.bearings == 1 else self.inertia
        rubbing = RubbingWhirl.of(impedance.motion, self.amplitude, self.harmonics)
        return NeutralWhirls(rubbing, inertia, speed).least()

    def modes(self, impedance: Impedance, speed: float) -> list[Mode]:
        """The natural modes at a speed [rad/s], and at the amplitude if there is one."""
        if self.amplitude is None:
            return natural_modes(impedance, self.inertia, speed)
        rubbing = RubbingWhirl.of(impedance.motion, self.amplitude, self.harmonics)
        return [*RubbingRotor(rubbing, self.inertia, speed).modes(impedance)]

    def deciding_modes(self, whirl: Whirl, impedance: Impedance, speed: float) -> list[Mode] | None:
        """The modes where no mass is critical, for they decide there; None where one is, or the mass is unknown."""
        if math.isfinite(whirl.mass) or math.isnan(self.mass):
            return None
        return self.modes(impedance, speed)


def whole_length(case: Case) -> Case:
    """The case on the grid of its whole length where its rotor may tilt, which half a length cannot."""
    return case.replace(**{"model.symmetry": False}) if case.bearings > 1 else case
