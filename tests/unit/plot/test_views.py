import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot import views
from petalfoil.results.dataset import to_dataset
from tests.unit.results import factory


def test_a_curve_of_several_points_must_be_narrowed_first(curve: xr.Dataset) -> None:
    with pytest.raises(UsageError, match=r"one point of the 8: choose it with ds\.isel"):
        views.one_point(curve)
    assert "point" not in views.one_point(curve.isel(point=1)).dims
    assert "point" not in views.one_point(curve.isel(point=[1])).dims


def test_a_point_that_did_not_converge_is_refused_with_its_status(curve: xr.Dataset, unconverged: xr.Dataset) -> None:
    for ds in (unconverged, curve.isel(point=4)):
        with pytest.raises(ConvergenceError, match="the step length fell below its limit") as caught:
            views.one_point(ds)
        assert caught.value.advice


def test_silence_about_convergence_is_no_convergence_except_for_a_check(flat: xr.Dataset, checked: xr.Dataset) -> None:
    with pytest.raises(ConvergenceError):
        views.one_point(flat.drop_vars(["converged", "status"]))
    assert "converged" not in checked
    assert views.one_point(checked) is checked
    with pytest.raises(ConvergenceError):
        views.one_point(checked.assign(converged=((), np.False_)))


@pytest.mark.parametrize("first_root", [0.0, 0.3, -1.0, 5.9, 40.0])
@pytest.mark.parametrize(("petals", "overlap"), [(8, 1.77), (5, 2.21), (1, 1.5)])
def test_strips_tile_the_circle_once(first_root: float, petals: int, overlap: float) -> None:
    ds = to_dataset(factory.solved(petals=petals, overlap=overlap))
    ds = ds.assign_coords(root_angle=ds["root_angle"] + first_root)
    shown = sorted((max(strip.degrees[0], 0.0), min(strip.degrees[-1], 360.0)) for strip in views.strips(ds))
    starts, ends = np.array(shown).T
    assert (ends > starts).all()
    np.testing.assert_allclose(starts[1:], ends[:-1], rtol=0, atol=1e-9)
    np.testing.assert_allclose([starts[0], ends[-1]], [0.0, 360.0], rtol=0, atol=1e-9)


def test_strip_edges_and_middles_belong_to_their_petals(flat: xr.Dataset, plain: xr.Dataset) -> None:
    free_edge = np.degrees(flat["phi_exposed"].values[-1])
    np.testing.assert_allclose(views.strip_middles(flat)[0], free_edge - 22.5, rtol=1e-12)
    np.testing.assert_allclose(np.diff(views.strip_edges(flat)), 45.0, rtol=1e-12)
    assert views.strip_edges(plain).size == 0


def test_the_mid_plane_is_the_station_nearest_to_the_middle(spatial: xr.Dataset, flat: xr.Dataset) -> None:
    assert views.mid_plane(spatial)["z"] == 25e-3
    assert views.is_3d(spatial)
    assert views.mid_plane(flat)["pressure"].dims == ("petal", "phi_exposed")
    assert not views.is_3d(flat)


def test_a_contact_pressure_of_rounding_size_is_no_contact(touching: xr.Dataset) -> None:
    contact = touching["journal_contact_pressure"]
    truly = contact.values > 0
    assert 0 < truly.sum() < truly.size
    noisy = touching.assign(journal_contact_pressure=contact + 1e-3)
    np.testing.assert_array_equal(views.touching(noisy, "journal_contact_pressure"), truly)


def test_the_journal_surface_leaves_the_film(flat: xr.Dataset) -> None:
    plane = views.mid_plane(flat)
    theta = plane["root_angle"].values[:, None] + plane["phi_exposed"].values
    inner_face = plane["radius"].values[:, -33:] - flat["petal_thickness"].item() / 2
    film = inner_face - views.journal_surface(plane, theta)
    np.testing.assert_allclose(film, plane["film_thickness"].values, rtol=0, atol=1e-15)


@pytest.mark.slow
def test_plot_loads_matplotlib_only_when_used_and_pyplot_never() -> None:
    code = (
        "import sys, petalfoil.plot as plot; assert 'matplotlib' not in sys.modules; plot.pressure_and_film; "
        "assert 'matplotlib' in sys.modules; assert 'matplotlib.pyplot' not in sys.modules; plot.nothing"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.stderr.strip().endswith("AttributeError: module 'petalfoil.plot' has no attribute 'nothing'")
