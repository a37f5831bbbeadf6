"""Friction between petals in a small whirl: stuck, or in cycles of a stated amplitude by harmonic balance (E10), (E11).

Contacts that carry load stay closed with the reactions of the equilibrium, at which friction is taken to be without
force. One direction of the journal's displacement at a time: with `R` the slips by unit friction forces and `s_0` those
by the journal without friction, both of one factorisation, the slips solve

    s + R kappa(|s|) s = s_0

by Newton's method, in as many unknowns as contacts slide under load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.linear_response import Response
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.physics.dry_friction import Friction, equivalent_stiffness
from petalfoil.system.friction import held_together

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

AGREE = 1e-11
"""Residual of the slips, over the largest slip without friction, below which they agree with their friction."""

NEAR = 1e-3
"""The same while contacts are softened."""

EASY, STIFFEN = 10.0, 10.0
"""Stiffness of the contacts, over that of what they hold, with which Newton's method has no trouble; factor from one
stiffness to the next."""

STEPS = 200
"""Most steps of Newton with one stiffness: friction has a kink where slipping begins."""

SHORTEST = 1e-3
"""Shortest step, over Newton's: one is taken that does not lessen the residual rather than none."""

AT_ONCE = 32
"""Contacts whose unit forces are answered together: what stands in memory."""


@dataclass(frozen=True)
class Sliding:
    """Contacts that slide and carry load.

    Attributes
    ----------
    friction : Friction
        The law on these contacts.
    limit : (k,) array
        `mu N` at the equilibrium.
    """

    friction: Friction
    limit: Array

    @classmethod
    def at(cls, friction: Friction, answer: Solution) -> Sliding:
        """Those of an equilibrium."""
        normal = friction.normal(answer.lam)
        kept = np.flatnonzero(normal > 0.0)
        slip, share = friction.slip[kept], friction.reaction_share[kept]
        stick = friction.in_step(answer.lam).stiffness[kept]
        law = Friction(friction.coefficient, stick, slip, share, friction.width)
        return cls(law, law.coefficient * normal[kept])

    def slips(self, change: NDArray[Any]) -> NDArray[Any]:
        """Slips by a change of the unknowns (n,) or (n, j)."""
        B = self.friction.slip
        out: NDArray[Any] = B @ change[: B.shape[1]]
        return out

    def against(self, force: NDArray[Any], n: int) -> NDArray[Any]:
        """`B^T T` among all `n` unknowns."""
        B = self.friction.slip
        out = np.zeros(n, dtype=force.dtype)
        out[: B.shape[1]] = B.T @ force
        return out

    def stuck(self, n: int) -> sp.csc_array:
        """What adds to the tangent where all of them stick, (n, n)."""
        return held_together(self.friction, self.friction.stiffness, n)

    def equivalent(self, slip: Complex, amplitude: float) -> tuple[Complex, Complex]:
        """Equivalent stiffness and its derivative by the logarithm of the slip; `slip` is by unit displacement."""
        return equivalent_stiffness(self.friction.stiffness, self.limit / amplitude, np.abs(slip))


