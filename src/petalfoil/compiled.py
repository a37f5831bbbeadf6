"""Loops compiled by numba, where it is installed."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar, cast

F = TypeVar("F", bound=Callable[..., Any])


def numba_is_installed() -> bool:
    """Whether numba is installed (``pip install petalfoil[fast]``)."""
    return find_spec("numba") is not None


def compiled(function: F) -> F:
    """Compile at the first call and keep the result on disk; as it is where numba is not installed.

    What is on disk bears a digest of its sources in its name. By itself numba looks at the function's own file alone:
    it would take loops with constants or named tuples of an earlier version, or fail to read them.
    """
    if not numba_is_installed():
        return function
    import numba

    function.__qualname__ += f"_{digest(function.__module__)}"
    return cast(F, numba.njit(cache=True, error_model="numpy")(function))


@cache
def digest(module: str) -> str:
    """A digest of what the loops of a module are made of.

    Its file, those it imports classes and functions from, and its constants.
    """
    inside = {name: value for name, value in vars(sys.modules[module]).items() if not name.startswith("__")}
    owners = {str(getattr(value, "__module__", "")) for value in inside.values()}
    files = sorted({module, *(name for name in owners if name.startswith("petalfoil."))})
    numbers = sorted((name, value) for name, value in inside.items() if isinstance(value, (int, float)))
    found = hashlib.sha256(repr(numbers).encode())
    for name in files:
        found.update(Path(str(sys.modules[name].__file__)).read_bytes())
    return found.hexdigest()[:12]
