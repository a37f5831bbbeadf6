"""Friction forces of contacts that slip in a plane, in odd harmonics of their slips (E20b), (E21).

With a trial force `y = T_j-1 + C^-1 (s_j - s_j-1)` of contacts that stick, `C` their compliance in each direction,

    T_j = argmin (T - y) . C (T - y)  of all |T| <= mu N                                                  (E20b)

is `y` itself within the disk, else the force by which a contact slips along itself: `T = C y / (C + gamma)` of the size
`mu N`. With equal compliances it is the nearest point of the disk (M11), along one line (E20). The second half of a
period is the first with the other sign: the forces that a half begins with end it with the other sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.sampled_friction import HalfPeriod

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Index = NDArray[np.intp]

REPEATS = 1e-13
"""Part of its limit by which a force that begins a half period may miss that which ends it."""

LAPS = 60
"""Most half periods that forces are followed for: three to eight are typical."""

EXACT, STEPS = 1e-7, 30
"""Relative change of `C + gamma` that ends Newton's method for it, and its most steps: three to five are typical."""

AT_ONCE = 64
"""Contacts whose derivatives are followed together; limits the memory."""


class NoCycleError(ArithmeticError):
    """Friction forces did not repeat."""


@dataclass(frozen=True)
class Returned:
    """Forces of a sample, by trial forces.

    Attributes
    ----------
    force : (2, k) array
        Forces.
    slipping : (j,) int array
        Contacts that slip.
    part : (2, j) array
        `C / (C + gamma)` of these.
    across : (2, j) array
        `T / (C + gamma)` of these over its product with `T`.
    """

    force: Array
    slipping: Index
    part: Array
    across: Array

    @classmethod
    def of(cls, trial: Array, compliance: Array, limit: Array) -> Returned:
        """Onto the disks of `limit` (k,), with compliances (2, k)."""
        size = np.hypot(trial[0], trial[1])
        slipping = np.flatnonzero(size > limit)
        if not len(slipping):
            return cls(trial, slipping, np.zeros((2, 0)), np.zeros((2, 0)))
        C, L = compliance[:, slipping], limit[slipping]
        over = slip_excess(C, C * trial[:, slipping], L, size[slipping])
        force = trial.copy()
        force[:, slipping] = T = C * trial[:, slipping] / (C + over)
        turned = T / (C + over)
        return cls(force, slipping, C / (C + over), turned / (T * turned).sum(axis=0))

    def derivative(self, change: Array) -> Array:
        """Changes of the forces by those of the trial forces, (2, k, m) each; overwrites `change`."""
        if len(self.slipping):
            free = self.part[:, :, None] * change[:, self.slipping]
            longer = (self.force[:, self.slipping, None] * free).sum(axis=0)
            change[:, self.slipping] = free - self.across[:, :, None] * longer
        return change


def slip_excess(C: Array, pulls: Array, limit: Array, size: Array) -> Array:
    """`gamma` with `|pulls / (C + gamma)| = limit`, for trial forces of a larger `size`, (j,).

    By Newton's method for the reciprocal, which rises from the largest of three lower bounds.
    """
    (c, d), (p, q) = C, pulls
    least = np.minimum(c, d)
    over = np.maximum(np.maximum(np.abs(p) / limit - c, np.abs(q) / limit - d), least * (size / limit - 1.0))
    for _ in range(STEPS):
        first, second = c + over, d + over
        x, y = (p / first) ** 2, (q / second) ** 2
        squared = x + y
        step = (np.sqrt(squared) / limit - 1.0) * squared / (x / first + y / second)
        over = over + step
        if (np.abs(step) <= EXACT * (least + over)).all():
            break
    return np.asarray(over)


