"""petalfoil: simulation of petal (multi-leaf foil) gas bearings.

::

    case = petalfoil.Case.load("case.toml")
    result = petalfoil.solve(case, speed="60000 rpm")      # an xarray.Dataset in SI units

The names below are loaded when they are first used, so that importing the package costs next to nothing. A name that
is none of them may be an analysis that was declared while the program ran.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from petalfoil.analysis.balance import balance
    from petalfoil.analysis.capacity import capacity
    from petalfoil.analysis.check import check
    from petalfoil.analysis.coefficients import coefficients
    from petalfoil.analysis.converge import converge
    from petalfoil.analysis.curve import curve
    from petalfoil.analysis.film_force import Film
    from petalfoil.analysis.liftoff import liftoff
    from petalfoil.analysis.orbit import orbit
    from petalfoil.analysis.runup import runup
    from petalfoil.analysis.sensitivity import sensitivity
    from petalfoil.analysis.solve import solve
    from petalfoil.analysis.stability import stability
    from petalfoil.analysis.static import static
    from petalfoil.case import Case
    from petalfoil.errors import (
        ConvergenceError,
        DefinitionError,
        PackError,
        PetalfoilError,
        StoreError,
        UnitError,
        UsageError,
    )
    from petalfoil.report.case_report import design_report
    from petalfoil.report.reproduce import reproduce
    from petalfoil.results.store import load, save
    from petalfoil.studies.optimize import optimize
    from petalfoil.studies.sobol import sobol_indices
    from petalfoil.studies.sweep import sweep
    from petalfoil.studies.tolerance import tolerance

__version__ = "0.1.0"

__all__ = [
    "Case",
    "ConvergenceError",
    "DefinitionError",
    "Film",
    "PackError",
    "PetalfoilError",
    "StoreError",
    "UnitError",
    "UsageError",
    "__version__",
    "balance",
    "capacity",
    "check",
    "coefficients",
    "converge",
    "curve",
    "design_report",
    "liftoff",
    "load",
    "optimize",
    "orbit",
    "reproduce",
    "runup",
    "save",
    "sensitivity",
    "sobol_indices",
    "solve",
    "stability",
    "static",
    "sweep",
    "tolerance",
]

_HOMES = {
    "Case": "petalfoil.case",
    "Film": "petalfoil.analysis.film_force",
    "design_report": "petalfoil.report.case_report",
    "load": "petalfoil.results.store",
    "optimize": "petalfoil.studies.optimize",
    "reproduce": "petalfoil.report.reproduce",
    "save": "petalfoil.results.store",
    "sobol_indices": "petalfoil.studies.sobol",
    "sweep": "petalfoil.studies.sweep",
    "tolerance": "petalfoil.studies.tolerance",
}


def __getattr__(name: str) -> object:
    if name.startswith("_"):
        raise AttributeError(f"module 'petalfoil' has no attribute {name!r}")
    from petalfoil.analysis import known_verbs

    value: object = known_verbs.find(name)
    if value is not None:
        return value
    if name not in __all__:
        raise AttributeError(f"module 'petalfoil' has no attribute {name!r}")
    value = getattr(import_module(_HOMES.get(name, "petalfoil.errors")), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
