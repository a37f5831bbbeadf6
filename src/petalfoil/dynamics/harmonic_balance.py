"""Friction between petals in a small whirl: stuck, or in cycles of a stated amplitude by harmonic balance (E10), (E11).

Contacts that carry load stay active with the reactions of the equilibrium. Friction has no force at the equilibrium.
The directions of the journal's displacement are taken one at a time. With `R` the slips by unit friction forces and
`s_0` those by the journal without friction, both of one factorisation, the slips solve

    s + R kappa(|s|) s = s_0

(`R` with what petals stretch, (M4)) by Newton's method, in as many unknowns as contacts slide under load. Where petals
of a 3-D model stretch, a contact slips along the petals and along the shaft, and `|s|` is the size of both together:
exact where both are in phase, so that the slip is to and fro.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import Response
from petalfoil.errors import ConvergenceError
from petalfoil.physics.dry_friction import Friction, equivalent_stiffness
from petalfoil.system.friction import against_slip, friction_tangent, slips

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

AGREE = 1e-11
"""Residual of the slips, over the largest slip without friction, below which they agree with their friction."""

NEAR = 1e-3
"""The same while contacts are softened."""

EASY, STIFFEN = 10.0, 10.0
"""Stiffness of the contacts, over that of the structure they connect, at which Newton's method converges from sticking;
factor from one stiffness to the next."""

STEPS = 200
"""Most steps of Newton with one stiffness: friction has a kink where slipping begins."""

SHORTEST = 1e-3
"""Shortest step over Newton's; it is taken even if the residual does not fall."""

AT_ONCE = 32
"""Contacts whose unit forces are solved for together; limits the memory."""


@dataclass(frozen=True)
class SlidingContacts:
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
    def at(cls, friction: Friction, lam: Array) -> SlidingContacts:
        """Those of an equilibrium with the reactions `lam` (m,)."""
        normal = friction.normal(lam)
        loaded = (normal > 0.0) & (np.diff(friction.slip.indptr) > 0)
        contacts = loaded.reshape(friction.directions, -1).any(axis=0)
        kept = np.flatnonzero(np.tile(contacts, friction.directions))
        law = friction.in_step(lam).among(kept)
        return cls(law, law.coefficient * normal[kept])

    @classmethod
    def of_stuck(cls, friction: Friction) -> SlidingContacts:
        """Those of contacts that carry load, from the law in which they stick: `k s_f = mu N`."""
        return cls(friction, friction.stiffness * friction.width)

    def sticking(self, n: int) -> sp.csc_array:
        """What adds to the tangent where all of them stick and nothing stretches, (n, n)."""
        return friction_tangent(self.friction, self.friction.stiffness, n)

    def equivalent(self, slip: Complex, amplitude: float) -> tuple[Complex, Complex]:
        """Equivalent stiffness and its derivative by the logarithm of the slip; `slip` is by unit displacement."""
        return equivalent_stiffness(self.friction.stiffness, self.limit / amplitude, self.friction.magnitude(slip))


@dataclass(frozen=True)
class FrictionCycle:
    """A whirl of one frequency along one axis and then the other, with friction.

    Attributes
    ----------
    sliding : SlidingContacts
        The contacts.
    response : Response
        Linear response without friction.
    amplitude : float
        Of the journal, over the reference length [1].
    """

    sliding: SlidingContacts
    response: Response
    amplitude: float

    def force_gradient(self) -> Complex:
        """`dF/de` of film and contacts on the journal over unit of force and length [1].

        Raises
        ------
        ConvergenceError
            Slips and friction did not agree.
        """
        compliance = self.compliance()
        units = self.response.units
        n, columns = len(units), []
        for unit, force in zip(units.T, self.response.force_gradient.T, strict=True):
            slip = self.settled(slips(self.sliding.friction, unit), compliance)
            friction = self.sliding.equivalent(slip, self.amplitude)[0] * slip
            columns.append(force + self.response.forced(-against_slip(self.sliding.friction, friction, n))[1])
        return np.column_stack(columns)

    def compliance(self) -> Complex:
        """`R`, slips against unit friction forces, (k, k)."""
        friction, n = self.sliding.friction, len(self.response.units)
        count = friction.slip.shape[0]
        out = np.zeros((count, count), dtype=complex)
        for first in range(0, count, AT_ONCE):
            unit_forces = np.eye(min(AT_ONCE, count - first), count, first)
            forces = np.column_stack([against_slip(friction, force, n) for force in unit_forces])
            out[:, first : first + AT_ONCE] = slips(friction, self.response.moved(forces))
        stretch = 0.0 if friction.compliance is None else friction.compliance
        return np.asarray(out + stretch, dtype=np.complex128)

    def settled(self, free: Complex, compliance: Complex) -> Complex:
        """Slips by a unit displacement (k,) that agree with their friction, from those without it.

        Contacts much stiffer than the structure leave Newton's method a narrow range between sticking and slipping.
        They are softened first and stiffened step by step.

        Raises
        ------
        ConvergenceError
            They do not agree.
        """
        stiffness, largest = self.sliding.friction.stiffness, float(np.max(np.abs(free), initial=0.0))
        size = float(np.linalg.norm(compliance * stiffness, 2)) if len(free) else 0.0
        softer, steps = max(1.0, size / EASY), 0
        here = self.softened(softer)
        sticking = np.eye(len(free)) + compliance * here.sliding.friction.stiffness
        slip = np.asarray(np.linalg.solve(sticking, free), dtype=np.complex128)
        while True:
            slip, count = here.solved(slip, (free, compliance), (AGREE if softer == 1.0 else NEAR) * largest)
            steps += count
            slipping = here.slipping(slip)
            if softer == 1.0:
                current_run().note("harmonic balance", steps=steps, contacts=len(slip), slipping=int(np.sum(slipping)))
                return slip
            ahead = max(1.0, softer / STIFFEN)
            slip = np.where(slipping, slip, slip * ahead / softer)  # what sticks holds with about the same force
            softer, here = ahead, self.softened(ahead)

    def softened(self, times: float) -> FrictionCycle:
        """The same with softer sticks."""
        friction = replace(self.sliding.friction, stiffness=self.sliding.friction.stiffness / times)
        return replace(self, sliding=replace(self.sliding, friction=friction))

    def slipping(self, slip: Complex) -> NDArray[np.bool_]:
        """Contacts that slip, (k,)."""
        friction, size = self.sliding.friction, self.sliding.friction.magnitude(slip)
        slipping: NDArray[np.bool_] = friction.stiffness * size * self.amplitude > self.sliding.limit
        return slipping

    def solved(self, slip: Complex, system: tuple[Complex, Complex], enough: float) -> tuple[Complex, int]:
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
            history=current_run().history,
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
        size = self.sliding.friction.magnitude(slip)
        along = np.divide(slip, size, out=np.zeros_like(slip), where=size > 0.0)
        straight = np.eye(len(slip)) + compliance * stiffness
        # d kappa s = kappa' s Re(conj(s) ds) / |s|^2, the product over both directions of a contact
        grown = self.sliding.friction.over_directions(compliance * (by_size * along))
        by_real, by_imag = straight + grown * along.real, 1j * straight + grown * along.imag
        parts = np.block([[by_real.real, by_imag.real], [by_real.imag, by_imag.imag]])
        step = np.linalg.solve(parts, -np.concatenate([left.real, left.imag]))
        both: Complex = step[: len(slip)] + 1j * step[len(slip) :]
        return both
