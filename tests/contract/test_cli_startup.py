"""The package and its help come up at once: nothing heavy is loaded before a verb needs it."""

from __future__ import annotations

import resource
import subprocess
import sys

import pytest

from tests.cases import EXAMPLES

LIBRARIES = "import typer.rich_utils"  # what draws a help text, whoever asks for it
SHARE = 2.2
"""Processor time of a start over that of its libraries alone: `--help` takes 1.4 to 1.8, `--version` 0.9."""

RUN_LIBRARIES = f"{LIBRARIES}, pydantic, scipy.linalg, scipy.sparse.linalg"  # what every run takes
RUN_SHARE = 3.0
"""The same of `check` over the libraries of a run: 2.0 to 2.4; 4 where units are read by pint."""

HEAVY = ("CoolProp", "xarray", "matplotlib", "pandas", "dask", "pint", "netCDF4")
NUMBERS = ("numpy", "scipy", "pydantic")  # an analysis loads them, the list of commands does not
RARE = ("scipy.integrate", "scipy.interpolate", "scipy.optimize", "scipy.special", "scipy.spatial", "scipy.stats")

CASE = str(EXAMPLES / "paper_n8.toml")
IMPORT = "import petalfoil"
RUN = """
import sys
from petalfoil.cli import main
sys.argv = ["petalfoil", *{arguments}]
try:
    main()
except SystemExit as end:
    assert end.code == 0, end.code
"""
SPEAK = "\nimport sys; sys.stderr.write('\\n' + ' '.join(sorted(sys.modules)))"

STARTS = {
    "import": (IMPORT, HEAVY + NUMBERS),
    "--help": (RUN.format(arguments=["--help"]), HEAVY + NUMBERS),
    "--version": (RUN.format(arguments=["--version"]), HEAVY + NUMBERS),
    "solve --help": (RUN.format(arguments=["solve", "--help"]), HEAVY + RARE),
    "check": (RUN.format(arguments=["check", CASE]), HEAVY + RARE),
    "solve": (RUN.format(arguments=["solve", CASE, "--eccentricity", "0 um, -100 um"]), HEAVY + RARE),
}


@pytest.mark.parametrize("start", STARTS)
def test_nothing_heavy_is_loaded(start: str) -> None:
    code, unwanted = STARTS[start]
    done = subprocess.run([sys.executable, "-c", code + SPEAK], capture_output=True, text=True, check=True)
    loaded = set(done.stderr.splitlines()[-1].split())
    assert "petalfoil" in loaded
    assert loaded.isdisjoint(unwanted)


def cpu_time(arguments: list[str]) -> float:
    """Processor time of a fresh interpreter [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


@pytest.mark.parametrize(
    ("arguments", "libraries", "share"),
    [
        (["-c", IMPORT], LIBRARIES, SHARE),
        (["-m", "petalfoil", "--help"], LIBRARIES, SHARE),
        (["-m", "petalfoil", "--version"], LIBRARIES, SHARE),
        (["-m", "petalfoil", "check", CASE], RUN_LIBRARIES, RUN_SHARE),
    ],
)
def test_start_takes_little_cpu(arguments: list[str], libraries: str, share: float) -> None:
    times = [(cpu_time(arguments), cpu_time(["-c", libraries])) for _ in range(3)]
    assert min(own for own, _ in times) < share * min(libraries for _, libraries in times)
