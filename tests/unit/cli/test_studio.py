"""`petalfoil studio` refuses what it cannot serve before it starts anything."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from petalfoil.cli.app import app
from tests.cases import EXAMPLES


@pytest.mark.slow
def test_a_case_that_is_refused_is_told_by_key(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text((EXAMPLES / "paper_n8.toml").read_text().replace("count = 8", "count = 1"))
    result = CliRunner().invoke(app, ["studio", str(path), "--no-browser"])
    assert result.exit_code == 2
    assert "petals.count" in result.stderr


def test_without_the_extra_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("petalfoil.cli.studio.find_spec", lambda name: None)
    result = CliRunner().invoke(app, ["studio", "--no-browser"])
    assert result.exit_code == 2
    assert "petalfoil[studio]" in result.stderr


def test_a_port_is_a_number_of_16_bits() -> None:
    result = CliRunner().invoke(app, ["studio", "--port", "70000"])
    assert result.exit_code == 2
    assert "65535" in result.output
