"""Results of small motions about an equilibrium, as its derivatives need them: stiffness, damping, critical mass.

They are functions of the state that moves with a parameter, evaluated with the factorised equations: a reduced model
would add its own error to each difference. The neutral whirl of a neighbour follows by one step of Newton's method from
that of the equilibrium, which is exact to first order:

    nu' = -Im lambda_p / Im lambda_nu ,   m = Re lambda / (nu omega)^2                                 (V10)

with the eigenvalue `lambda` of the impedance at whirl ratio `nu`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from petalfoil.analysis.crossing_derivatives import CrossingDerivatives, newton_to
from petalfoil.analysis.derivatives import Results, ResultsOf
from petalfoil.analysis.heated_derivatives import Derivatives, derivatives_of
from petalfoil.analysis.impedance import elastic, impedance
from petalfoil.analysis.mode_derivatives import mode_results
from petalfoil.analysis.operating_point import at, operating_point
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.sensitivity_table import DAMPING, MODES, STIFFNESS
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.analysis.threshold import AtOwnSpeed, margin, rotor_mass, threshold_speed
from petalfoil.case import Case, ModelKind
from petalfoil.dynamics.critical_mass import Whirl, eigenvalues
from petalfoil.dynamics.reduced_impedance import factorised
from petalfoil.equilibrium.led_points import with_nodal_contacts
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.system.friction import friction_of

THRESHOLD = "threshold_speed"
TO_THRESHOLD = "logarithm of the critical mass over that of the rotor"
"""Name of what vanishes at the threshold; none of a user's results has a blank."""

TURN = 1e-6
"""Part of the whirl ratio over which an eigenvalue is differentiated, from the exact derivative of the impedance."""

PRECISE = 1e-12
"""Relative change of the whirl ratio at which that of the equilibrium is found."""

STEPS = 8
"""Newton steps to it from a precision of 1e-6: one or two."""


def coefficient_results(frequency: float | None) -> ResultsOf:
    """Stiffness and damping at a whirl frequency [rad/s], by default that of the speed, entry by entry."""

    def results(case: Case, moved: Solution) -> Results:
        speed = case.operation.speed
        K, C = impedance(elastic(case, moved), speed if frequency is None else frequency, speed)
        entries = np.concatenate([K.ravel(), C.ravel()])
        return {name: float(value) for name, value in zip(STIFFNESS + DAMPING, entries, strict=True)}

    return results


def with_lines_of_motion(case: Case, answer: Solution) -> Solution:
    """The equilibrium that small motions are about, see `impedance.elastic_and_sliding`.

    Friction of petals that only turn acts in the cells between nodes, where contacts stay at nodes.
    """
    friction = friction_of(case, answer.problem.layout)
    return answer if friction is None or friction.exact else replace(answer, lines=None)


@dataclass(frozen=True)
class KnownWhirl:
    """The neutral whirl of an equilibrium, near which those of its neighbours are.

    Attributes
    ----------
    ratio : float
        Whirl ratio [1].
    value : complex
        Eigenvalue of the impedance there [N/m].
    """

    ratio: float
    value: complex

    @classmethod
    def of(cls, rotor: RotorOnBearings, answer: Solution) -> KnownWhirl:
        """That of an equilibrium, to the last digits.

        Raises
        ------
        ConvergenceError
            There is none.
        """
        found = rotor.whirl(rotor.impedance(answer), rotor.case.operation.speed)
        if not 0.0 < found.mass < math.inf:
            known = "whirls at any rotor mass" if found.mass == 0.0 else "is stable for any rotor mass"
            raise ConvergenceError(
                f"no derivative of the critical mass: the bearing {known}",
                advice="ask for stiffness_xx ... damping_yy with `--ask coefficients`",
            )
        here = cls(found.ratio, complex(found.mass * (found.ratio * rotor.case.operation.speed) ** 2))
        for _ in range(STEPS):
            last, here = here, here.near(rotor, answer)
            if abs(here.ratio - last.ratio) <= PRECISE * here.ratio:
                return here
        raise ConvergenceError(
            "no derivative of the critical mass: its whirl ratio is not determined",
            advice="change the case a little, or compare two runs of `stability`",
        )

    def near(self, rotor: RotorOnBearings, answer: Solution) -> KnownWhirl:
        """The neutral whirl of a neighbour, one step of Newton's method from here; one factorisation."""
        response = factorised(motion := rotor.motion(answer), 1j * self.ratio)
        scales = motion.problem.layout.scales
        unit = -scales.force / scales.length
        Z, by_ratio = unit * response.force_gradient, 1j * unit * response.slope()
        inertia = None if rotor.case.bearings == 1 else rotor.inertia
        values = []
        for turn in (-TURN * self.ratio, 0.0, TURN * self.ratio):
            every = eigenvalues(Z + turn * by_ratio, self.ratio + turn, inertia)
            values.append(complex(every[np.argmin(np.abs(every - self.value))]))
        slope = (values[2] - values[0]) / (2.0 * TURN * self.ratio)
        step = -values[1].imag / slope.imag
        return KnownWhirl(self.ratio + step, values[1] + step * slope)

    def whirl(self, speed: float) -> Whirl:
        """The same as a critical mass at a speed [rad/s]."""
        return Whirl(self.value.real / (self.ratio * speed) ** 2, self.ratio)


