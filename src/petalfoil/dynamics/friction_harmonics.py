"""Friction between petals by harmonic balance with several odd harmonics of the slips (E22).

The journal moves sinusoidally, contacts do not: their slips and friction forces have the harmonics 1, 3, 5 and so on.
Even ones vanish, for normal forces are those of the equilibrium and both halves of a cycle are alike. With `R_h` the
slips by unit friction forces at the frequency of harmonic `h`, and `r` a part of it that every contact has to itself,

    v_h + (R_h - r) T_h(v) = s_e for h = 1, else 0,    v = s + r T                                       (E22)

in which `T(v)` is friction (E20) of the stiffness `1 / (1/k + r)`. In all harmonics the solution does not depend on
`r`. In few it does: a contact that sticks has a constant `s`, which only many harmonics have, but `v` follows its force
smoothly. Newton's method solves for `v`. Contacts that slip in a plane have the law of a disk (E20b) and an `r` for
each direction: along the shaft they give a hundredth of what they give along the petals.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.harmonic_tangent import HarmonicTangent, moved_by_each
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError
from petalfoil.physics.sampled_disk import DiskCycle, NoCycleError, SampledDisk
from petalfoil.physics.sampled_friction import HalfPeriod, LineCycle, SampledFriction

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Cycle: TypeAlias = LineCycle | DiskCycle

AGREE = 1e-11
"""Residual of the slips, over the largest without friction, below which they agree with their friction."""

STEPS = 100
"""Most steps of Newton: three to seven are typical from half as many harmonics."""

SHORTEST = 1e-3
"""Shortest step over Newton's; it is taken even if the residual does not fall."""

OWN = 1.0
"""Part of the compliance of a contact, while the others stick, that `r` is. Between 0.3 and 1 losses change by 2e-3 at
most of bearings that take 8 or 16 harmonics, and with 1 Newton's method takes the fewest steps. With a part of the
compliance that it has while others slip, the tangent of contacts that move together is nearly singular where they stick
and far from it where they slip, and it goes to and fro."""


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
    directions : int
        Directions of slip of each contact, one after the other among the `k`.
    """

    stiffness: Array
    limit: Array
    compliances: Complex
    directions: int = 1

    @cached_property
    def own(self) -> Array:
        """`r`, (k,): of the compliance that a contact has while the others stick."""
        contact = 1.0 / self.stiffness
        sticking = np.linalg.inv(self.compliances[-1].real + np.diag(contact))
        return np.asarray(OWN * np.maximum(1.0 / np.diagonal(sticking) - contact, 0.0))

    def cycle(self, joint: Complex, near: Cycle | None = None) -> Cycle:
        """Friction of `v`, which may be `near` that of a former one.

        Raises
        ------
        NoCycleError
            Forces do not repeat.
        """
        compliance, time = 1.0 / self.stiffness + self.own, HalfPeriod(len(joint))
        if self.directions == 1:
            return SampledFriction(1.0 / compliance, self.limit, time).cycle(joint)
        compliance = compliance.reshape(self.directions, -1)
        law = SampledDisk(compliance, self.limit[: compliance.shape[1]], time)
        return law.cycle(joint, near if isinstance(near, DiskCycle) else None)

    def joined(self, slip: Complex, friction: Complex) -> Slips:
        """Slips of one harmonic (k,) that have these friction forces."""
        return Slips((slip + self.own * friction)[None], friction[None], 0)

    @cached_property
    def coupling(self) -> Complex:
        """`R_h - r`, (m, k, k)."""
        return np.asarray(self.compliances - np.diag(self.own))

    def settled(self, free: Complex, harmonics: int, start: Slips | None = None) -> Slips:
        """Slips that agree with their friction, from the first harmonic `free` (k,) without it.

        They begin with those of fewer harmonics, or with one, in which contacts stick.

        Raises
        ------
        ConvergenceError
            They do not agree.
        """
        if start is None:
            sticking = np.eye(len(free)) + self.coupling[0] / (1.0 / self.stiffness + self.own)
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
        enough, failed = AGREE * float(np.max(np.abs(free), initial=0.0)), f"do not agree in {STEPS} steps"
        try:
            left, cycle = self.left(joint, free)
            for count in range(STEPS):
                if np.max(np.abs(left), initial=0.0) <= enough:
                    return Slips(joint, cycle.force, before + count)
                joint, left, cycle = self.stepped(joint, left, cycle, free)
        except NoCycleError as failure:
            failed = str(failure)
        raise ConvergenceError(
            f"{len(joint)} harmonics of friction between petals do not agree with their slips: {failed}",
            history=current_run().history,
            advice="ask for another amplitude, or for the stuck limit without one",
        )

    def stepped(self, joint: Complex, left: Complex, cycle: Cycle, free: Complex) -> tuple[Complex, Complex, Cycle]:
        """Slips, residual and cycle after a step of Newton, halved until the residual is less."""
        full, length = self.tangent(cycle).solve(-left), 1.0
        while True:
            there, ahead = self.left(joint + length * full, free, cycle)
            if np.linalg.norm(there) < np.linalg.norm(left) or length < SHORTEST:
                return joint + length * full, there, ahead
            length *= 0.5

    def left(self, joint: Complex, free: Complex, near: Cycle | None = None) -> tuple[Complex, Cycle]:
        """Residual of (E22), (harmonics, k), and the cycle of the friction forces."""
        cycle = self.cycle(joint, near)
        left = joint + moved_by_each(self.coupling, cycle.force)
        left[0] -= free
        return left, cycle

    def tangent(self, cycle: Cycle) -> HarmonicTangent:
        """Derivative of the residual by `v`."""
        return HarmonicTangent(self.coupling, cycle.derivative)
