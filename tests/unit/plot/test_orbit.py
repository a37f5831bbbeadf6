"""Figures of a motion: the numbers in them are those of the path."""

from __future__ import annotations

import base64
import html
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
from petalfoil.plot import animation
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
    (found,) = [ax for ax in fig.axes if label in ax.get_ylabel().replace("\n", " ")]
    return found


def test_the_overview_shows_everything_of_a_motion(steady: xr.Dataset, texts: Texts) -> None:
    said = texts(plot.summary(steady))
    for part in (
        "9549 rpm".replace("9549", "9\u2009549"),
        "rotor 3 kg",
        "16 revolutions",
        "once per revolution",
        "½×",
        "1×",
        "energy-balance error 1.0e-04",
    ):
        assert part in said
    for part in ("contact with the bore, 24 µm", "contact\nfraction", "minimum film\nthickness"):
        assert part in said


@pytest.mark.slow
def test_a_figure_is_drawn_from_the_file_alone(steady: xr.Dataset, tmp_path: File) -> None:
    save(steady, tmp_path / "orbit.nc")
    plot.save(plot.summary(load(tmp_path / "orbit.nc")), tmp_path / "orbit.png")
    assert (tmp_path / "orbit.png").read_bytes().startswith(b"\x89PNG")


def test_the_path_has_its_points_once_per_revolution(steady: xr.Dataset) -> None:
    (ax,) = plot.orbit_path(steady).axes
    x, y = line(ax, "once per revolution")
    assert_allclose(x, [14.0, -6.0] * 8 + [14.0], rtol=1e-3)
    assert_allclose(y, 0.0, rtol=0.0, atol=0.02)
    assert_allclose(line(ax, "start"), [[14.0], [0.0]], rtol=1e-9, atol=1e-9)
    assert_allclose(line(ax, "end")[0], 1e6 * steady["x"].values[-1:], rtol=1e-9)


def test_the_panel_is_scaled_to_the_path(steady: xr.Dataset) -> None:
    small = steady.assign({name: 1e-3 * steady[name] for name in ("x", "y", "velocity_x", "velocity_y")})
    for ds in (steady, small):
        fig = plot.orbit_path(ds)
        fig.draw_without_rendering()
        (ax,) = fig.axes
        extent = 1e6 * max(np.ptp(ds["x"].values), np.ptp(ds["y"].values))
        low, high = ax.get_xlim()
        assert 0.4 < extent / (high - low) < 1.0
        assert low < 1e6 * ds["x"].values.min() < 1e6 * ds["x"].values.max() < high
        assert ax.get_ylim()[0] < 1e6 * ds["y"].values.min()
        assert 1e6 * ds["y"].values.max() < ax.get_ylim()[1]


def test_the_clearance_circle_is_drawn_where_it_is_in_view_and_told_where_it_is_not(
    steady: xr.Dataset, texts: Texts
) -> None:
    (ax,) = plot.orbit_path(steady).axes
    assert_allclose(np.hypot(*line(ax, "clearance circle")), 24.0, rtol=1e-9)
    small = steady.assign({name: 1e-2 * steady[name] for name in ("x", "y", "velocity_x", "velocity_y")})
    fig = plot.orbit_path(small)
    assert "outside this view: contact with the bore, 24 µm" in texts(fig)
    assert not [item for item in fig.axes[0].lines if item.get_gid() == "clearance circle"]


def test_without_its_case_there_is_no_circle(steady: xr.Dataset, texts: Texts) -> None:
    steady.attrs["case"] = ""
    assert "contact with the bore" not in texts(plot.orbit_path(steady))


def test_the_legend_of_the_path_covers_no_point_of_it(steady: xr.Dataset) -> None:
    for fig in (plot.orbit_path(steady), plot.orbit(steady)):
        fig.draw_without_rendering()
        ax = fig.axes[0]
        box = ax.get_legend().get_window_extent()
        path = ax.transData.transform(1e6 * np.stack([steady["x"].values, steady["y"].values], axis=-1))
        assert box.y0 > path[:, 1].max()
        assert ax.bbox.x0 <= box.x0
        assert box.x1 <= ax.bbox.x1


@pytest.mark.slow
def test_the_overview_leaves_the_energy_balance_to_its_own_figure(steady: xr.Dataset) -> None:
    assert not [ax for ax in plot.orbit(steady).axes if "energy" in ax.get_ylabel()]
    assert [ax for ax in plot.orbit_energy(steady).axes if "energy" in ax.get_ylabel()]


@pytest.mark.slow
def test_a_shaft_that_tilts_shows_its_slope(steady: xr.Dataset, texts: Texts) -> None:
    assert "shaft slope" not in texts(plot.orbit(steady))
    tilting = steady.assign(slope_x=("time", 2.0 * steady["x"].values), slope_y=("time", steady["y"].values))
    for fig in (plot.orbit(tilting), plot.orbit_histories(tilting)):
        slopes = panel(fig, "shaft slope").lines
        assert_allclose(slopes[0].get_ydata(), 2e6 * steady["x"].values, rtol=1e-12)


