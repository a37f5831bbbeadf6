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


def is_on_disk(file: Path, function: str, sources: Path) -> bool:
    """Whether a compiled `function` of a `file` lies beside it and is younger than all `sources` below a folder.

    numba need not be imported for that. Where the folder of the file cannot be written, numba keeps what it compiles
    in another one, which is not looked at.
    """
    written = max(source.stat().st_mtime for source in sources.rglob("*.py"))
    indices = (file.parent / "__pycache__").glob(f"{file.stem}.{function}_*.nbi")
    return any(index.stat().st_mtime > written for index in indices)


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
