"""The file of an earlier run is never left where a run that ended early would have written."""

from __future__ import annotations

from pathlib import Path

import pytest

from petalfoil.cli.keeping import earlier_set_aside


def test_while_nothing_is_written_the_earlier_file_has_another_name(tmp_path: Path) -> None:
    """A run that is killed leaves no answer that looks like its own."""
    out, aside = tmp_path / "orbit.nc", tmp_path / "orbit.earlier.nc"
    out.write_text("earlier")
    with earlier_set_aside(out, None):
        assert not out.exists()
        assert aside.read_text() == "earlier"
        out.write_text("new")
    assert (out.read_text(), aside.exists()) == ("new", False)


def test_a_run_that_fails_says_where_the_earlier_file_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "orbit.nc"
    out.write_text("earlier")
    with pytest.raises(ValueError, match="lost"), earlier_set_aside(out, None):
        raise ValueError("lost")
    assert (tmp_path / "orbit.earlier.nc").read_text() == "earlier"
    assert "that of an earlier run is now orbit.earlier.nc" in capsys.readouterr().err


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    kept, out = tmp_path / "kept.nc", tmp_path / "orbit.nc"
    kept.write_text("earlier")
    out.symlink_to(kept)
    with earlier_set_aside(out, None):
        kept.write_text("new")
    assert out.is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept.nc", "orbit.nc"]


def test_a_file_that_the_run_goes_on_from_stays(tmp_path: Path) -> None:
    out = tmp_path / "curve.nc"
    out.write_text("half")
    with earlier_set_aside(out, out):
        assert out.read_text() == "half"
    assert out.read_text() == "half"
