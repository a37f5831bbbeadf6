"""Natural modes on the command line: as JSON, as a table, read back from a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from petalfoil.analysis.stability import MODES
from tests.cases import EXAMPLES

PLAIN = str(EXAMPLES / "plain_journal.toml")


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """The plain journal on a small grid."""
    from petalfoil.case import Case

    path = tmp_path / "small.toml"
    path.write_text(Case.load(PLAIN).replace(**{"model.cells_per_pitch": 24, "model.axial_cells": 8}).to_toml())
    return path


@pytest.mark.slow
def test_modes_are_lists_by_frequency_and_come_back_from_a_file(cli, small: Path, tmp_path: Path) -> None:
    out = tmp_path / "modes.nc"
    answer = json.loads(cli("stability", str(small), "--mass", "1 kg", "--json", "--out", str(out)).stdout)
    frequencies = answer["natural_frequency"]
    assert len(frequencies) >= 2
    assert frequencies == sorted(frequencies)
    assert {len(answer[name]) for name in MODES} == {len(frequencies)}
    assert json.loads(cli("show", str(out), "--json").stdout) == answer
    table = cli("show", str(out)).stdout
    assert "natural" in table
    assert f"{frequencies[0] * 30.0 / 3.141592653589793:.0f}" in table


def test_without_a_mass_modes_are_null(cli, small: Path) -> None:
    result = cli("stability", str(small), "--json")
    answer = json.loads(result.stdout)
    assert [answer[name] for name in MODES] == [None] * len(MODES)
    assert "natural" not in cli("stability", small).stdout
