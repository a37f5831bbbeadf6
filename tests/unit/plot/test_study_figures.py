"""Figures of studies from data made up for them: what scatters, what it is called, what it contributes."""

from __future__ import annotations

import json
import math
from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from numpy.testing import assert_allclose

from petalfoil import plot
from petalfoil.plot.study_views import parameter, parameters, shown_results

Texts = Callable[[Figure], str]
FORCES = np.linspace(9.0, 11.0, 40)


@pytest.fixture
def scattered() -> xr.Dataset:
    """Forty bearings: a force that scatters, and lift-off and touchdown speeds that differ by rounding."""
    told = {
        "limits": [],
        "results": {
            name: {"nominal": nominal, "first_order_standard_deviation": spread, "effects": effects}
            for name, nominal, spread, effects in (
                ("bearing_force", 10.0, 2.0, {"petals.thickness[2]": 1.9, "gas.viscosity": -0.6}),
                ("liftoff_speed", 100.0, 0.0, {"petals.thickness[2]": None, "gas.viscosity": 0.0}),
            )
        },
    }
    speeds = 10.0 * FORCES
    of_petal = {"path": "petals.thickness[2]", "long_name": "metal thickness", "units": "m"}
    return xr.Dataset(
        {
            "converged": ("case", np.ones(40, dtype=bool)),
            "bearing_force": ("case", FORCES, {"units": "N"}),
            "liftoff_speed": ("case", speeds, {"units": "rad s-1"}),
            "touchdown_speed": ("case", speeds * (1.0 + 1e-5), {"units": "rad s-1"}),
        },
        {"thickness_2": ("case", 2e-5 * FORCES, of_petal)},
        {"title": "Scatter", "asked": "balance", "analysis": "tolerance", "tolerance": json.dumps(told)},
    )


def test_contributions_are_named_as_in_the_case(scattered: xr.Dataset) -> None:
    fig = plot.tolerance(scattered, ("bearing_force",))
    left, right = fig.axes
    assert [label.get_text() for label in right.get_yticklabels()] == ["petals.thickness[2]", "gas.viscosity"]
    assert left.get_ylabel() == "probability density [1/N]"


def test_a_parameter_of_one_petal_says_of_which(scattered: xr.Dataset) -> None:
    (name,) = parameters(scattered)
    assert parameter(scattered, name).axis == "metal thickness, petal 2 [µm]"


def test_the_normal_curve_is_whole(scattered: xr.Dataset) -> None:
    left = plot.tolerance(scattered, ("bearing_force",)).axes[0]
    (curve,) = [line for line in left.lines if line.get_label() == "normal, of first order"]
    x, density = curve.get_data()
    assert_allclose(np.trapezoid(density, x), math.erf(3.5 / math.sqrt(2.0)), rtol=1e-4)
    assert left.get_xlim()[0] <= x[0] < x[-1] <= left.get_xlim()[1]


def test_a_result_that_nothing_moves_says_so_in_place_of_empty_axes(scattered: xr.Dataset, texts: Texts) -> None:
    fig = plot.tolerance(scattered, ("liftoff_speed",))
    assert not fig.axes[1].axison
    assert "no parameter has an effect of first order on it" in texts(fig)


def test_a_result_that_repeats_another_is_drawn_once(scattered: xr.Dataset) -> None:
    assert shown_results(scattered) == ["liftoff_speed", "bearing_force"]
    apart = scattered.assign(touchdown_speed=scattered["touchdown_speed"][::-1])
    assert "touchdown_speed" in shown_results(apart)


def test_a_capacity_at_one_speed_and_direction_is_a_table_that_begins_with_it() -> None:
    told = {"force_x": 3e-14, "bearing_force": 32.0, "load_capacity": 32.0, "load_coefficient": 41.0}
    values = {name: ((), value) for name, value in (told | {"load_coefficient_imperial": 0.016}).items()}
    geometry = {"ambient_pressure": 1e5, "journal_radius": 0.025, "length": 0.05, "speed": 6000.0}
    ds = xr.Dataset(
        values | {name: ((), value) for name, value in geometry.items()} | {"converged": ((), True)},
        {"load_orientation": [-1.57]},
        {"title": "One", "analysis": "capacity"},
    )
    (ax,) = plot.capacity(ds).axes
    cells = {key: cell.get_text().get_text() for key, cell in ax.tables[0].get_celld().items()}
    assert (cells[0, 0], cells[0, 1]) == ("load capacity", "32")
    assert "0" in [cells[row, 1] for row in range(5)]  # a force that is rounding
