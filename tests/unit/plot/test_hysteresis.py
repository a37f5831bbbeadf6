"""Hysteresis: each leg from where the one before ended, the energy of a cycle told."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import petalfoil
from petalfoil.errors import UsageError
from petalfoil.plot.characteristics import cycle, force_along, hysteresis, is_loop
from tests.cases import case


@pytest.fixture(scope="module")
def loop() -> xr.Dataset:
    rubbing = case("paper_n8", **{"model.cells_per_pitch": 8, "surface.petal_friction": 0.2})
    return petalfoil.static(rubbing, "0 um : 100 um : 3", loop=True)


@pytest.mark.slow
def test_legs_join(loop: xr.Dataset) -> None:
    assert is_loop(loop)
    there, back, again = (force_along(loop, leg) for leg in ("loading", "unloading", "reloading"))
    assert there[0].tolist() == pytest.approx([0.0, 50.0, 100.0])
    assert back[0].tolist() == pytest.approx([100.0, 50.0, 0.0])
    assert again[0].tolist() == pytest.approx([0.0, 50.0, 100.0])
    assert back[1][0] == there[1][-1]
    assert back[1][1] < again[1][1]


def test_figure_tells_the_energy_of_a_cycle(loop: xr.Dataset) -> None:
    lost = loop["petal_friction_work"].to_numpy()
    assert cycle(loop) == pytest.approx(1e6 * (lost[-1] - lost[2]))
    fig = hysteresis(loop)
    assert f"{cycle(loop):.3g} µJ" in " ".join(text.get_text() for text in fig.findobj() if hasattr(text, "get_text"))
    assert len(fig.axes[0].lines) == 3
    apart = np.array([line.get_ydata()[1] for line in fig.axes[1].lines[:2]])
    assert apart[1] > 0.0 > apart[0]


def test_a_curve_that_is_no_loop_is_refused(loop: xr.Dataset) -> None:
    with pytest.raises(UsageError, match="made as a loop"):
        hysteresis(loop.isel(point=slice(0, 3)))
