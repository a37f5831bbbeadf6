"""A case to begin with: valid as it is written, and never in place of another file."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from petalfoil.case import Case, warnings_of
from petalfoil.cli.app import app
from petalfoil.cli.new import StartingWall


@pytest.mark.parametrize("wall", StartingWall)
def test_a_starting_case_is_a_case(tmp_path: Path, wall: StartingWall) -> None:
    path = tmp_path / "case.toml"
    result = CliRunner().invoke(app, ["new", str(path), "--wall", wall.value])
    assert result.exit_code == 0, result.output
    case = Case.load(path)
    assert (case.petals is not None, case.bump_foil is not None) == (wall == "petals", wall == "bump-foil")
    assert case.operation.load is not None
    assert warnings_of(case, {}) == []


def test_values_that_are_marked_as_defaults_are_defaults(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    CliRunner().invoke(app, ["new", str(path)])
    lines = path.read_text().splitlines()
    bare = [line for line in lines if "# default" not in line]
    assert len(bare) < len(lines)
    assert Case.from_toml("\n".join(bare)) == Case.load(path)


def test_a_file_that_exists_is_not_touched(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text("mine")
    result = CliRunner().invoke(app, ["new", str(path)])
    assert result.exit_code == 2
    assert "is not touched" in result.output
    assert path.read_text() == "mine"


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["new", str(tmp_path / "nowhere" / "case.toml")])
    assert result.exit_code == 2
    assert "cannot be written" in result.output
