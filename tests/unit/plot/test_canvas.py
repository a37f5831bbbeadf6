import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr
from matplotlib.figure import Figure

from petalfoil import plot
from petalfoil.errors import StoreError, UsageError
from petalfoil.plot import style

STARTS = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml", "PNG": b"\x89PNG"}


def line() -> Figure:
    figure = style.figure(3.0, 2.0)
    figure.subplots().plot([0.0, 1.0], [0.0, 1.0])
    return figure


@pytest.fixture
def fig() -> Figure:
    return line()


@pytest.mark.parametrize("suffix", STARTS)
def test_the_suffix_chooses_the_format(suffix: str, fig: Figure, tmp_path: Path) -> None:
    plot.save(fig, tmp_path / f"figure.{suffix}")
    assert (tmp_path / f"figure.{suffix}").read_bytes().startswith(STARTS[suffix])
    assert len(list(tmp_path.iterdir())) == 1


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "pdf"])
def test_drawing_again_gives_the_same_file(suffix: str, tmp_path: Path) -> None:
    for name in ("a", "b"):
        plot.save(line(), tmp_path / f"{name}.{suffix}")
    assert (tmp_path / f"a.{suffix}").read_bytes() == (tmp_path / f"b.{suffix}").read_bytes()


@pytest.mark.parametrize("name", ["figure.jpg", "figure", "figure.nc", ".png"])
def test_other_formats_are_refused_by_name(name: str, fig: Figure, tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"\.png, \.pdf, \.svg"):
        plot.save(fig, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_failing_write_leaves_the_former_file(fig: Figure, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "figure.png"
    plot.save(fig, target)
    before = target.read_bytes()

    def half_written(path: Path, **_: object) -> None:
        path.write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(fig, "savefig", half_written)
    with pytest.raises(StoreError, match="no space left"):
        plot.save(fig, target)
    assert target.read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["figure.png"]


def test_a_folder_that_is_not_there_is_a_store_error(fig: Figure, tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="cannot write"):
        plot.save(fig, tmp_path / "nowhere" / "figure.png")


def test_a_figure_shows_itself_in_a_notebook(flat: xr.Dataset) -> None:
    shown = plot.summary(flat)._repr_png_()
    assert shown.startswith(STARTS["png"])


@pytest.mark.slow
def test_showing_a_figure_neither_loads_pyplot_nor_opens_a_window() -> None:
    code = (
        "import sys, xarray as xr; from petalfoil import plot; "
        "ds = xr.Dataset({'x': ('n', [1.0, 2.0])}, {'n': [1.0, 2.0]}); "
        "assert plot.summary(ds)._repr_png_(); assert 'matplotlib.pyplot' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
