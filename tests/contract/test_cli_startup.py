"""The package and its help come up at once: nothing heavy is loaded before a verb needs it."""

from __future__ import annotations

import resource
import subprocess
import sys

import pytest

LIBRARIES = "import typer.rich_utils"  # what draws a help text, whoever asks for it
SHARE = 2.2
"""Processor time of a start over that of its libraries alone: `--help` takes 1.4 to 1.8, `--version` 0.9."""

HEAVY = ("CoolProp", "xarray", "matplotlib", "pandas", "dask", "pint", "netCDF4")
NUMBERS = ("numpy", "scipy", "pydantic")  # an analysis loads them, the list of commands does not

IMPORT = "import petalfoil"
HELP = """
import sys
from petalfoil.cli import main
sys.argv = ["petalfoil", *{arguments}]
try:
    main()
except SystemExit as end:
    assert end.code == 0, end.code
"""
SPEAK = "\nimport sys; sys.stderr.write(' '.join(sorted({module.partition('.')[0] for module in sys.modules})))"

STARTS = {
    "import": IMPORT,
    "--help": HELP.format(arguments=["--help"]),
    "--version": HELP.format(arguments=["--version"]),
    "solve --help": HELP.format(arguments=["solve", "--help"]),
}


@pytest.mark.parametrize("start", STARTS)
def test_nothing_heavy_is_loaded(start: str) -> None:
    code = STARTS[start] + SPEAK
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stderr.split())
    assert "petalfoil" in loaded
    assert loaded.isdisjoint(HEAVY if start == "solve --help" else HEAVY + NUMBERS)


def cpu_time(arguments: list[str]) -> float:
    """Processor time of a fresh interpreter [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


@pytest.mark.parametrize("arguments", [["-c", IMPORT], ["-m", "petalfoil", "--help"], ["-m", "petalfoil", "--version"]])
def test_start_takes_little_cpu(arguments: list[str]) -> None:
    times = [(cpu_time(arguments), cpu_time(["-c", LIBRARIES])) for _ in range(3)]
    assert min(own for own, _ in times) < SHARE * min(libraries for _, libraries in times)
