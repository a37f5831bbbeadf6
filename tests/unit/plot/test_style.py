import pytest
import xarray as xr

from petalfoil import plot
from petalfoil.case import Case
from petalfoil.plot import labels, style
from tests.cases import FAULTS


@pytest.mark.parametrize(
    ("speed", "text"), [(8000.0, "76\u2009394 rpm"), (0.0, "zero speed"), (float("nan"), ""), (10.0, "95 rpm")]
)
def test_speed_is_told_in_revolutions_per_minute(speed: float, text: str) -> None:
    assert labels.speed_fact(speed) == text


@pytest.mark.parametrize(
    ("e", "text"),
    [
        ((0.0, -100e-6), "e = 100 µm at −90°"),
        ((30e-6, 40e-6), "e = 50 µm at 53°"),
        ((0.0, 0.0), "centred journal"),
        ((1e-6, -1e-9), "e = 1 µm at 0°"),
    ],
)
def test_displacement_is_told_by_size_and_direction(e: tuple[float, float], text: str) -> None:
    ds = xr.Dataset({"eccentricity_x": e[0], "eccentricity_y": e[1]})
    assert labels.displacement_fact(ds) == text
    assert labels.displacement_fact(xr.Dataset()) == ""


def test_the_grid_is_told_in_cells(flat: xr.Dataset, spatial: xr.Dataset, plain: xr.Dataset) -> None:
    assert labels.grid_fact(flat) == "grid 32 cells per pitch"
    assert labels.grid_fact(spatial) == "grid 32 × 8 cells per pitch"
    assert labels.grid_fact(plain) == "grid 96 × 8 cells"


def test_a_long_title_is_wrapped_and_not_clipped() -> None:
    fig = style.figure(4.0, 3.0)
    fig.subplots()
    ds = xr.Dataset(attrs={"title": "A bearing whose title goes on and on for much longer than a small figure is wide"})
    style.set_title(fig, ds, "76 394 rpm", "", "e = 100 µm at −90°", "grid 32 cells per pitch")
    fig.draw_without_rendering()
    box = fig._suptitle.get_window_extent()
    assert fig.bbox.x0 <= box.x0
    assert box.x1 <= fig.bbox.x1
    assert box.y1 <= fig.bbox.y1
    assert "rpm · e" in fig.get_suptitle()


@pytest.mark.parametrize("title", [Case.load(FAULTS / "dollar_title.toml").title, "$\\frac{a$ $x^{$"])
def test_a_title_with_dollar_signs_is_drawn_as_it_stands(title: str, flat: xr.Dataset) -> None:
    fig = plot.summary(flat.assign_attrs(title=title))
    fig.draw_without_rendering()
    assert fig.get_suptitle().startswith(title)


def test_a_title_brings_no_control_character_to_a_figure(flat: xr.Dataset) -> None:
    title = "a\x1b[31mRED\x9b \u202egnp\nline\x00\x7f \ud800end"
    fig = plot.summary(flat.assign_attrs(title=title))
    fig.draw_without_rendering()
    assert fig.get_suptitle().splitlines()[0] == r"a\x1b[31mRED\x9b \u202egnp\nline\x00\x7f \ud800end"


def test_names_and_units_of_a_foreign_result_are_drawn_as_they_stand() -> None:
    attributes = {"long_name": r"cost $\frac{a$ $x^{$", "units": "$\x07"}
    ds = xr.Dataset({"gain": ("place", [1.0, 4.0], attributes)}, {"place": ("place", [1.0, 2.0], attributes)})
    fig = plot.summary(ds.assign_attrs(title="$", analysis="$_$"))
    fig.draw_without_rendering()
    assert fig.axes[0].get_xlabel() == r"cost \$\frac{a\$ \$x^{\$ [\$\x07]"
