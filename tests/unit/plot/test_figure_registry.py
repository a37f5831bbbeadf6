import pkgutil
from collections.abc import Callable
from importlib import import_module
from types import ModuleType

import numpy as np
import pytest
import xarray as xr
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

import petalfoil
from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot import figure_registry
from petalfoil.results.dataset import curve_dataset
from tests.unit.results import factory


def ylabels(ds: xr.Dataset) -> list[str]:
    fig = plot.summary(ds)
    fig.draw_without_rendering()
    return [ax.get_ylabel() for ax in fig.axes if ax.get_ylabel()]


@pytest.mark.slow
def test_a_flat_point_gets_section_and_lines(flat: xr.Dataset, curve: xr.Dataset) -> None:
    for ds in (flat, curve.isel(point=[1])):
        assert ylabels(ds) == ["pressure  p / p$_a$", "film thickness  h [µm]", "p / p$_a$"]


@pytest.mark.slow
def test_a_spatial_point_gets_section_and_maps(spatial: xr.Dataset) -> None:
    assert ylabels(spatial) == ["z [mm]", "z [mm]", "p / p$_a$", "p / p$_a$", "film thickness  h [µm]"]


def test_a_curve_gets_its_characteristic(curve: xr.Dataset, static: xr.Dataset, checked: xr.Dataset) -> None:
    assert ylabels(curve) == [
        "bearing force  |F| [N]",
        "minimum film thickness  h$_{min}$ [µm]",
        "friction torque  M [mN·m]",
        "contact fraction [%]",
    ]
    assert ylabels(static) == ["bearing force  |F| [N]", "starting torque  M$_0$ [mN·m]"]
    assert ylabels(checked) == ["radius [mm]", "radius [mm]"]


def test_a_single_static_point_gets_its_section() -> None:
    fig = plot.summary(curve_dataset([factory.at_rest(1e-4)], analysis="static"))
    assert "zero speed" in fig.get_suptitle()
    assert not fig.axes[0].axison


def test_what_has_no_answer_is_refused(unconverged: xr.Dataset) -> None:
    for analysis in ("solve", "new analysis"):
        with pytest.raises(ConvergenceError):
            plot.summary(unconverged.assign_attrs(analysis=analysis))


def test_an_analysis_registers_its_own_figure(flat: xr.Dataset, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figure_registry, "FIGURES", dict(figure_registry.FIGURES))
    plot.register("toy", plot.cross_section)
    assert ylabels(flat.assign_attrs(analysis="toy")) == ["p / p$_a$"]


def test_every_registered_figure_is_there() -> None:
    for home in figure_registry.FIGURES.values():
        module, _, function = str(home).partition(":")
        assert callable(getattr(import_module(f"petalfoil.plot.{module}"), function))


# ---------------------------------------------------------------------------------------------- without a figure


def test_a_point_without_a_figure_is_a_table_of_its_quantities(
    flat: xr.Dataset, texts: Callable[[Figure], str]
) -> None:
    fig = plot.summary(flat.assign_attrs(analysis="toy"))
    assert "toy" in texts(fig)
    cells = {place: cell.get_text().get_text() for place, cell in fig.axes[0].tables[0].get_celld().items()}
    lines = [[cells[row, column] for column in range(3)] for row in range(len(cells) // 3)]
    film = f"{1e6 * float(flat['min_film_thickness']):.4g}"
    for expected in (["bearing force", "25", "N"], ["attitude angle", "20", "deg"]):
        assert expected in lines
    assert ["minimum film thickness", film, "µm"] in lines
    assert not [line for line in lines if "residual" in line[0]]


def test_a_table_without_labels_of_its_own_is_in_the_units_of_printed_tables(checked: xr.Dataset) -> None:
    fig = plot.quantities(checked)
    cells = {place: cell.get_text().get_text() for place, cell in fig.axes[0].tables[0].get_celld().items()}
    units = {cells[row, 0]: (cells[row, 1], cells[row, 2]) for row, _ in cells}
    clearance = f"{1e6 * float(checked['radial_clearance']):.4g}"
    assert units["radial clearance where it is narrowest"] == (clearance, "µm")


def test_a_series_without_a_figure_is_lines_over_what_is_varied(curve: xr.Dataset) -> None:
    fig = plot.summary(curve.assign_attrs(analysis="toy"))
    assert fig.axes
    assert {ax.get_xlabel() for ax in fig.axes} == {"displacement along y  e$_y$ [µm]"}
    force = next(ax for ax in fig.axes if ax.get_ylabel() == "bearing force  |F| [N]").lines[0]
    np.testing.assert_allclose(force.get_xdata(), 1e6 * curve["eccentricity_y"].values, rtol=1e-12)
    expected = np.where(curve["converged"], curve["bearing_force"], np.nan)
    np.testing.assert_allclose(force.get_ydata(), expected, rtol=1e-12)


def test_a_series_over_an_axis_of_its_own_is_drawn_over_it() -> None:
    ds = xr.Dataset(
        {"gain": ("drive_speed", [1.0, 4.0], {"long_name": "gain of the toy", "units": "1"})},
        {"drive_speed": ("drive_speed", [10.0, 20.0], {"long_name": "speed of the drive", "units": "rad s-1"})},
    )
    (ax,) = plot.summary(ds).axes
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("speed of the drive [rpm]", "gain of the toy")
    np.testing.assert_allclose(ax.lines[0].get_xdata(), np.array([10.0, 20.0]) * 30.0 / np.pi, rtol=1e-12)


def test_a_grid_without_a_figure_is_filled_contours() -> None:
    speed, load = np.array([100.0, 200.0, 300.0]), np.array([5.0, 10.0])
    force = xr.Dataset(
        {"bearing_force": (("load", "speed"), load[:, None] * speed)}, {"speed": speed, "load": load}, {"title": "Toy"}
    )
    fig = plot.summary(force)
    ax = fig.axes[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("speed [rpm]", "load [N]")
    (filled,) = [item for item in ax.collections if isinstance(item, ContourSet)]
    assert filled.levels.min() <= 500.0 < 3000.0 <= filled.levels.max()
    np.testing.assert_allclose(ax.get_xlim(), speed[[0, -1]] * 30.0 / np.pi, rtol=1e-12)


def test_a_result_without_quantities_is_refused() -> None:
    with pytest.raises(UsageError, match="no quantity"):
        plot.summary(xr.Dataset({"status": ((), "converged"), "converged": ((), np.True_)}))


@pytest.mark.parametrize("package", [petalfoil, plot])
def test_no_function_is_hidden_by_a_module_of_its_name(package: ModuleType) -> None:
    modules = {info.name for info in pkgutil.iter_modules(package.__path__)}
    assert not modules & set(package.__all__)  # an import of the module would put it in the function's place
