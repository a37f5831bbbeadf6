"""Which inner loops run: the compiled ones where numba is installed, else their NumPy twins."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from functools import cache
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.columns import Columns
from petalfoil.classic.film_cells import FilmCells

Array = NDArray[np.float64]


class Engine(StrEnum):
    """How the inner loops are run."""

    NUMBA = "numba"
    NUMPY = "numpy"


class Bands(NamedTuple):
    """Stiffness of one petal by diagonals; all petals are alike.

    Attributes
    ----------
    values : (n_band, n) array
        Entry `values[d, i]` multiplies unknown `i + offset[d]` in row `i` [1].
    offset : (n_band,) int array
        Diagonals that are not empty.
    """

    values: Array
    offset: NDArray[np.int64]


class March(NamedTuple):
    """How a march is driven: share of the stable step, time over which a rate counts, tolerance, most steps."""

    share: float
    time: float
    tolerance: float
    max_steps: int


class Descent(NamedTuple):
    """How a descent is driven: step, momentum, tolerance, most steps."""

    step: float
    momentum: bool
    tolerance: float
    max_steps: int


class Kernels(NamedTuple):
    """The inner loops; they change their first argument in place and return steps taken and what is left."""

    march: Callable[[Array, FilmCells, March], tuple[int, float]]
    descend: Callable[[Array, Array, Bands, Columns, Descent], tuple[int, float]]


REFRESH = 32
"""Film steps between renewals of the time step (59) and of the exponential fit, which follows the pressure slowly."""

CHECK = 20
"""Descent steps between looks at what is left."""


@cache
def kernels(engine: Engine | None = None) -> Kernels:
    """The inner loops of `engine`; of the fastest that is installed if None."""
    if engine is None:
        engine = Engine.NUMBA if numba_is_installed() else Engine.NUMPY
    if engine is Engine.NUMBA:
        from petalfoil.classic import numba_kernels as compiled

        return Kernels(compiled.march, compiled.descend)
    from petalfoil.classic import numpy_kernels as plain

    return Kernels(plain.march, plain.descend)


def numba_is_installed() -> bool:
    """Whether ``pip install petalfoil[classic]`` was done."""
    return find_spec("numba") is not None
