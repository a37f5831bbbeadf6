"""Choice of the inner loops: compiled by numba where it is installed, otherwise NumPy."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.columns import ContactColumns
from petalfoil.classic.film_cells import FilmCells
from petalfoil.compiled import numba_is_installed

Array = NDArray[np.float64]


class KernelBackend(StrEnum):
    """Implementation of the inner loops."""

    NUMBA = "numba"
    NUMPY = "numpy"


class Bands(NamedTuple):
    """Stiffness matrix of one petal by diagonals. All petals have the same.

    Attributes
    ----------
    values : (n_band, n) array
        `values[d, i]` multiplies unknown `i + offset[d]` in row `i` [1].
    offset : (n_band,) int array
        Offsets of the diagonals that are not empty.
    """

    values: Array
    offset: NDArray[np.int64]


class MarchSettings(NamedTuple):
    """Settings of a march: fraction of the stable step, time that multiplies a rate, tolerance, limit of steps."""

    fraction: float
    time: float
    tolerance: float
    max_steps: int


class DescentSettings(NamedTuple):
    """Settings of a descent: step length, momentum, tolerance, limit of steps."""

    step: float
    momentum: bool
    tolerance: float
    max_steps: int


class Kernels(NamedTuple):
    """The inner loops. They change their first argument in place and return (steps, remaining change or force)."""

    march: Callable[[Array, FilmCells, MarchSettings], tuple[int, float]]
    descend: Callable[[Array, Array, Bands, ContactColumns, DescentSettings], tuple[int, float]]


REFRESH = 32
"""Film steps between updates of the time step (59) and of the exponential fit. Both change slowly with the pressure."""

CHECK = 20
"""Descent steps between evaluations of the remaining force."""


@cache
def kernels(engine: KernelBackend | None = None) -> Kernels:
    """The inner loops of `engine`; None takes the fastest installed."""
    if engine is None:
        engine = KernelBackend.NUMBA if numba_is_installed() else KernelBackend.NUMPY
    if engine is KernelBackend.NUMBA:
        from petalfoil.classic import compiled_kernels as compiled

        return Kernels(compiled.march, compiled.descend)
    from petalfoil.classic import numpy_kernels as plain

    return Kernels(plain.march, plain.descend)
