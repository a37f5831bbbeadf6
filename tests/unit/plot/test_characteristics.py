from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot.characteristics import along
from petalfoil.results.dataset import curve_dataset
from tests.unit.results import factory


def drawn(ax: Axes, gid: str) -> list[Line2D]:
    return [line for line in ax.lines if line.get_gid() == gid]


def test_the_line_is_the_load_over_the_eccentricity_with_gaps(curve: xr.Dataset) -> None:
    (ax,) = plot.load_characteristic([("n = 8", curve)]).axes
    line = ax.lines[0]
    e, load = -curve["eccentricity_y"].values * 1e6, curve["bearing_force"].values
    # a gap at point 4, which failed, and another before point 6, which jumped
    np.testing.assert_allclose(line.get_xdata(), np.insert(e, 6, np.nan), rtol=1e-12)
    np.testing.assert_allclose(line.get_ydata(), np.insert(load, 6, np.nan), rtol=1e-12)
    assert np.flatnonzero(np.isnan(line.get_ydata())).tolist() == [4, 6]


def test_failed_points_are_marked_on_the_axis(curve: xr.Dataset) -> None:
    (ax,) = plot.load_characteristic([("n = 8", curve)]).axes
    (mark,) = drawn(ax, "failed")
    np.testing.assert_allclose(mark.get_xdata(), [160.0], rtol=1e-12)
    assert mark.get_marker() == "x"
    assert 0.0 < mark.get_ydata()[0] < 0.2  # over the height of the axes


def test_unstable_points_are_hollow_and_stable_ones_are_not(curve: xr.Dataset) -> None:
    (ax,) = plot.load_characteristic([("n = 8", curve)]).axes
    (hollow,) = drawn(ax, "unstable")
    np.testing.assert_allclose(hollow.get_xdata(), [80.0], rtol=1e-12)
    assert hollow.get_markerfacecolor() == "#FFFFFF"
    (solid,) = drawn(ax, "stable")
    assert np.flatnonzero(np.isnan(solid.get_ydata())).tolist() == [2, 4]
    assert solid.get_markerfacecolor() == solid.get_color()


def test_a_jump_is_a_dotted_step_from_the_last_converged_point(curve: xr.Dataset) -> None:
    (ax,) = plot.load_characteristic([("n = 8", curve)]).axes
    (step,) = drawn(ax, "jump")
    np.testing.assert_allclose(step.get_xdata(), [200.0, 240.0], rtol=1e-12)
    after_failure = curve.assign(jump=("point", np.arange(8) == 5))
    (step,) = drawn(plot.load_characteristic([("", after_failure)]).axes[0], "jump")
    np.testing.assert_allclose(step.get_xdata(), [120.0, 200.0], rtol=1e-12)


def test_the_legend_names_the_family_and_the_marks_that_occur(curve: xr.Dataset) -> None:
    six = curve_dataset(factory.curve(6, 0.4))
    (ax,) = plot.load_characteristic([("n = 6", six), ("n = 8", curve)]).axes
    marks = ["unstable", "did not converge", "jump to another branch"]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["n = 6", "n = 8", *marks]
    assert ax.lines[0].get_color() != drawn(ax, "stable")[1].get_color()
    healthy = curve.isel(point=[0, 1, 3])
    (ax,) = plot.load_characteristic([("n = 8", healthy)]).axes
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["n = 8"]


def test_axes_and_title_say_what_is_shown(curve: xr.Dataset) -> None:
    fig = plot.load_characteristic([("n = 6", curve_dataset(factory.curve(6))), ("n = 8", curve)])
    (ax,) = fig.axes
    assert ax.get_xlabel() == "eccentricity  e [µm]"
    assert ax.get_ylabel() == "bearing force  |F| [N]"
    assert ax.get_ylim()[0] == 0.0
    assert "76\u2009394 rpm · e toward −90° · grid 32 cells per pitch" in fig.get_suptitle()
    other = curve.assign_attrs(title="Another")
    assert "Load characteristic" in plot.load_characteristic([("a", curve), ("b", other)]).get_suptitle()


def test_eccentricity_has_a_sign_along_its_direction(curve: xr.Dataset) -> None:
    swept = xr.Dataset(
        {"eccentricity_x": ("point", [-3e-5, 0.0, 6e-5]), "eccentricity_y": ("point", [-4e-5, 0.0, 8e-5])}
    )
    np.testing.assert_allclose(along(swept), [-5e-5, 0.0, 10e-5], rtol=1e-12)
    np.testing.assert_array_equal(along(swept * 0.0), 0.0)
    np.testing.assert_allclose(along(curve), -curve["eccentricity_y"].values, rtol=1e-12)


def test_static_draws_reaction_and_starting_torque(static: xr.Dataset) -> None:
    fig = plot.static(static)
    above, below = fig.axes
    np.testing.assert_allclose(above.lines[0].get_xdata(), [0.0, 50.0, 100.0], rtol=1e-12)
    np.testing.assert_allclose(above.lines[0].get_ydata(), static["bearing_force"].values, rtol=1e-12)
    np.testing.assert_allclose(below.lines[0].get_ydata(), 1e3 * static["starting_torque"].values, rtol=1e-12)
    assert above.get_ylabel() == "bearing force  |F| [N]"
    assert below.get_ylabel() == "starting torque  M$_0$ [mN·m]"
    assert below.get_xlabel() == "eccentricity  e [µm]"
    assert "foil pack at zero speed" in fig.get_suptitle()


def test_a_curve_shows_force_film_torque_and_contact(curve: xr.Dataset, texts: Callable[[Figure], str]) -> None:
    fig = plot.curve(curve)
    shown = {"bearing_force": 1.0, "min_film_thickness": 1e6, "friction_torque": 1e3, "contact_fraction": 100.0}
    for ax, (name, factor) in zip(fig.axes, shown.items(), strict=True):
        (values,) = drawn(ax, "stable")
        expected = factor * np.where(curve["stable"] & curve["converged"], curve[name], np.nan)
        np.testing.assert_allclose(values.get_ydata(), expected, rtol=1e-12)
        assert ax.dataLim.ymax <= ax.get_ylim()[1]
    assert [ax.get_xlabel() for ax in fig.axes] == ["", "", "eccentricity  e [µm]", "eccentricity  e [µm]"]
    assert "no contact" in texts(fig)


def test_a_curve_without_contact_has_no_panel_for_it(curve: xr.Dataset) -> None:
    fig = plot.curve(curve.drop_vars("contact_fraction"))
    assert len(fig.axes) == 3
    assert all(ax.has_data() for ax in fig.axes)


def test_what_is_no_curve_is_refused(flat: xr.Dataset) -> None:
    for draw in (
        lambda: plot.load_characteristic([]),
        lambda: plot.load_characteristic([("", flat)]),
    ):
        with pytest.raises(UsageError):
            draw()


def test_a_curve_without_an_answer_is_not_drawn() -> None:
    ds = curve_dataset([factory.failed(1e-4), factory.failed(2e-4)])
    for draw in (lambda: plot.load_characteristic([("", ds)]), lambda: plot.static(ds)):
        with pytest.raises(ConvergenceError, match="the step length fell below its limit"):
            draw()
