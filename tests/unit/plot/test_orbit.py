"""Figures of a motion: the numbers in them are those of the path."""

from __future__ import annotations

import base64
import io
import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path as File

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.testing import assert_allclose
from PIL import Image

from petalfoil import plot
from petalfoil.errors import StoreError, UsageError
from petalfoil.plot.animation import DELAY
from petalfoil.results.dataset import to_dataset
from petalfoil.results.store import load, save
from tests.unit.results.paths import SPEED, moved, ramped, whirling

Texts = Callable[[Figure], str]
RPM = 30.0 / math.pi


@pytest.fixture
def steady() -> xr.Dataset:
    return to_dataset(moved(whirling(16.0, (0.5, 1e-5), (1.0, 4e-6)), touching=True))


@pytest.fixture
def rising() -> xr.Dataset:
    return to_dataset(moved(ramped(4000.0, 0.2, 1.0, 1e-5)))


def line(ax: Axes, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Places of the line with a label or a mark."""
    (found,) = [item for item in ax.lines if name in (item.get_label(), item.get_gid())]
    return np.asarray(found.get_xdata(), float), np.asarray(found.get_ydata(), float)


def panel(fig: Figure, label: str) -> Axes:
    """The panel with a label on its vertical axis."""
    (found,) = [ax for ax in fig.axes if label in ax.get_ylabel()]
    return found


def test_the_overview_shows_everything_of_a_motion(steady: xr.Dataset, texts: Texts) -> None:
    said = texts(plot.summary(steady))
    for part in (
        "9549 rpm".replace("9549", "9\u2009549"),
        "rotor 3 kg",
        "16 turns",
        "once a turn",
        "½×",
        "1×",
        "defect",
    ):
        assert part in said
    for part in ("journal touches the bore, 24 µm", "contact share", "smallest film", "work of the loads"):
        assert part in said


def test_a_figure_is_drawn_from_the_file_alone(steady: xr.Dataset, tmp_path: File) -> None:
    save(steady, tmp_path / "orbit.nc")
    plot.save(plot.summary(load(tmp_path / "orbit.nc")), tmp_path / "orbit.png")
    assert (tmp_path / "orbit.png").read_bytes().startswith(b"\x89PNG")


def test_the_path_is_in_its_room_with_its_points_once_a_turn(steady: xr.Dataset) -> None:
    wide, close = plot.orbit_path(steady).axes
    assert_allclose(np.hypot(*line(wide, "circle of contact")), 24.0, rtol=1e-9)
    x, y = line(close, "once a turn")
    assert_allclose(x, [14.0, -6.0] * 8 + [14.0], rtol=1e-3)
    assert_allclose(y, 0.0, rtol=0.0, atol=0.02)
    assert_allclose(line(close, "start"), [[14.0], [0.0]], rtol=1e-9, atol=1e-9)
    assert_allclose(line(close, "end")[0], 1e6 * steady["x"].values[-1:], rtol=1e-9)
    assert np.hypot(*np.subtract(close.get_xlim(), wide.get_xlim())) > 0.0  # the right panel is closer


def test_without_its_case_there_is_no_circle(steady: xr.Dataset) -> None:
    steady.attrs["case"] = ""
    wide = plot.orbit_path(steady).axes[0]
    assert not [item for item in wide.lines if item.get_gid() == "circle of contact"]


def test_histories_at_one_speed_are_over_turns(steady: xr.Dataset, texts: Texts) -> None:
    fig = plot.orbit_histories(steady)
    assert "turns of the shaft" in texts(fig)
    assert len(fig.axes) == 3
    turns, x = line(panel(fig, "displacement"), "x")
    assert_allclose([turns[0], turns[-1]], [0.0, 16.0], rtol=1e-9, atol=1e-9)
    assert_allclose(x, 1e6 * steady["x"].values, rtol=1e-12)


def test_histories_at_a_changing_speed_are_over_time(rising: xr.Dataset, texts: Texts) -> None:
    fig = plot.orbit_histories(rising)
    assert "time  t [ms]" in texts(fig)
    assert "no contact" in texts(fig)
    (speed,) = panel(fig, "speed").lines
    assert_allclose(np.asarray(speed.get_ydata())[-1], 4000.0 * RPM, rtol=1e-12)
    assert_allclose(np.asarray(speed.get_xdata())[-1], 200.0, rtol=1e-12)


def test_the_spectrum_has_its_peaks_on_the_lines(steady: xr.Dataset) -> None:
    (ax,) = plot.orbit_spectrum(steady).axes
    hertz, height = line(ax, "spectrum")
    whirl = SPEED / (4.0 * math.pi)
    assert_allclose(hertz[np.argmax(height)], whirl, rtol=0.01)
    assert_allclose(height.max(), 10.0, rtol=0.01)
    assert_allclose(np.interp(2.0 * whirl, hertz, height), 4.0, rtol=0.02)


def test_the_waterfall_is_over_a_speed_that_rises(rising: xr.Dataset) -> None:
    fig = plot.orbit_spectrum(rising)
    ax = fig.axes[0]
    assert ax.get_ylabel() == "speed [rpm]"
    assert 0.0 < ax.get_ylim()[0] < ax.get_ylim()[1] < 4000.0 * RPM
    once = ax.lines[0]
    assert_allclose(np.asarray(once.get_xdata()) * 60.0, once.get_ydata(), rtol=1e-9)  # 1× is Hz = rpm / 60


def test_the_waterfall_of_one_speed_is_over_turns(steady: xr.Dataset) -> None:
    assert plot.orbit_waterfall(steady).axes[0].get_ylabel() == "turns of the shaft"


def test_a_few_turns_have_no_spectrum(texts: Texts) -> None:
    short = to_dataset(moved(whirling(1.0, (1.0, 1e-5))))
    for draw in (plot.orbit, plot.orbit_spectrum, plot.orbit_waterfall):
        assert "1 turns tell no spectrum" in texts(draw(short))


def test_a_shaft_at_rest_is_drawn(texts: Texts) -> None:
    path = whirling(1.0, (1.0, 1e-5))
    at_rest = replace(path, angle=0.0 * path.angle, speed=0.0 * path.speed)
    assert "0 turns tell no spectrum" in texts(plot.orbit(to_dataset(moved(at_rest))))
    assert "time  t [ms]" in texts(plot.orbit_histories(to_dataset(moved(at_rest))))


def test_the_energy_balances(steady: xr.Dataset, texts: Texts) -> None:
    fig = plot.orbit_energy(steady)
    above = fig.axes[0]
    parts = {name: line(above, name)[1] for name in ("work of the loads", "work of the film")}
    gained, defect = line(above, "gained by rotor and petals")[1], line(above, "defect")[1]
    assert_allclose(parts["work of the loads"] + parts["work of the film"] + defect, gained, rtol=1e-9, atol=1e-9)
    assert_allclose(defect, 0.0, rtol=0.0, atol=1e-9 * np.abs(parts["work of the film"]).max())
    assert "largest defect: 1.0e-04" in texts(fig)


@pytest.mark.parametrize(
    "draw",
    [
        plot.orbit,
        plot.orbit_path,
        plot.orbit_histories,
        plot.orbit_spectrum,
        plot.orbit_waterfall,
        plot.orbit_energy,
        lambda ds: plot.animate(ds, "nothing.gif"),
    ],
)
def test_what_is_no_motion_is_not_drawn(draw: Callable[[xr.Dataset], object], flat: xr.Dataset) -> None:
    with pytest.raises(UsageError, match="orbit"):
        draw(flat)


def test_a_start_alone_is_not_drawn(steady: xr.Dataset) -> None:
    with pytest.raises(UsageError, match="no step yet"):
        plot.orbit(steady.isel(time=[0]))


# ---------------------------------------------------------------------------------------------- animation


def test_a_page_holds_its_pictures(steady: xr.Dataset, tmp_path: File) -> None:
    plot.animate(steady.assign_attrs(title="A <b>earing"), tmp_path / "orbit.html")
    page = (tmp_path / "orbit.html").read_text(encoding="utf-8")
    (found,) = re.findall(r"^const frames = (\[.*\]);$", page, re.MULTILINE)
    pictures = [base64.b64decode(text.removeprefix("data:image/png;base64,")) for text in json.loads(found)]
    assert len(pictures) == steady.sizes["frame"] == 3
    assert len({Image.open(io.BytesIO(picture)).convert("RGB").tobytes() for picture in pictures}) == 3
    assert not re.findall(r"(?:src|href)\s*=\s*[\"']?https?:", page)
    assert "<title>A &lt;b&gt;earing</title>" in page
    assert "@" not in page.replace(found, "")
    assert [path.name for path in tmp_path.iterdir()] == ["orbit.html"]


def test_a_gif_plays_its_pictures_for_ever(steady: xr.Dataset, tmp_path: File) -> None:
    plot.animate(steady, tmp_path / "orbit.gif")
    with Image.open(tmp_path / "orbit.gif") as picture:
        assert picture.n_frames == 3
        assert picture.info["duration"] == DELAY
        assert picture.info["loop"] == 0
        assert picture.convert("RGB").getpixel((2, 2)) == (255, 255, 255)


def test_an_animation_that_cannot_be_written_says_so(steady: xr.Dataset, tmp_path: File) -> None:
    with pytest.raises(UsageError, match=r"\.html, \.gif"):
        plot.animate(steady, tmp_path / "orbit.mp4")
    with pytest.raises(StoreError, match="cannot write"):
        plot.animate(steady, tmp_path / "missing" / "orbit.gif")
