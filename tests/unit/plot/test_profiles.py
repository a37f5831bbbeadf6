"""Pressure and film over one petal for a family of bearings."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError


def test_one_line_for_each_state(flat: xr.Dataset) -> None:
    fig = plot.petal_profiles([("one", flat), ("two", flat)], petal=2)
    above, below = fig.axes
    degrees = np.degrees(flat["phi_exposed"].values)
    assert_allclose(above.lines[1].get_xdata(), degrees, rtol=1e-12)
    ratio = flat["pressure"].values[2, :, 0] / float(flat["ambient_pressure"])
    assert_allclose(above.lines[1].get_ydata(), ratio, rtol=1e-12)
    assert_allclose(below.lines[0].get_ydata(), flat["film_thickness"].values[2, :, 0] * 1e6, rtol=1e-12)
    assert [text.get_text() for text in above.get_legend().get_texts()] == ["one", "two"]


def test_a_spatial_state_is_shown_at_its_mid_plane(spatial: xr.Dataset) -> None:
    fig = plot.petal_profiles([("one", spatial)])
    middle = spatial.sizes["z"] // 2
    shown = fig.axes[1].lines[0].get_ydata()
    assert_allclose(shown, spatial["film_thickness"].values[0, :, middle] * 1e6, rtol=1e-12)
    assert "mid-plane" in fig.get_suptitle()


def test_the_title_tells_what_the_states_share(flat: xr.Dataset) -> None:
    faster = flat.assign(speed=2.0 * flat["speed"])
    assert "rpm" in plot.petal_profiles([("one", flat)]).get_suptitle()
    assert "rpm" not in plot.petal_profiles([("one", flat), ("two", faster)]).get_suptitle()


def test_what_cannot_be_drawn_is_refused(flat: xr.Dataset, unconverged: xr.Dataset) -> None:
    with pytest.raises(UsageError, match="at least one"):
        plot.petal_profiles([])
    with pytest.raises(UsageError, match="numbered 0 to"):
        plot.petal_profiles([("one", flat)], petal=flat.sizes["petal"])
    with pytest.raises(ConvergenceError):
        plot.petal_profiles([("one", flat), ("two", unconverged)])