@dataclass(frozen=True)
class SampledDisk:
    """Friction of `k` contacts in a plane; slips and forces are those in the first direction, then in the second.

    Attributes
    ----------
    compliance : (2, k) array
        `C`.
    limit : (k,) array
        Largest force.
    time : HalfPeriod
        The samples.
    """

    compliance: Array
    limit: Array
    time: HalfPeriod

    def cycle(self, slip: Complex, near: DiskCycle | None = None) -> DiskCycle:
        """The cycle of slips (harmonics, 2 k), looked for from one of slips nearby.

        Raises
        ------
        NoCycleError
            Forces do not repeat.
        """
        samples = self.time.sampled(slip).reshape(-1, 2, len(self.limit))
        steps = np.diff(np.concatenate([samples, -samples[:1]]), axis=0) / self.compliance
        start = self._within(samples[0] / self.compliance if near is None else near.start)
        for _ in range(LAPS):
            cycle = DiskCycle(self, steps, start)
            missed = start + cycle.end
            if np.all(np.abs(missed) <= REPEATS * self.limit):
                return cycle
            ahead = np.moveaxis(cycle.by_start, 0, 1) + np.eye(2)
            start = self._within(start - np.linalg.solve(ahead, missed.T[:, :, None])[:, :, 0].T)
        raise NoCycleError(f"friction forces do not repeat in {LAPS} half periods")

    def _within(self, force: Array) -> Array:
        size = np.hypot(force[0], force[1])
        return np.asarray(force * np.divide(self.limit, size, out=np.ones_like(size), where=size > self.limit))


@dataclass(frozen=True)
class DiskCycle:
    """Half a period.

    Attributes
    ----------
    law : SampledDisk
        The law.
    steps : (samples, 2, k) array
        Changes of trial forces from each sample to the next.
    start : (2, k) array
        Forces of the first sample.
    """

    law: SampledDisk
    steps: Array
    start: Array

    @cached_property
    def _followed(self) -> list[Returned]:
        """Forces behind the first sample, to that which begins the next half period."""
        force, out = self.start, []
        for step in self.steps:
            out.append(Returned.of(force + step, self.law.compliance, self.law.limit))
            force = out[-1].force
        return out

    @property
    def end(self) -> Array:
        """Forces that the next half period begins with, (2, k)."""
        return self._followed[-1].force

    @property
    def by_start(self) -> Array:
        """Their derivative by those of the first sample, (2, k, 2)."""
        change = np.repeat(np.eye(2)[:, None], len(self.law.limit), axis=1)
        for one in self._followed:
            change = one.derivative(change)
        return change

    @property
    def force(self) -> Complex:
        """Harmonics of the forces, (harmonics, 2 k)."""
        path = np.array([self.start, *(one.force for one in self._followed[:-1])])
        return self.law.time.shaped(path.reshape(len(path), -1))

    @property
    def derivative(self) -> Array:
        """Derivative of each contact's forces by its slips, (k, 4 harmonics, 4 harmonics).

        Of both, the first direction before the second, real parts before imaginary ones.
        """
        count = len(self.law.limit)
        groups = [np.arange(first, min(first + AT_ONCE, count)) for first in range(0, count, AT_ONCE)]
        return np.concatenate([np.zeros((0, *[2 * self.law.time.basis.shape[1]] * 2)), *map(self._among, groups)])

    def _among(self, contacts: Index) -> Array:
        """The same of some contacts."""
        law = SampledDisk(self.law.compliance[:, contacts], self.law.limit[contacts], self.law.time)
        basis, cycle = law.time.basis, DiskCycle(law, self.steps[:, :, contacts], self.start[:, contacts])
        parts = basis.shape[1]
        moves = np.diff(np.concatenate([basis, -basis[:1]]), axis=0)
        change = np.zeros((2, len(contacts), 2 * parts + 2))
        change[0, :, -2] = change[1, :, -1] = 1.0
        path = np.empty((len(basis), *change.shape))
        for j, (one, move) in enumerate(zip(cycle._followed, moves, strict=True)):
            path[j] = change
            change[0, :, :parts] += move / law.compliance[0][:, None]
            change[1, :, parts : 2 * parts] += move / law.compliance[1][:, None]
            change = one.derivative(change)
        shaped = np.tensordot(basis, path, axes=(0, 0)) * (2.0 / len(basis))  # (part, direction, contact, by)
        end = np.moveaxis(change, 0, 1)
        by_slip = np.linalg.solve(end[:, :, -2:] + np.eye(2), -end[:, :, :-2])  # of the start, which ends the half
        whole = shaped[..., :-2] + np.einsum("pdkx,kxb->pdkb", shaped[..., -2:], by_slip)
        return np.ascontiguousarray(whole.transpose(2, 1, 0, 3)).reshape(len(contacts), 2 * parts, 2 * parts)
