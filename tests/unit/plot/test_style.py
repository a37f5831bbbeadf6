import pytest
import xarray as xr

from petalfoil.plot import style


@pytest.mark.parametrize(
    ("speed", "text"), [(8000.0, "76\u2009394 rpm"), (0.0, "at rest"), (float("nan"), ""), (10.0, "95 rpm")]
)
def test_speed_is_told_in_revolutions_per_minute(speed: float, text: str) -> None:
    assert style.speed_fact(speed) == text


@pytest.mark.parametrize(
    ("e", "text"),
    [
        ((0.0, -100e-6), "e = 100 µm at −90°"),
        ((30e-6, 40e-6), "e = 50 µm at 53°"),
        ((0.0, 0.0), "journal central"),
        ((1e-6, -1e-9), "e = 1 µm at 0°"),
    ],
)
def test_displacement_is_told_by_size_and_direction(e: tuple[float, float], text: str) -> None:
    ds = xr.Dataset({"eccentricity_x": e[0], "eccentricity_y": e[1]})
    assert style.displacement_fact(ds) == text
    assert style.displacement_fact(xr.Dataset()) == ""


def test_the_grid_is_told_in_cells(flat: xr.Dataset, spatial: xr.Dataset, plain: xr.Dataset) -> None:
    assert style.grid_fact(flat) == "grid 8 petals × 32 cells"
    assert style.grid_fact(spatial) == "grid 8 petals × 32 × 8 cells"
    assert style.grid_fact(plain) == "grid 96 × 8 cells"
    assert style.grid_fact(spatial, count_petals=False) == "grid 32 × 8 cells a petal"


def test_a_long_title_is_wrapped_and_not_clipped() -> None:
    fig = style.figure(4.0, 3.0)
    fig.subplots()
    ds = xr.Dataset(attrs={"title": "A bearing whose title goes on and on for much longer than a small figure is wide"})
    style.set_title(fig, ds, "76 394 rpm", "", "e = 100 µm at −90°", "grid 8 petals × 32 cells")
    fig.draw_without_rendering()
    box = fig._suptitle.get_window_extent()
    assert fig.bbox.x0 <= box.x0
    assert box.x1 <= fig.bbox.x1
    assert box.y1 <= fig.bbox.y1
    assert "rpm · e" in fig.get_suptitle()
