from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError


def test_pressure_and_film_of_every_petal_are_on_one_circle(flat: xr.Dataset) -> None:
    above, below = plot.pressure_and_film(flat).axes
    for ax, expected in ((above, flat["pressure"] / 1e5), (below, flat["film_thickness"] * 1e6)):
        curves = [line for line in ax.lines if len(line.get_xdata()) == 33]
        seen = set()
        for line in curves:
            degrees = line.get_xdata()
            petal = int(np.rint(np.degrees(degrees[0] * np.pi / 180 - flat["phi_exposed"].values[0]) / 45.0)) % 8
            np.testing.assert_allclose(line.get_ydata(), expected.values[petal, :, 0], rtol=1e-12)
            seen.add(petal)
        assert seen == set(range(8))
        assert ax.get_xlim() == (0.0, 360.0)


def test_axes_say_what_they_show(flat: xr.Dataset, texts: Callable[[Figure], str]) -> None:
    fig = plot.pressure_and_film(flat)
    above, below = fig.axes
    assert above.get_ylabel() == "pressure  p / p$_a$"
    assert below.get_ylabel() == "film thickness  h [µm]"
    assert below.get_xlabel() == "bushing angle  θ [deg]"
    assert below.get_yscale() == "log"
    said = texts(fig)
    for fact in ("Paper, flat study, 8 petals", "76\u2009394 rpm", "e = 100 µm at −90°", "grid 32 cells per pitch"):
        assert fact in said
    assert "contact film thickness, 1 µm" in said
    assert f"minimum {flat['min_film_thickness'].item() * 1e6:.4g} µm" in said


def test_petal_edges_are_marked(flat: xr.Dataset, plain: xr.Dataset) -> None:
    above, _ = plot.pressure_and_film(flat).axes
    marks = sorted(line.get_xdata()[0] for line in above.lines if line.get_linestyle() == ":")
    np.testing.assert_allclose(np.diff(marks), 45.0, rtol=1e-12)
    assert len(marks) == 8
    assert not [line for line in plot.pressure_and_film(plain).axes[0].lines if line.get_linestyle() == ":"]


def test_contact_is_marked_where_the_journal_touches_and_nowhere_else(touching: xr.Dataset, flat: xr.Dataset) -> None:
    _, below = plot.pressure_and_film(touching).axes
    marks = [line for line in below.lines if line.get_marker() == "o"]
    drawn = {round(float(x) % 360.0, 6) for line in marks for x in line.get_xdata()}
    petal, node = np.nonzero(touching["journal_contact_pressure"].values[:, :, 0])
    theta = np.degrees(touching["root_angle"].values[petal] + touching["phi_exposed"].values[node]) % 360.0
    assert drawn == {round(float(x), 6) for x in theta}
    assert all((line.get_ydata() == 1.0).all() for line in marks)  # the contact film thickness, in micrometres
    assert [text.get_text() for text in below.get_legend().get_texts()].count("journal in contact") == 1
    assert not [line for line in plot.pressure_and_film(flat).axes[1].lines if line.get_marker() == "o"]


def test_a_spatial_result_is_shown_at_its_mid_plane(spatial: xr.Dataset) -> None:
    fig = plot.pressure_and_film(spatial)
    assert "mid-plane, z = 25 mm" in fig.get_suptitle()
    highest = max(line.get_ydata().max() for line in fig.axes[0].lines if len(line.get_xdata()) == 33)
    assert highest == pytest.approx(spatial["pressure"].values[:, :, 4].max() / 1e5, rel=1e-12)


def test_the_curves_stay_inside_the_axes(flat: xr.Dataset, plain: xr.Dataset) -> None:
    for ds in (flat, plain):
        for ax in plot.pressure_and_film(ds).axes:
            low, high = ax.get_ylim()
            values = np.concatenate([line.get_ydata() for line in ax.lines if len(line.get_xdata()) > 2])
            assert low < values.min() <= values.max() < high


def test_states_without_an_answer_are_not_drawn(unconverged: xr.Dataset, curve: xr.Dataset) -> None:
    with pytest.raises(ConvergenceError):
        plot.pressure_and_film(unconverged)
    with pytest.raises(UsageError):
        plot.pressure_and_film(curve)
