"""A complex number and a shape that solve equations: by Levenberg and Marquardt's method, or from a solution nearby.

The number is an eigenvalue, or two real unknowns in one. One coordinate of the shape is 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

PRECISION = 1e-12
"""Relative change of the unknowns after which a solution is found."""

SOLVED = 1e-8
"""Residual over the stiffness of the bearing below which it is one."""

EVALUATIONS = 60
"""Most evaluations for one solution: ten to forty are typical."""

UPDATES = 20
"""Most evaluations of Broyden's method from a solution of equations nearby: five to nine are typical."""

SETTLED = 1e-7
"""Last step of it over the unknowns: each step is a small part of the one before."""

NUDGE = 1e-6
"""Step of differences for the derivative at a solution: slips agree with their friction to 1e-11."""


def packed(first: complex, v: Complex, pivot: int) -> Array:
    """Real unknowns: a complex number, then the shape, whose coordinate `pivot` is 1 and left out."""
    z = np.append(first, np.delete(v / v[pivot], pivot))
    return np.concatenate([z.real, z.imag])


def unpacked(z: Array, pivot: int) -> tuple[complex, Complex]:
    """The number and the shape."""
    both = z[: len(z) // 2] + 1j * z[len(z) // 2 :]
    return complex(both[0]), np.insert(both[1:], pivot, 1.0)


@dataclass(frozen=True)
class Eigenpair:
    """A number and a shape that solve their equations.

    Attributes
    ----------
    number : complex
        `s`, or an eigenvalue.
    v : (d,) array
        The shape.
    slope : (2 d, 2 d) array
        Derivative of the real residual by real unknowns, the number over `unit` among them.
    unit : float
        Unit of the number.
    pivot : int
        Coordinate of the shape that is 1 and no unknown.
    """

    number: complex
    v: Complex
    slope: Array
    unit: float
    pivot: int

    @property
    def unknowns(self) -> Array:
        """The real unknowns, (2 d,)."""
        return packed(self.number / self.unit, self.v, self.pivot)

    @property
    def motion(self) -> tuple[complex, Complex]:
        """`s` and `v` of a mode."""
        return self.number, self.v


@dataclass(frozen=True)
class RealEquations:
    """Equations for a number and a shape in real unknowns.

    Attributes
    ----------
    residual : callable
        Residual by the number and the shape, (d,).
    size : float
        What residuals are compared with.
    unit, pivot : float, int
        Unit of the number, coordinate of the shape that is 1.
    """

    residual: Callable[[complex, Complex], Complex]
    size: float
    unit: float
    pivot: int

    def __call__(self, z: Array) -> Array:
        """Real residual over `size` by the real unknowns, (2 d,)."""
        number, v = unpacked(z, self.pivot)
        left = self.residual(self.unit * number, v) / self.size
        return np.concatenate([left.real, left.imag])

    def pair(self, z: Array, jacobian: Array) -> Eigenpair:
        """A solution."""
        number, v = unpacked(z, self.pivot)
        return Eigenpair(self.unit * number, v, self.size * jacobian, self.unit, self.pivot)


def solved(
    residual: Callable[[complex, Complex], Complex], start: tuple[complex, Complex], size: float
) -> Eigenpair | None:
    """Solution near `start`, the residual below `SOLVED` times `size`; None if none is found."""
    from scipy.optimize import least_squares  # 0.2 s: only where it is needed

    equations = RealEquations(residual, size, abs(start[0]) or 1.0, int(np.argmax(np.abs(start[1]))))
    begin = packed(start[0] / equations.unit, start[1], equations.pivot)
    found = least_squares(
        equations, begin, method="lm", max_nfev=EVALUATIONS, xtol=PRECISION, ftol=PRECISION, gtol=PRECISION
    )
    return equations.pair(found.x, found.jac) if np.max(np.abs(found.fun)) <= SOLVED else None


def solved_from(residual: Callable[[complex, Complex], Complex], known: Eigenpair, size: float) -> Eigenpair | None:
    """Solution near that of other equations; None if none is found.

    Broyden's method begins with the derivative there, which is not formed anew: evaluations with several harmonics cost
    eight to 25 times those with one. Where a residual is larger than the first it would lead to another
    solution, and the one nearby is looked for without that derivative.
    """
    equations = RealEquations(residual, size, known.unit, known.pivot)
    z, jacobian = known.unknowns, known.slope / size
    left = equations(z)
    most = float(np.linalg.norm(left))
    for _ in range(UPDATES):
        step = np.linalg.solve(jacobian, -left)
        z, left = z + step, equations(z + step)
        if np.max(np.abs(left)) <= SOLVED and np.max(np.abs(step)) <= SETTLED * np.max(np.abs(z)):
            nudged = [(equations(z + NUDGE * unit) - left) / NUDGE for unit in np.eye(len(z))]
            return equations.pair(z, np.column_stack(nudged))
        if not np.linalg.norm(left) <= most:
            break
        jacobian = jacobian + np.outer(left, step) / (step @ step)
    return solved(residual, (known.number, known.v), size)