def test_histories_at_one_speed_are_over_turns(steady: xr.Dataset, texts: Texts) -> None:
    fig = plot.orbit_histories(steady)
    assert "revolutions of the shaft" in texts(fig)
    assert len(fig.axes) == 4
    turns, x = (np.asarray(values, float) for values in panel(fig, "along x").lines[0].get_data())
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


def test_the_waterfall_ends_where_its_content_does_and_covers_what_its_pieces_do_not_tell(
    rising: xr.Dataset, texts: Texts
) -> None:
    fig = plot.orbit_waterfall(rising)
    ax = fig.axes[0]
    fastest = float(rising["shaft_speed"].max()) / (2.0 * math.pi)
    assert fastest <= ax.get_xlim()[1] < 2.2 * fastest
    (cover,) = [patch for patch in ax.patches if patch.get_gid() == "drift"]
    half = cover.get_width() / 2
    assert 0.0 < half < fastest
    assert f"below {half:.0f} Hz" in texts(fig)


def test_the_waterfall_of_one_speed_is_over_turns(steady: xr.Dataset) -> None:
    assert plot.orbit_waterfall(steady).axes[0].get_ylabel() == "revolutions of the shaft"


@pytest.mark.slow
def test_a_few_turns_have_no_spectrum(texts: Texts) -> None:
    short = to_dataset(moved(whirling(1.0, (1.0, 1e-5))))
    for draw in (plot.orbit, plot.orbit_spectrum, plot.orbit_waterfall):
        assert "no spectrum from 1 revolutions" in texts(draw(short))


def test_a_shaft_at_rest_is_drawn(texts: Texts) -> None:
    path = whirling(1.0, (1.0, 1e-5))
    at_rest = replace(path, angle=0.0 * path.angle, speed=0.0 * path.speed)
    assert "no spectrum from 0 revolutions" in texts(plot.orbit(to_dataset(moved(at_rest))))
    assert "time  t [ms]" in texts(plot.orbit_histories(to_dataset(moved(at_rest))))


def test_the_energy_balances(steady: xr.Dataset, texts: Texts) -> None:
    fig = plot.orbit_energy(steady)
    above = fig.axes[0]
    parts = {name: line(above, name)[1] for name in ("work of the loads", "work of the film")}
    gained, error = line(above, "gained by rotor and petals")[1], line(above, "balance error")[1]
    assert_allclose(parts["work of the loads"] + parts["work of the film"] + error, gained, rtol=1e-9, atol=1e-9)
    assert_allclose(error, 0.0, rtol=0.0, atol=1e-9 * np.abs(parts["work of the film"]).max())
    assert "energy-balance error 1.0e-04" in texts(fig)


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


@pytest.mark.slow
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
    assert "b>earing" not in page
    assert [path.name for path in tmp_path.iterdir()] == ["orbit.html"]


@pytest.fixture
def blank_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Three pictures that need no drawing, for what is asked of the page around them."""
    pictures = [Image.new("RGB", (2, 2)) for _ in range(3)]
    monkeypatch.setattr(animation, "frames", lambda ds: iter(pictures))


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.parametrize("title", ["@FRAMES@", "@DELAY@ @TITLE@", "</title><script>alert(1)</script>", "\\g<0> \\1"])
def test_a_title_fills_no_placeholder_and_closes_no_tag(title: str, steady: xr.Dataset, tmp_path: File) -> None:
    plot.animate(steady.assign_attrs(title=title), tmp_path / "orbit.html")
    page = (tmp_path / "orbit.html").read_text(encoding="utf-8")
    assert f"<title>{html.escape(title)}</title>" in page
    assert page.count("data:image/png;base64,") == 3
    assert page.count("<script>") == 1


@pytest.mark.usefixtures("blank_pictures")
def test_a_title_brings_no_control_character_to_the_page(steady: xr.Dataset, tmp_path: File) -> None:
    plot.animate(steady.assign_attrs(title="a\x1b[31mb\x07c\u202ed\nfake"), tmp_path / "orbit.html")
    assert r"<title>a\x1b[31mb\x07c\u202ed\nfake</title>" in (tmp_path / "orbit.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_gif_plays_its_pictures_for_ever(steady: xr.Dataset, tmp_path: File) -> None:
    plot.animate(steady, tmp_path / "orbit.gif")
    with Image.open(tmp_path / "orbit.gif") as picture:
        assert picture.n_frames == 3
        assert picture.info["duration"] == DELAY
        assert picture.info["loop"] == 0
        assert picture.convert("RGB").getpixel((2, 2)) == (255, 255, 255)


@pytest.mark.slow
def test_an_animation_that_cannot_be_written_says_so(steady: xr.Dataset, tmp_path: File) -> None:
    with pytest.raises(UsageError, match=r"\.html, \.gif"):
        plot.animate(steady, tmp_path / "orbit.mp4")
    with pytest.raises(StoreError, match="cannot write"):
        plot.animate(steady, tmp_path / "missing" / "orbit.gif")
