import pytest
import xarray as xr

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.dataset import curve_dataset
from tests.unit.results import factory


def ylabels(ds: xr.Dataset) -> list[str]:
    fig = plot.summary(ds)
    fig.draw_without_rendering()
    return [ax.get_ylabel() for ax in fig.axes if ax.get_ylabel()]


def test_a_flat_point_gets_section_and_lines(flat: xr.Dataset, curve: xr.Dataset) -> None:
    for ds in (flat, curve.isel(point=[1])):
        assert ylabels(ds) == ["pressure  p / p$_a$", "film thickness  h [µm]", "p / p$_a$"]


def test_a_spatial_point_gets_section_and_maps(spatial: xr.Dataset) -> None:
    assert ylabels(spatial) == ["z [mm]", "z [mm]", "p / p$_a$", "p / p$_a$", "film  h [µm]"]


def test_a_curve_gets_its_characteristic(curve: xr.Dataset, static: xr.Dataset, checked: xr.Dataset) -> None:
    assert ylabels(curve) == ["load capacity  |F| [N]"]
    assert ylabels(static) == ["reaction  |F| [N]", "starting torque  M$_0$ [N·m]"]
    assert ylabels(checked) == ["y [mm]", "radius [mm]"]


def test_a_single_static_point_gets_its_section() -> None:
    fig = plot.summary(curve_dataset([factory.at_rest(1e-4)], analysis="static"))
    assert "at rest" in fig.get_suptitle()
    assert not fig.axes[0].axison


def test_what_has_no_answer_or_no_figure_is_refused(unconverged: xr.Dataset, flat: xr.Dataset) -> None:
    with pytest.raises(ConvergenceError):
        plot.summary(unconverged)
    with pytest.raises(UsageError, match="known: balance, check, coefficients, converge"):
        plot.summary(flat.assign_attrs(analysis="sweep"))
