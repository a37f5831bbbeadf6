"""Impedance `Z(s)` of the bearing about an equilibrium, `dF = -Z de`, from a reduced model of the equations.

The model is compared with the factorised equations at the largest whirl ratio. One that misses more than `MODEL_ERROR`
is not used: then every `Z(s)` costs a factorisation. Error and size are in the run log.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import ForceGradient, JournalMotion
from petalfoil.solvers.reduced_model import ReducedModel, reduce_system

Complex = NDArray[np.complex128]

MODEL_ERROR = 1e-8
"""Largest error of a reduced model that is used, over the largest entry of the impedance."""


@dataclass(frozen=True)
class Impedance:
    """`Z` by the rate of change `s` per radian of rotation.

    Attributes
    ----------
    motion : JournalMotion
        Small motions about the equilibrium.
    model : ReducedModel
        Their reduced model.
    error : float
        Largest error of the model, over the largest entry of the impedance [1].
    ratios : (k,) array
        Whirl ratios that it is made for.
    """

    motion: JournalMotion
    model: ReducedModel
    error: float
    ratios: NDArray[np.float64]

    @classmethod
    def over(cls, motion: JournalMotion, ratios: Sequence[float]) -> Impedance:
        """For whirl `ratios`, checked at the last, farthest from the rest that the model begins at.

        One real factorisation and one complex.
        """
        model = reduce_system(motion.moved_system(current_run().probe_solver), [1j * nu for nu in ratios])
        error = model_error(motion, model, 1j * ratios[-1])
        current_run().note("reduced model", vectors=model.size, error=error)
        return cls(motion, model, error, np.asarray(ratios, dtype=np.float64))

    @property
    def reduced(self) -> bool:
        """Whether the model is good enough to be used."""
        return self.error <= MODEL_ERROR

    def at(self, s: complex) -> Complex:
        """`Z`, (d, d) [N/m]."""
        return np.asarray(self.at_each([s])[0], dtype=np.complex128)

    def at_each(self, points: Sequence[complex]) -> Complex:
        """The same at several `s`, (k, d, d) [N/m]."""
        if self.reduced:
            return self._si(self.model.at_each(points))
        return self._si(np.array([factorised(self.motion, s).force_gradient for s in points]))

    @cached_property
    def over_ratios(self) -> Complex:
        """The same at the whirl ratios that it is made for, (k, d, d) [N/m]."""
        return self.at_each((1j * self.ratios).tolist())

    def at_ratio(self, nu: float) -> Complex:
        """`Z` at whirl ratio `nu`, (d, d) [N/m]."""
        return self.at(1j * nu)

    def with_derivative(self, s: complex) -> tuple[Complex, Complex]:
        """`Z` and its derivative by `s`, (d, d) [N/m]."""
        if self.reduced:
            return self._si(self.model.at(s)), self._si(self.model.derivative(s))
        response = factorised(self.motion, s)
        return self._si(response.force_gradient), self._si(response.slope())

    def free_motions(self, inertia: Inertia, speed: float) -> Complex:
        """Every `s` of the model at which a rotor turning at `speed` [rad/s] moves freely on the bearing, unordered."""
        scales = self.motion.problem.layout.scales
        unit = speed**2 * scales.length / scales.force
        return self.model.modes(inertia.mass * unit, inertia.gyroscopic * unit)

    def _si(self, gradient: Complex) -> Complex:
        scales = self.motion.problem.layout.scales
        return np.asarray(-gradient * scales.force / scales.length, dtype=np.complex128)


def factorised(motion: JournalMotion, s: complex) -> ForceGradient:
    """The response from the equations themselves; one factorisation."""
    return motion.growing(s, current_run().probe_solver)


def model_error(motion: JournalMotion, model: ReducedModel, s: complex) -> float:
    """Error of the force gradient at `s` over its largest entry; one factorisation."""
    exact = factorised(motion, s).force_gradient
    return float(np.max(np.abs(model.at(s) - exact)) / np.max(np.abs(exact)))