def whirl_results(case: Case, answer: Solution, mass: float | None) -> ResultsOf:
    """Critical mass, its whirl ratio, and the margin to the rotor's mass, `mass` [kg] or that of the case.

    Raises
    ------
    ConvergenceError
        There is no critical mass.
    """
    known = KnownWhirl.of(RotorOnBearings(case, rotor_mass(case, None, mass)), answer)

    def results(there: Case, moved: Solution) -> Results:
        rotor = RotorOnBearings(there, rotor_mass(there, None, mass))
        found = known.near(rotor, moved).whirl(there.operation.speed)
        told = {"critical_mass": found.mass, "whirl_ratio": found.ratio}
        return told if math.isnan(rotor.mass) else {**told, TO_THRESHOLD: margin(found, rotor.mass)}

    return results


def stability_derivatives(
    case: Case, mass: float | None, quantities: Sequence[str], *, as_points: bool
) -> list[Derivatives | CrossingDerivatives]:
    """Derivatives of critical mass and whirl ratio; of threshold speed and natural modes where these are asked for.

    `quantities` are names of results, `as_points` is as in `DerivativesOf`.

    Raises
    ------
    ConvergenceError
        The equilibrium, its critical mass or the threshold speed was not found.
    """
    if case.bearings > 1 and case.model.kind is ModelKind.THREE_D:
        raise ConvergenceError(
            "no derivative: in 3-D the rotor tilts in its two bearings, and stability has derivatives of one bearing "
            "and of two in 2-D only",
            advice="leave rotor.span out, or compare two runs of `stability`",
        )
    found = with_lines_of_motion(case, with_nodal_contacts(operating_point(case, None).answer))
    of_modes = {name for mode in MODES for name in mode}
    sources: list[Derivatives | CrossingDerivatives] = []
    if not set(quantities) <= of_modes:
        sources += [derivatives_of(case, found, whirl_results(case, found, mass), as_points=as_points)]
    if of_modes & set(quantities):
        sources += [derivatives_of(case, found, mode_results(case, found, mass), as_points=as_points)]
    if THRESHOLD in quantities:
        sources += [threshold_derivatives(case, found, mass, as_points=as_points)]
    return sources


def threshold_derivatives(case: Case, answer: Solution, mass: float | None, *, as_points: bool) -> CrossingDerivatives:
    """Derivatives of the threshold speed of a rotor of `mass` [kg], from the equilibrium at the case's speed.

    Raises
    ------
    ConvergenceError
        No threshold speed was found, or the critical mass does not pass through the rotor's smoothly.
    """
    rotor = RotorOnBearings(case, rotor_mass(case, None, mass))
    here = rotor.impedance(answer)
    known = AtOwnSpeed(answer, here, rotor.whirl(here, case.operation.speed))
    speed, why = threshold_speed(rotor, case.operation.load, known)
    line = None if case.operation.load is None else SpeedLine(case, case.operation.load, known=answer, leads=False)

    def balance_at(omega: float) -> Derivatives:
        there = at(case, omega)
        answer = operating_point(there, None).answer if line is None else line.at(omega)
        found = with_lines_of_motion(there, with_nodal_contacts(answer))
        return derivatives_of(there, found, whirl_results(there, found, mass), as_points=as_points)

    found = None if math.isnan(speed) else newton_to(THRESHOLD, (TO_THRESHOLD, 0.0), speed, balance_at)
    if found is None:
        reason = why or "the critical mass does not pass through that of the rotor smoothly"
        raise ConvergenceError(
            f"no derivative of the threshold speed: {reason}",
            advice="another mass (--mass) or speed of the case may have one",
        )
    return found
