"""Friction forces of contacts that slip to and fro along lines, harmonic by harmonic (E20), (E21).

In a motion of odd harmonics the second half of a period is the first with the other sign, and so are the friction
forces. They are followed from sample to sample of half a period until they repeat:

    T_j = clip(T_j-1 + k (s_j - s_j-1), -mu N, mu N)                                                    (E20)
    T^(h) = 2/n sum_j T_j exp(-i h t_j),    t_j = pi j / n                                              (E21)

This alternation of frequency and time is that of Cameron and Griffin (1989).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

SAMPLES = 128
"""Fewest samples of half a period. With 64 the loss of the paper's eight petals changes by 2e-4 of it."""

PER_WAVE = 8
"""Fewest samples of half a wave of the highest harmonic."""

LAPS = 3
"""Half periods that forces are followed for: they repeat after the first two."""


def odd(count: int) -> Array:
    """The first `count` odd harmonics, (count,)."""
    return np.arange(1.0, 2.0 * count, 2.0)


@dataclass(frozen=True)
class HalfPeriod:
    """Samples of half a period of motions in odd harmonics.

    Attributes
    ----------
    harmonics : int
        Their number.
    """

    harmonics: int

    @cached_property
    def basis(self) -> Array:
        """Samples by the parts of the harmonics, real then imaginary, (samples, 2 harmonics)."""
        count = max(SAMPLES, PER_WAVE * (2 * self.harmonics - 1))
        waves = np.exp(1j * np.outer(np.pi * np.arange(count) / count, odd(self.harmonics)))
        return np.concatenate([waves.real, -waves.imag], axis=1)

    def sampled(self, parts: Complex) -> Array:
        """Samples (samples, k) of harmonics (harmonics, k)."""
        return np.asarray(self.basis @ np.concatenate([parts.real, parts.imag]))

    def shaped(self, samples: Array) -> Complex:
        """Harmonics (harmonics, k) of samples (samples, k); (E21)."""
        parts = self.basis.T @ samples * (2.0 / len(samples))
        return np.asarray(parts[: self.harmonics] + 1j * parts[self.harmonics :])


@dataclass(frozen=True)
class SampledFriction:
    """Friction of `k` contacts along lines.

    Attributes
    ----------
    stiffness, limit : (k,) array
        Stiffness while sticking, and the largest force.
    time : HalfPeriod
        The samples.
    """

    stiffness: Array
    limit: Array
    time: HalfPeriod

    def cycle(self, slip: Complex) -> LineCycle:
        """The cycle of slips (harmonics, k)."""
        return LineCycle(self, *self._followed(slip))

    def _followed(self, slip: Complex) -> tuple[Array, NDArray[np.intp]]:
        """Forces of the last half period, and the samples at which contacts slipped last, -1 for never."""
        half = self.time.sampled(slip)
        steps = np.diff(np.concatenate([half * (-1.0) ** lap for lap in range(LAPS)]), axis=0, prepend=0.0)
        force, last = np.zeros_like(self.limit), np.full(len(self.limit), -1)
        path, lasts = np.empty_like(steps), np.empty(steps.shape, dtype=np.intp)
        for j, step in enumerate(self.stiffness * steps):
            trial = force + step
            force = np.minimum(np.maximum(trial, -self.limit), self.limit)
            last = np.where(trial == force, last, j)
            path[j], lasts[j] = force, last
        return path[-len(half) :], lasts[-len(half) :]


@dataclass(frozen=True)
class LineCycle:
    """Half a period.

    Attributes
    ----------
    law : SampledFriction
        The law.
    path : (samples, k) array
        Friction forces.
    last : (samples, k) int array
        Samples at which contacts slipped last, -1 for never.
    """

    law: SampledFriction
    path: Array
    last: NDArray[np.intp]

    @property
    def force(self) -> Complex:
        """Harmonics of the friction forces, (harmonics, k)."""
        return self.law.time.shaped(self.path)

    @property
    def derivative(self) -> Array:
        """Derivative of each contact's forces by its slips, (k, 2 harmonics, 2 harmonics): real, then imaginary parts.

        The force of a contact has changed by `k` times its way from where it slipped last, `dT_j = k (ds_j - ds_a)`.
        """
        basis = self.law.time.basis
        periods = np.concatenate([*(basis * (-1.0) ** lap for lap in range(LAPS)), np.zeros((1, basis.shape[1]))])
        way = basis[:, None, :] - periods[self.last]  # of contacts that never slip from zero
        shaped = np.matmul(basis.T, np.moveaxis(way, 1, 0)) * (2.0 / len(basis))
        return np.asarray(self.law.stiffness[:, None, None] * shaped)
