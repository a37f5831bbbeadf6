"""Friction between petals by harmonic balance with several odd harmonics of the slips (E22).

The journal moves sinusoidally, contacts do not: their slips and friction forces have the harmonics 1, 3, 5 and so on.
Even ones vanish, for normal forces are those of the equilibrium and both halves of a cycle are alike. With `R_h` the
slips by unit friction forces at the frequency of harmonic `h`, and `r` a part of it that every contact has to itself,

    v_h + (R_h - r) T_h(v) = s_e for h = 1, else 0,    v = s + r T                                       (E22)

in which `T(v)` is friction (E20) of the stiffness `1 / (1/k + r)`. In all harmonics the solution does not depend on
`r`. In few it does: a contact that sticks has a constant `s`, which only many harmonics have, but `v` follows its force
smoothly. Newton's method solves for `v`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError
from petalfoil.physics.sampled_friction import HalfPeriod, SampledFriction

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

AGREE = 1e-11
"""Residual of the slips, over the largest without friction, below which they agree with their friction."""

STEPS = 100
"""Most steps of Newton: three to seven are typical from half as many harmonics."""

SHORTEST = 1e-3
"""Shortest step over Newton's; it is taken even if the residual does not fall."""

OWN = 0.3
"""Part of a contact's compliance that `r` is. Between 0.3 and 1 the loss with 8 harmonics changes by 4e-4 of it, and
with 0.3 Newton's method takes the fewest steps."""


@dataclass(frozen=True)
class Slips:
    """Harmonics of slips and friction forces, by unit displacement of the journal.

    Attributes
    ----------
    joint : (harmonics, k) array
        `v`.
    friction : (harmonics, k) array
        Forces.
    steps : int
        Steps of Newton.
    """

    joint: Complex
    friction: Complex
    steps: int

    def turned(self, phase: complex) -> Slips:
        """The same motion by a journal whose displacement is multiplied by `phase`, of size 1."""
        turns = phase ** np.arange(1, 2 * len(self.joint), 2)[:, None]
        return Slips(self.joint * turns, self.friction * turns, self.steps)


@dataclass(frozen=True)
class FrictionHarmonics:
    """Contacts that slide in a whirl of one amplitude.

    Attributes
    ----------
    stiffness, limit : (k,) array
        Stiffness of contacts while sticking, and the largest forces over the amplitude.
    compliances : (m, k, k) array
        Slips against unit friction forces at the first harmonics; those above move as at the last.
    """

    stiffness: Array
    limit: Array
    compliances: Complex

    @cached_property
    def own(self) -> Array:
        """`r`, (k,)."""
        return np.asarray(OWN * np.maximum(np.diagonal(self.compliances[-1]).real, 0.0))

    def law(self, harmonics: int) -> SampledFriction:
        """Friction of `v`."""
        return SampledFriction(1.0 / (1.0 / self.stiffness + self.own), self.limit, HalfPeriod(harmonics))

    def coupling(self, harmonics: int) -> Complex:
        """`R_h - r`, (harmonics, k, k)."""
        each = np.minimum(np.arange(harmonics), len(self.compliances) - 1)
        return np.asarray(self.compliances[each] - np.diag(self.own))

    def settled(self, free: Complex, harmonics: int, start: Slips | None = None) -> Slips:
        """Slips that agree with their friction, from the first harmonic `free` (k,) without it.

        They begin with those of fewer harmonics, or with one, in which contacts stick.

        Raises
        ------
        ConvergenceError
            They do not agree.
        """
        if start is None:
            sticking = np.eye(len(free)) + self.coupling(1)[0] / (1.0 / self.stiffness + self.own)
            joint = np.asarray(np.linalg.solve(sticking, free)[None], dtype=np.complex128)
        else:
            joint = start.joint
        joint = np.concatenate([joint, np.zeros((harmonics - len(joint), len(free)), dtype=np.complex128)])
        return self.solved(joint, free, 0 if start is None else start.steps)

    def solved(self, joint: Complex, free: Complex, before: int) -> Slips:
        """The solution near `joint`, after `before` steps.

        Raises
        ------
        ConvergenceError
            There were too many.
        """
        enough = AGREE * float(np.max(np.abs(free), initial=0.0))
        left, friction = self.left(joint, free)
        for count in range(STEPS):
            if np.max(np.abs(left), initial=0.0) <= enough:
                return Slips(joint, friction, before + count)
            full, length = self.newton(joint, left), 1.0
            while True:
                there, force = self.left(joint + length * full, free)
                if np.linalg.norm(there) < np.linalg.norm(left) or length < SHORTEST:
                    break
                length *= 0.5
            joint, left, friction = joint + length * full, there, force
        raise ConvergenceError(
            f"{len(joint)} harmonics of friction between petals do not agree with their slips in {STEPS} steps",
            history=current_run().history,
            advice="ask for another amplitude, or for the stuck limit without one",
        )

    def left(self, joint: Complex, free: Complex) -> tuple[Complex, Complex]:
        """Residual of (E22) and friction forces, (harmonics, k)."""
        friction = self.law(len(joint)).force(joint)
        left = joint + np.einsum("hij,hj->hi", self.coupling(len(joint)), friction)
        left[0] -= free
        return left, friction

    def newton(self, joint: Complex, left: Complex) -> Complex:
        """Step of Newton, (harmonics, k), real and imaginary parts apart."""
        harmonics, k = joint.shape
        step = np.linalg.solve(self.slope(joint), -np.concatenate([left.real, left.imag]).ravel())
        both = step.reshape(2 * harmonics, k)
        return np.asarray(both[:harmonics] + 1j * both[harmonics:])

    def slope(self, joint: Complex) -> Array:
        """Derivative of the residual by `v`, (2 harmonics k, 2 harmonics k): real parts of all, then imaginary ones."""
        harmonics, k = joint.shape
        own = np.moveaxis(self.law(harmonics).derivative(joint), 0, -1)
        by_slip = self.coupling(harmonics)[:, :, None, :] * (own[:harmonics] + 1j * own[harmonics:])[:, None]
        both = np.concatenate([by_slip.real, by_slip.imag]).reshape(2 * harmonics * k, -1)
        return np.asarray(np.eye(2 * harmonics * k) + both)
