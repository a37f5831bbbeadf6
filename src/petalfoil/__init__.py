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
    from petalfoil.api import (
        balance,
        check,
        coefficients,
        converge,
        curve,
        liftoff,
        orbit,
        reproduce,
        runup,
        solve,
        stability,
        static,
    )
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
    "balance",
    "check",
    "coefficients",
    "converge",
    "curve",
    "liftoff",
    "orbit",
    "reproduce",
    "runup",
    "solve",
    "stability",
    "static",
]

_HOMES = {
    "Case": "petalfoil.case",
    "balance": "petalfoil.api",
    "check": "petalfoil.api",
    "coefficients": "petalfoil.api",
    "converge": "petalfoil.api",
    "curve": "petalfoil.api",
    "liftoff": "petalfoil.api",
    "orbit": "petalfoil.api",
    "reproduce": "petalfoil.api",
    "runup": "petalfoil.api",
    "solve": "petalfoil.api",
    "stability": "petalfoil.api",
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
