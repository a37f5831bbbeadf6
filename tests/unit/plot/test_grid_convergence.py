"""A grid study drawn: values, limits, bars."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results import Record
from petalfoil.results.estimate import Estimate
from petalfoil.results.study import GridStudy, with_estimates

CELLS = (32, 64, 128)


def study(load_error: float = 0.02, **grid: int) -> xr.Dataset:
    loads = tuple(10.0 + (32 / cells) ** 2 for cells in CELLS)
    films = (5.0e-6, 5.2e-6, 5.1e-6)
    records = [
        Record(
            analysis="solve",
            scalars={
                **{name: count * cells // 32 for name, count in grid.items()},
                "speed": 8000.0,
                "eccentricity_x": 0.0,
                "eccentricity_y": -1e-4,
                "cells_per_pitch": cells,
                "bearing_force": load,
                "min_film_thickness": film,
                "converged": True,
            },
            title="Eight petals",
        )
        for cells, load, film in zip(CELLS, loads, films, strict=True)
    ]
    nan = float("nan")
    estimates = [
        Estimate(name="bearing_force", values=loads, limit=10.0, order=2.0, error=load_error, trusted=True),
        Estimate(name="min_film_thickness", values=films, limit=films[-1], order=nan, error=6e-7, trusted=False),
    ]
    layout = GridStudy(conclude=lambda _: estimates)
    return with_estimates(layout.to_dataset(records, "converge"), estimates)


def test_values_limits_and_bars_are_drawn() -> None:
    fig = plot.convergence(study())
    load, film, errors = fig.axes
    assert load.get_title() == "bearing force\n10.000 ± 0.020 N"
    assert film.get_title() == "minimum film thickness\n5.10 ± 0.60 µm"
    assert_allclose(load.lines[1].get_xydata(), [[32, 11.0], [64, 10.25], [128, 10.0625]], rtol=1e-12)
    assert_allclose(errors.lines[0].get_ydata(), [0.1, 0.025, 0.00625], rtol=1e-10)
    assert_allclose(errors.lines[1].get_ydata(), 0.002, rtol=1e-12)
    assert np.isnan(errors.lines[2].get_ydata()[-1])  # the finest value is its own limit: nothing to draw in decades
    assert "Eight petals" in fig.get_suptitle()
    assert "grids 32, 64, 128" in fig.get_suptitle()


@pytest.mark.slow
def test_a_spatial_study_names_both_numbers_of_cells() -> None:
    assert "grids 32 × 16, 64 × 32, 128 × 64" in plot.convergence(study(axial_cells=16)).get_suptitle()


def test_summary_draws_a_study() -> None:
    assert len(plot.summary(study()).axes) == 3


def test_a_figure_below_its_bar_is_left_out() -> None:
    film, _ = plot.convergence(study(load_error=11.0)).axes
    assert film.get_title().startswith("minimum film thickness")


def test_what_cannot_be_drawn_is_refused(flat: xr.Dataset) -> None:
    with pytest.raises(UsageError, match="converge"):
        plot.convergence(flat)
    with pytest.raises(ConvergenceError, match="smaller than its error bar"):
        plot.convergence(study(load_error=11.0).assign(min_film_thickness_error=1.0))
