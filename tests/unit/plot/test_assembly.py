from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil import plot
from petalfoil.errors import ConvergenceError
from petalfoil.results import Record
from petalfoil.results.dataset import to_dataset
from tests.unit.results import factory


def part(ax: Axes, gid: str) -> list[object]:
    return ax.findobj(lambda artist: artist.get_gid() == gid)


def test_the_section_shows_petals_with_the_clearance_stretched(
    checked: xr.Dataset, texts: Callable[[Figure], str]
) -> None:
    fig = plot.pack(checked)
    left = fig.axes[0]
    assert left.get_aspect() == 1.0
    assert "radial clearance drawn ×10" in texts(fig)
    outline = part(left, "petal 3")[0].get_xy()[:-1]
    radius = checked["radius"].values[3, :, 0]
    expected = np.concatenate([radius - 0.088e-3, radius[::-1] + 0.088e-3])
    np.testing.assert_allclose(26e-3 - (26e-3 - np.hypot(*outline.T)) / 10.0, expected, rtol=1e-12)
    np.testing.assert_allclose(np.hypot(*part(left, "journal")[0].get_xy().T), 16e-3, rtol=1e-12)


def test_legends_cover_neither_petals_nor_journal(checked: xr.Dataset) -> None:
    fig = plot.pack(checked)
    fig.draw_without_rendering()
    left, _, lowest_panel = fig.axes
    lowest = min(left.transData.transform(patch.get_xy())[:, 1].min() for patch in part(left, "petal 0"))
    assert left.get_legend().get_window_extent().y1 < lowest
    assert lowest_panel.get_legend().get_window_extent().y1 < lowest_panel.bbox.y0
    assert lowest_panel.get_legend().get_window_extent().y0 > fig.bbox.y0


def test_the_free_petal_has_a_panel_of_its_own_and_leaves_the_pack_its_height(checked: xr.Dataset) -> None:
    _, right, below = plot.pack(checked).axes
    (free,) = [line for line in below.lines if line.get_label() == "petal 0, free"]
    np.testing.assert_allclose(free.get_xdata(), np.degrees(checked["phi"].values), rtol=1e-12)
    np.testing.assert_allclose(free.get_ydata(), checked["free_radius"].values * 1e3, rtol=1e-12)
    faces = part(right, "petal 0")[0].get_paths()[0].vertices
    radius = checked["radius"].values[0, :, 0] * 1e3
    assert faces[:, 1].max() == pytest.approx((radius + 0.088).max(), rel=1e-12)
    assert faces[:, 1].min() == pytest.approx((radius - 0.088).min(), rel=1e-12)
    assert below.get_ylim()[0] < free.get_ydata().min()
    low, high = right.get_ylim()
    clearance = 26.0 - (checked["journal_radius"].item() + checked["eccentricity_y"].item()) * 1e3
    assert 26.0 < high < 26.0 + 0.2 * clearance
    assert high - low < 1.4 * clearance
    assert right.get_ylabel() == below.get_ylabel() == "radius [mm]"


def test_each_shade_of_petal_is_explained(checked: xr.Dataset) -> None:
    names = [text.get_text() for text in plot.pack(checked).axes[2].get_legend().get_texts()]
    assert names[:3] == ["petal 0, assembled", "odd petals", "even petals"]  # even ones pass in the section alone


def test_neighbours_that_pass_the_window_are_drawn_across_the_turn(checked: xr.Dataset) -> None:
    right = plot.pack(checked).axes[1]
    assert len(part(right, "petal 7")) == 1  # its tip lies under the first petal's root, a turn away
    assert len(part(right, "petal 1")) == 1
    assert len(part(right, "petal 4")) == 0


def test_the_stretch_it_states_is_the_one_it_draws(checked: xr.Dataset) -> None:
    fig = plot.pack(checked)
    right = fig.axes[1]
    fig.draw_without_rendering()
    to_pixels = right.transData.transform
    wide = to_pixels((1.0, 25.0))[0] - to_pixels((0.0, 25.0))[0]
    high = to_pixels((0.0, 25.0))[1] - to_pixels((0.0, 24.0))[1]
    drawn = high / (wide / (np.pi / 180 * 26.0))
    stated = float(right.get_title().partition("×")[2])
    assert stated == pytest.approx(drawn, rel=0.05)  # two digits


def test_the_title_tells_the_derived_figures(checked: xr.Dataset, texts: Callable[[Figure], str]) -> None:
    said = texts(plot.pack(checked))
    assert "overlap 1.77 · 2 layers · least radial clearance 1000 µm · 647 µm above the solid pack height" in said
    assert "Λ on radial clearance = 5.55" in said
    assert "free petal meets the journal" in said


def test_a_free_petal_that_never_meets_the_journal_has_no_mark(
    checked: xr.Dataset, texts: Callable[[Figure], str]
) -> None:
    said = texts(plot.pack(checked.assign(first_contact_angle=((), np.nan))))
    assert "free petal meets the journal" not in said


def test_a_plain_bearing_has_journal_and_bushing_only(texts: Callable[[Figure], str]) -> None:
    geometry = {name: value for name, value in factory.GEOMETRY.items() if name != "petal_thickness"}
    given = {"eccentricity_x": 0.0, "eccentricity_y": 0.0, "radial_clearance": 1e-3, "compressibility_number": 5.55}
    fig = plot.pack(to_dataset(Record(analysis="check", scalars={**geometry, **given}, title="Plain")))
    assert "least radial clearance 1000 µm · Λ on radial clearance = 5.55" in texts(fig)
    assert "solid pack height" not in texts(fig)
    assert part(fig.axes[1], "journal")
    assert part(fig.axes[1], "bushing")


def test_a_pack_that_did_not_converge_is_not_drawn(checked: xr.Dataset) -> None:
    with pytest.raises(ConvergenceError):
        plot.pack(checked.assign(converged=((), np.False_)))
