"""A malformed case never starts a run: one message that names the key, exit code 2, nothing on standard output."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from petalfoil.cli.app import app

GOOD = """
title = "Eight petals"

[bearing]
journal_radius = "25 mm"
bushing_radius = "26 mm"
length = "50 mm"

[petals]
count = 8
arc_length = "45 mm"
thickness = "0.176 mm"
bend_radius = "40 mm"
mount = "hinged"
youngs_modulus = "200 GPa"
poisson_ratio = 0.3

[gas]
viscosity = "18.5 uPa*s"
ambient_pressure = "1 bar"

[operation]
speed = "8000 rad/s"
eccentricity = ["0 um", "-100 um"]

[model]
kind = "2d"
"""

# What is written instead of what, and what the message must name.
MALFORMED = {
    "unknown key": ("count = 8", 'count = 8\nwidth = "1 mm"', ["petals.width"]),
    "misspelt key": ("count = 8", "cuont = 8", ["petals.cuont", "count"]),
    "missing key": ('viscosity = "18.5 uPa*s"\n', "", ["gas.viscosity"]),
    "missing section": ('[gas]\nviscosity = "18.5 uPa*s"\nambient_pressure = "1 bar"\n', "", ["gas"]),
    "unknown section": ("[gas]", "[gass]", ["gass", "gas"]),
    "unit of something else": ('length = "50 mm"', 'length = "50 Pa"', ["bearing.length"]),
    "key twice": ("count = 8", "count = 8\ncount = 9", ["stands twice in its table"]),
    "no closing quote": ('length = "50 mm"', 'length = "50 mm', ["no closing quote"]),
    "no quotes": ('length = "50 mm"', "length = 50 mm", ["with the quotes"]),
    "one component": ('["0 um", "-100 um"]', '"-100 um"', ['such as ["-100 um", "-100 um"]']),
    "against the rotation": ('speed = "8000 rad/s"', 'speed = "-60000 rpm"', ["seen from its other end"]),
    "unknown unit": ('length = "50 mm"', 'length = "50 mmm"', ["bearing.length", "mmm"]),
    "not a number": ('length = "50 mm"', 'length = "long"', ["bearing.length"]),
    "not finite": ('length = "50 mm"', "length = nan", ["bearing.length"]),
    "below its range": ('length = "50 mm"', 'length = "-50 mm"', ["bearing.length"]),
    "not whole": ("count = 8", "count = 8.5", ["petals.count"]),
    "wrong type": ("count = 8", "count = [8]", ["petals.count"]),
    "unknown choice": ('mount = "hinged"', 'mount = "welded"', ["petals.mount", "hinged", "clamped"]),
    "three coordinates": ('["0 um", "-100 um"]', '["0 um", "-100 um", "0 um"]', ["operation.eccentricity"]),
    "method that is not there": ('kind = "2d"', 'kind = "2d"\nmethod = "clasic"', ["model.method", "classic"]),
    "no overlap": ('arc_length = "45 mm"', 'arc_length = "15 mm"', ["petals.arc_length"]),
    "does not fit": ('thickness = "0.176 mm"', 'thickness = "0.5 mm"', ["petals"]),
    "journal wider than bushing": ('journal_radius = "25 mm"', 'journal_radius = "27 mm"', ["bearing"]),
    "journal pushed into the bushing": ('"-100 um"', '"-2 mm"', ["operation.eccentricity"]),
    "not TOML": ('length = "50 mm"', 'length = "50 mm', ["line 7"]),
}


def run(tmp_path: Path, text: str | bytes, *arguments: str):
    """Run a verb on a case of this text."""
    path = tmp_path / "case.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return CliRunner().invoke(app, [arguments[0], str(path), *arguments[1:]], prog_name="petalfoil")


def refused(result) -> str:
    """Make sure that a case was refused as it should be, and give the message."""
    assert result.exit_code == 2, result.stderr
    assert result.stdout == ""
    assert result.stderr.startswith("Error: ")
    assert "Traceback" not in result.stderr
    return result.stderr


@pytest.mark.parametrize("name", MALFORMED)
@pytest.mark.parametrize("arguments", [("solve", "--json"), ("check",)])
def test_malformed_case(tmp_path: Path, name: str, arguments: tuple[str, ...]) -> None:
    old, new, named = MALFORMED[name]
    assert GOOD.count(old) == 1
    message = refused(run(tmp_path, GOOD.replace(old, new), *arguments))
    for word in named:
        assert word in message


@pytest.mark.parametrize("arguments", [("curve", "--eccentricity", "0 um : 100 um : 3"), ("static",)])
def test_curves_refuse_it_too(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    assert "petals.count" in refused(run(tmp_path, GOOD.replace("count = 8", "count = 0"), *arguments))


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    refused(run(tmp_path, b"\xff\xfe\x00", "solve"))


def test_an_empty_file(tmp_path: Path) -> None:
    assert "bearing" in refused(run(tmp_path, "", "solve"))


def test_a_case_that_is_not_there(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["solve", str(tmp_path / "absent.toml")], prog_name="petalfoil")
    assert "absent.toml" in refused(result)


def test_a_folder_is_no_case(tmp_path: Path) -> None:
    refused(CliRunner().invoke(app, ["solve", str(tmp_path)], prog_name="petalfoil"))


def test_a_picture_is_no_case(tmp_path: Path) -> None:
    assert "it is no text but a picture" in refused(run(tmp_path, b"\x89PNG\r\n\x1a\n\0\0", "check"))


def test_a_command_that_is_not_there() -> None:
    result = CliRunner().invoke(app, ["solv"])
    assert result.exit_code == 2
    assert "Did you mean 'solve'?" in result.output