@dataclass(frozen=True)
class Cycle:
    """A whirl of one frequency along one axis and then the other, with friction.

    Attributes
    ----------
    sliding : Sliding
        The contacts.
    response : Response
        Linear response without friction.
    amplitude : float
        Of the journal, over the reference length [1].
    """

    sliding: Sliding
    response: Response
    amplitude: float

    def force_gradient(self, work: RunLog) -> Complex:
        """`dF/de` of film and contacts on the journal, (2, 2), over unit of force and length [1].

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        compliance = self.compliance()
        columns = []
        for axis in (0, 1):
            change, reactions = self.response.unit(axis)
            slip = self.settled(self.sliding.slips(change), compliance, work)
            rubbed = self.sliding.equivalent(slip, self.amplitude)[0] * slip
            by_friction = self.response.pushed(-self.sliding.against(rubbed, len(change)))
            columns.append(self.response.force(change + by_friction[0], reactions + by_friction[1]))
        return np.column_stack(columns)

    def compliance(self) -> Complex:
        """`R`, slips against unit friction forces, (k, k)."""
        B, motion, factor = self.sliding.friction.slip, self.response.motion, self.response.factor
        out = np.zeros((B.shape[0], B.shape[0]), dtype=complex)
        for first in range(0, B.shape[0], AT_ONCE):
            some = B[first : first + AT_ONCE].toarray()
            unit = np.hstack([some, np.zeros((len(some), motion.problem.layout.n - B.shape[1]))])
            forces = np.column_stack([motion.ties.gather(row) for row in unit])
            moved = [motion.ties.spread(column) for column in factor.solve(forces.astype(complex)).T]
            out[:, first : first + AT_ONCE] = self.sliding.slips(np.column_stack(moved))
        return out

    def settled(self, free: Complex, compliance: Complex, work: RunLog) -> Complex:
        """Slips by a unit displacement (k,) that agree with their friction, from those without it.

        Contacts much stiffer than what they hold leave Newton's method little way between sticking and slipping: they
        are stiffened by and by.

        Raises
        ------
        ConvergenceError
            They did not agree.
        """
        stiffness, largest = self.sliding.friction.stiffness, float(np.max(np.abs(free), initial=0.0))
        size = float(np.linalg.norm(compliance * stiffness, 2)) if len(free) else 0.0
        softer, steps = max(1.0, size / EASY), 0
        here = self.softened(softer)
        sticking = np.eye(len(free)) + compliance * here.sliding.friction.stiffness
        slip = np.asarray(np.linalg.solve(sticking, free), dtype=np.complex128)
        while True:
            slip, count = here.solved(slip, (free, compliance), (AGREE if softer == 1.0 else NEAR) * largest, work)
            steps += count
            slipping = here.slipping(slip)
            if softer == 1.0:
                work.note("harmonic balance", steps=steps, contacts=len(slip), slipping=int(np.sum(slipping)))
                return slip
            ahead = max(1.0, softer / STIFFEN)
            slip = np.where(slipping, slip, slip * ahead / softer)  # what sticks holds with about the same force
            softer, here = ahead, self.softened(ahead)

    def softened(self, times: float) -> Cycle:
        """The same with softer sticks."""
        friction = replace(self.sliding.friction, stiffness=self.sliding.friction.stiffness / times)
        return replace(self, sliding=replace(self.sliding, friction=friction))

    def slipping(self, slip: Complex) -> NDArray[np.bool_]:
        """Contacts that slip, (k,)."""
        slipping: NDArray[np.bool_] = (
            self.sliding.friction.stiffness * np.abs(slip) * self.amplitude > self.sliding.limit
        )
        return slipping

    def solved(
        self, slip: Complex, system: tuple[Complex, Complex], enough: float, work: RunLog
    ) -> tuple[Complex, int]:
        """Slips whose residual is at most `enough`, and the steps it took from `slip`.

        Raises
        ------
        ConvergenceError
            There were too many.
        """
        left = self.left(slip, *system)
        for count in range(STEPS):
            if np.max(np.abs(left), initial=0.0) <= enough:
                return slip, count
            slip, left = self.improved(slip, left, system)
        raise ConvergenceError(
            f"friction between petals does not agree with their slips in {STEPS} steps",
            history=work.history,
            advice="ask for another amplitude, or for the stuck limit without one; a wider friction_width is smoother",
        )

    def left(self, slip: Complex, free: Complex, compliance: Complex) -> Complex:
        """Residual of the slips, (k,)."""
        stiffness, _ = self.sliding.equivalent(slip, self.amplitude)
        left: Complex = slip + compliance @ (stiffness * slip) - free
        return left

    def improved(self, slip: Complex, left: Complex, system: tuple[Complex, Complex]) -> tuple[Complex, Complex]:
        """Slips and residual after a step of Newton, halved until the residual is less."""
        full, length = self.newton(slip, left, system[1]), 1.0
        while True:
            new = slip + length * full
            there = self.left(new, *system)
            if np.linalg.norm(there) < np.linalg.norm(left) or length < SHORTEST:
                return new, there
            length *= 0.5

    def newton(self, slip: Complex, left: Complex, compliance: Complex) -> Complex:
        """Step of Newton, (k,): real and imaginary parts apart, for the stiffness goes with the magnitude."""
        stiffness, by_size = self.sliding.equivalent(slip, self.amplitude)
        size = np.abs(slip)
        along = np.divide(slip, size, out=np.zeros_like(slip), where=size > 0.0)
        straight = np.eye(len(slip)) + compliance * stiffness
        grown = compliance * (by_size * along)  # d kappa s = kappa' s Re(conj(s) ds) / |s|^2
        by_real, by_imag = straight + grown * along.real, 1j * straight + grown * along.imag
        parts = np.block([[by_real.real, by_imag.real], [by_real.imag, by_imag.imag]])
        step = np.linalg.solve(parts, -np.concatenate([left.real, left.imag]))
        both: Complex = step[: len(slip)] + 1j * step[len(slip) :]
        return both
