import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import QuadMesh
from matplotlib.contour import ContourSet

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot.film_fields import outline_contact, refined
from petalfoil.results.dataset import to_dataset
from tests.unit.results import factory


def test_maps_shade_the_nodal_values(spatial: xr.Dataset) -> None:
    above, below = plot.maps(spatial).axes[:2]
    for ax, expected in ((above, spatial["pressure"] / 1e5), (below, spatial["film_thickness"] * 1e6)):
        meshes = [artist for artist in ax.collections if isinstance(artist, QuadMesh)]
        assert len(meshes) == 9  # eight petals, one of them crosses 360 degrees
        first = meshes[0].get_array()
        corners = [[first[0, 0], first[0, -1]], [first[-1, 0], first[-1, -1]]]
        np.testing.assert_allclose(corners, expected.values[0][[0, -1]][:, [0, -1]].T, rtol=1e-12)
        assert meshes[0].get_clim() == (expected.values.min(), expected.values.max())


def test_refining_is_exact_for_a_bilinear_field() -> None:
    x, y = np.array([0.0, 1.0, 5.0]), np.array([0.0, 2.0, 3.0])
    fine_x, fine_y, fine = refined(x, y, 2.0 + x[:, None] - 3.0 * y + 0.5 * x[:, None] * y)
    np.testing.assert_allclose(fine, 2.0 + fine_x[:, None] - 3.0 * fine_y + 0.5 * fine_x[:, None] * fine_y, atol=1e-12)


def test_axes_say_what_they_show(spatial: xr.Dataset) -> None:
    fig = plot.maps(spatial)
    above, below, bar_p, bar_h = fig.axes
    assert below.get_xlabel() == "bushing angle  θ [deg]"
    assert above.get_ylabel() == below.get_ylabel() == "z [mm]"
    assert above.get_ylim() == (0.0, 50.0)
    assert (bar_p.get_ylabel(), bar_h.get_ylabel()) == ("p / p$_a$", "film thickness  h [µm]")
    assert "76\u2009394 rpm · e = 100 µm at −90° · grid 32 × 8 cells per pitch" in fig.get_suptitle()


def test_the_contact_is_outlined(spatial: xr.Dataset) -> None:
    above = plot.maps(spatial).axes[0]
    outlines = [artist for artist in above.collections if isinstance(artist, ContourSet)]
    assert len(outlines) == 9
    petal, node, _ = np.nonzero(spatial["journal_contact_pressure"].values)
    nodes = spatial["phi_exposed"].values[node]
    first = np.degrees(spatial["root_angle"].values[0] + nodes[petal == 0])
    outline = outlines[0].get_paths()[0].vertices[:, 0]
    assert outline.min() < first.min()
    assert first.max() < outline.max() < first.max() + 45.0 / 32
    assert above.get_legend() is not None


def test_nothing_is_outlined_where_nothing_touches(plain: xr.Dataset) -> None:
    ds = to_dataset(factory.solved(nz=5))
    for free in (ds, plain):
        above = plot.maps(free).axes[0]
        assert not [artist for artist in above.collections if isinstance(artist, ContourSet)]
        assert above.get_legend() is None
    fig = plot.maps(ds)
    outline_contact(fig.axes[0], ds, ds["z"].values)
    assert not [artist for artist in fig.axes[0].collections if isinstance(artist, ContourSet)]


def test_what_cannot_be_mapped_is_refused(flat: xr.Dataset, unconverged: xr.Dataset) -> None:
    with pytest.raises(UsageError, match="3-D model"):
        plot.maps(flat)
    with pytest.raises(ConvergenceError):
        plot.maps(unconverged)
