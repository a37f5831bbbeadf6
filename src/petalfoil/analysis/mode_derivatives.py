"""Natural modes of a rotor as functions of an equilibrium, as derivatives need them.

A mode `s` of `D(s) v = 0`, `D = omega^2 (M s^2 + G s) + Z(s)`, moves with a parameter by

    s' = -(y^T D_p v) / (y^T D_s v)                                                                    (V12)

with its left and right vectors `y` and `v`: one step of Newton's method at a neighbour, from the mode of the
equilibrium, is exact to first order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg as la

from petalfoil.analysis.derivatives import Results, ResultsOf
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.analysis.sensitivity_table import MODES
from petalfoil.analysis.threshold import rotor_mass
from petalfoil.case import Case
from petalfoil.dynamics.natural_modes import ROUNDING
from petalfoil.dynamics.reduced_impedance import factorised
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError

PRECISE = 1e-12
"""Relative step at which the mode of the equilibrium is found."""

STEPS = 8
"""Newton steps to it from a precision of 1e-9: one or two."""


@dataclass(frozen=True)
class KnownMode:
    """A natural mode of an equilibrium, near which those of its neighbours are.

    Attributes
    ----------
    s : complex
        Eigenvalue per radian of rotation [1].
    """

    s: complex

    def near(self, rotor: RotorOnBearings, answer: Solution) -> KnownMode:
        """The mode of a neighbour, one step of Newton's method from here; one factorisation."""
        response, s = factorised(motion := rotor.motion(answer), self.s), self.s
        scales, speed = motion.problem.layout.scales, rotor.case.operation.speed
        unit = -scales.force / scales.length
        M, G = rotor.inertia.mass * speed**2, rotor.inertia.gyroscopic * speed**2
        D, by_s = s**2 * M + s * G + unit * response.force_gradient, 2.0 * s * M + G + unit * response.slope()
        steps = la.eigvals(D, by_s)
        return KnownMode(complex(s - steps[np.argmin(np.abs(steps))]))

    def settled(self, rotor: RotorOnBearings, answer: Solution) -> KnownMode:
        """The same to the last digits.

        Raises
        ------
        ConvergenceError
            Newton's method does not end at it.
        """
        here, before = self, math.inf
        for _ in range(STEPS):
            last, here = here, here.near(rotor, answer)
            step = abs(here.s - last.s) / abs(here.s)
            if step <= PRECISE or 0.5 * before <= step <= ROUNDING:
                return here
            before = step
        raise ConvergenceError(
            "no derivative of the natural modes: one of them is not determined",
            advice="change the case a little, or compare two runs of `stability`",
        )


def mode_results(case: Case, answer: Solution, mass: float | None) -> ResultsOf:
    """Frequency, growth rate and damping ratio of the natural modes, of a rotor of `mass` [kg] or that of the case.

    Raises
    ------
    ConvergenceError
        There is none.
    """
    rotor = RotorOnBearings(case, rotor_mass(case, None, mass))
    found = [] if math.isnan(rotor.mass) else rotor.modes(rotor.impedance(answer), case.operation.speed)
    if not found:
        raise ConvergenceError(
            "no derivative of natural modes: the rotor has none that shows a resonance",
            advice="give the rotor a mass with --mass or [rotor], or ask for stiffness and damping",
        )
    known = [KnownMode(mode.s).settled(rotor, answer) for mode in found[: len(MODES)]]

    def results(there: Case, moved: Solution) -> Results:
        own = RotorOnBearings(there, rotor_mass(there, None, mass))
        told: dict[str, float] = {}
        for names, each in zip(MODES, known, strict=False):
            s, speed = each.near(own, moved).s, there.operation.speed
            told |= zip(names, (s.imag * speed, s.real * speed, -s.real / abs(s)), strict=True)
        return told

    return results
