"""Loops compiled by numba, where it is installed."""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def numba_is_installed() -> bool:
    """Whether numba is installed (``pip install petalfoil[fast]``)."""
    return find_spec("numba") is not None


def compiled(function: F) -> F:
    """Compile at the first call and keep the result on disk; as it is where numba is not installed.

    Functions that call each other stand in one file: what is on disk is renewed when its own file changes.
    """
    if not numba_is_installed():
        return function
    import numba

    return cast(F, numba.njit(cache=True, error_model="numpy")(function))
