import subprocess
import sys
from importlib import metadata

import pytest

import petalfoil

NAMES = {
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
    "reproduce",
    "curve",
    "design_report",
    "liftoff",
    "load",
    "optimize",
    "orbit",
    "runup",
    "sensitivity",
    "save",
    "sobol_indices",
    "solve",
    "stability",
    "static",
    "sweep",
    "tolerance",
}


def test_the_public_names_are_these() -> None:
    assert set(petalfoil.__all__) == NAMES
    assert set(dir(petalfoil)) >= NAMES
    for name in NAMES:
        assert getattr(petalfoil, name) is not None


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="no attribute 'sovle'"):
        _ = petalfoil.sovle


def test_the_version_is_the_distribution_s() -> None:
    assert petalfoil.__version__ == metadata.version("petalfoil")


def test_importing_loads_nothing_heavy_and_a_case_of_numbers_no_pint() -> None:
    code = """
import sys, petalfoil
assert "numpy" not in sys.modules
from petalfoil.case import Bearing
Bearing(journal_radius=0.025, bushing_radius=0.026, length=0.05)
print([name for name in ("xarray", "matplotlib", "pandas", "dask", "pint", "scipy", "typer") if name in sys.modules])
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
