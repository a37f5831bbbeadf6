"""petalfoil: simulation of petal (multi-leaf foil) gas bearings.

::

    case = petalfoil.Case.load("case.toml")
    result = petalfoil.solve(case, speed="60000 rpm")      # an xarray.Dataset in SI units

The names below are loaded when they are first used, so that importing the package costs next to nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from petalfoil.api import check, converge, curve, solve, static
    from petalfoil.case import Case
    from petalfoil.errors import (
        ConvergenceError,
        DefinitionError,
        PackageError,
        PetalfoilError,
        StoreError,
        UnitError,
        UsageError,
    )

__version__ = "0.1.0"

__all__ = [
    "Case",
    "ConvergenceError",
    "DefinitionError",
    "PackageError",
    "PetalfoilError",
    "StoreError",
    "UnitError",
    "UsageError",
    "__version__",
    "check",
    "converge",
    "curve",
    "solve",
    "static",
]

_HOMES = {
    "Case": "petalfoil.case",
    "check": "petalfoil.api",
    "converge": "petalfoil.api",
    "curve": "petalfoil.api",
    "solve": "petalfoil.api",
    "static": "petalfoil.api",
}


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module 'petalfoil' has no attribute {name!r}")
    value = getattr(import_module(_HOMES.get(name, "petalfoil.errors")), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
