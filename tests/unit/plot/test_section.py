from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from petalfoil import plot
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.plot.section import default_scale
from petalfoil.results.dataset import to_dataset
from tests.unit.results import factory

BORE = factory.R_B


def part(ax: Axes, gid: str) -> Artist:
    (found,) = ax.findobj(lambda artist: artist.get_gid() == gid)
    return found


def true_radius(places: npt.NDArray[np.float64], scale: float) -> npt.NDArray[np.float64]:
    """Undo the stretch of the drawing."""
    return BORE - (BORE - np.hypot(*places.T)) / scale


def test_petals_are_drawn_with_their_thickness_to_the_scale(flat: xr.Dataset) -> None:
    ax = plot.cross_section(flat, scale=10).axes[0]
    for petal in range(8):
        outline = part(ax, f"petal {petal}").get_xy()[:-1]
        radius = flat["radius"].values[petal, :, 0]
        expected = np.concatenate([radius - factory.DELTA / 2, (radius + factory.DELTA / 2)[::-1]])
        np.testing.assert_allclose(true_radius(outline, 10.0), expected, rtol=1e-12)
        root = np.degrees(np.arctan2(*outline[0][::-1]))
        assert root % 360.0 == pytest.approx(45.0 * petal, abs=1e-9)


def test_journal_film_and_roots_are_where_they_are(flat: xr.Dataset) -> None:
    ax = plot.cross_section(flat, scale=5).axes[0]
    top = part(ax, "journal").get_xy()[90]  # opposite to the displacement, where the room is widest
    np.testing.assert_allclose(top, [0.0, BORE - 5 * (BORE - factory.R_J + 100e-6)], rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(np.hypot(*part(ax, "roots").get_xydata().T), BORE, rtol=1e-12)
    first = part(ax, "film").get_paths()[0].vertices[:4]
    gap = true_radius(first[[0, 3]], 5.0)
    assert gap[1] - gap[0] == pytest.approx(flat["film_thickness"].values[0, 0, 0], rel=1e-9)


def test_the_pressure_band_is_as_high_as_the_excess_pressure(flat: xr.Dataset) -> None:
    ax = plot.cross_section(flat).axes[0]
    quads = np.array([path.vertices[:4] for path in part(ax, "pressure").get_paths()]).reshape(8, 32, 4, 2)
    height = np.hypot(*quads[:, :, 0].transpose(2, 0, 1)) - np.hypot(*quads[:, :, 3].transpose(2, 0, 1))
    excess = flat["pressure"].values[:, :-1, 0] / 1e5 - 1.0
    np.testing.assert_allclose(height / height.max(), excess / excess.max(), rtol=0, atol=1e-12)
    colours = part(ax, "film").get_array()
    assert colours.max() == pytest.approx(flat["pressure"].values.max() / 1e5, rel=0.01)


def test_suction_stays_inside_the_journal(plain: xr.Dataset) -> None:
    sucking = plain.assign(pressure=plain["pressure"] - 0.3e5)
    ax = plot.cross_section(sucking).axes[0]
    scale, bore = default_scale(sucking), sucking["bushing_radius"].item()
    places = np.concatenate([path.vertices for path in part(ax, "pressure").get_paths()])
    surface = bore - scale * (
        bore - factory.R_J - sucking["eccentricity_y"].item() * np.sin(np.arctan2(*places.T[::-1]))
    )
    excess = np.hypot(*places.T) - surface
    assert excess.max() < 1e-12
    assert excess.min() < -0.1 * factory.R_J


def test_contacts_are_dots_on_the_surfaces_that_touch(touching: xr.Dataset) -> None:
    ax = plot.cross_section(touching, scale=10).axes[0]
    for name in ("journal_contact_pressure", "petal_contact_pressure", "bushing_contact_pressure"):
        assert len(part(ax, name).get_xydata()) == int((touching[name].values > 0).sum()) > 0
    journal = part(ax, "journal_contact_pressure").get_xydata()
    theta = np.arctan2(journal[:, 1], journal[:, 0])
    expected = factory.R_J - 100e-6 * np.sin(theta)
    np.testing.assert_allclose(true_radius(journal, 10.0), expected, rtol=1e-12)
    petal = part(ax, "petal_contact_pressure").get_xydata()
    tips = touching["radius"].values[:, -1, 0] + factory.DELTA / 2
    np.testing.assert_allclose(true_radius(petal, 10.0), tips, rtol=1e-12)


def test_arrows_point_along_displacement_force_and_rotation(flat: xr.Dataset) -> None:
    ax = plot.cross_section(flat, scale=10).axes[0]
    (tail, tip) = part(ax, "displacement")._posA_posB
    np.testing.assert_allclose([*tail, *tip], [0.0, 0.0, 0.0, -1e-3], atol=1e-15)
    (tail, tip) = part(ax, "force")._posA_posB
    np.testing.assert_allclose(tip, [0.0, -1e-3], atol=1e-15)  # the force ends where it acts
    along = np.subtract(tip, tail)
    np.testing.assert_allclose(along / np.hypot(*along), [flat["force_x"] / 25.0, flat["force_y"] / 25.0], rtol=1e-12)
    arc = part(ax, "rotation").get_xydata() - [0.0, -1e-3]
    assert (np.diff(np.unwrap(np.arctan2(arc[:, 1], arc[:, 0]))) > 0).all()


@pytest.mark.parametrize("degrees", [0.0, 20.0, 60.0, 89.0, 91.0, 135.0, 180.0, 270.0])
def test_force_displacement_and_rotation_do_not_cover_each_other(flat: xr.Dataset, degrees: float) -> None:
    angle = np.radians(degrees)  # between the force and the direction from the displaced centre back to the bushing's
    turned = flat.assign(force_x=((), 25.0 * np.sin(angle)), force_y=((), 25.0 * np.cos(angle)))
    ax = plot.cross_section(turned, scale=10).axes[0]
    centre = np.array([0.0, -1e-3])
    force = np.array(part(ax, "force")._posA_posB) - centre
    ray = force[np.argmax(np.hypot(*force.T))]
    back = -centre
    towards = [np.degrees(np.arctan2(*v[::-1])) for v in (ray, back)]
    assert abs((towards[0] - towards[1] + 180.0) % 360.0 - 180.0) >= 89.0
    arc = part(ax, "rotation").get_xydata() - centre
    for direction in towards:
        between = (np.degrees(np.arctan2(arc[:, 1], arc[:, 0])) - direction + 180.0) % 360.0 - 180.0
        assert np.abs(between).min() > 20.0


def test_a_foil_pack_at_zero_speed_has_no_pressure_and_no_rotation(static: xr.Dataset) -> None:
    fig = plot.cross_section(static.isel(point=1))
    (ax,) = fig.axes  # no colour bar
    gids = {artist.get_gid() for artist in ax.get_children()}
    assert not {"pressure", "film", "rotation"} & gids
    assert {"journal", "bushing", "petal 7", "force", "displacement", "journal_contact_pressure"} <= gids
    assert "zero speed" in fig.get_suptitle()


def test_a_central_journal_without_force_gets_no_arrows() -> None:
    (ax, _) = plot.cross_section(to_dataset(factory.solved(eccentricity=0.0, load=0.0))).axes
    gids = {artist.get_gid() for artist in ax.get_children()}
    assert not {"displacement", "force"} & gids
    assert "rotation" in gids


def test_the_scale_is_stated_with_what_else_is_needed(flat: xr.Dataset, texts: Callable[[Figure], str]) -> None:
    said = texts(plot.cross_section(flat))
    assert "radial clearance drawn ×10" in said
    assert "force on the journal, 25 N" in said
    assert "76\u2009394 rpm · e = 100 µm at −90° · grid 32 cells per pitch" in said
    assert "p / p$_a$" in said
    assert "radial clearance drawn ×4" in texts(plot.cross_section(flat, scale=4))


def test_a_displacement_that_is_too_small_to_be_seen_is_told_in_words(
    flat: xr.Dataset, texts: Callable[[Figure], str]
) -> None:
    near = flat.assign(eccentricity_x=((), 0.0), eccentricity_y=((), -8e-9))
    fig = plot.cross_section(near)
    assert not fig.axes[0].findobj(lambda artist: artist.get_gid() == "displacement")
    assert "displacement, 0.008 µm (not visible)" in texts(fig)
    assert "displacement, 100 µm ×10" in texts(plot.cross_section(flat))


def test_the_note_names_what_is_stretched(flat: xr.Dataset, plain: xr.Dataset, texts: Callable[[Figure], str]) -> None:
    assert "×10, petals and displacement too; journal not to scale" in texts(plot.cross_section(flat))
    assert "×200, displacement too; journal not to scale" in texts(plot.cross_section(plain))


def test_the_default_scale_is_a_round_number_that_fits(flat: xr.Dataset, plain: xr.Dataset) -> None:
    assert default_scale(flat) == 10.0
    assert default_scale(plain) == 200.0
    wide = flat.assign(bushing_radius=((), 60e-3))
    assert default_scale(wide) == 1.0


@pytest.mark.parametrize("scale", [0.5, 0.0, -3.0, 30.0, float("nan")])
def test_a_scale_that_leaves_no_journal_is_refused(flat: xr.Dataset, scale: float) -> None:
    with pytest.raises(UsageError, match=r"between 1 and 21\.3"):
        plot.cross_section(flat, scale=scale)


def test_states_without_an_answer_are_not_drawn(unconverged: xr.Dataset, curve: xr.Dataset) -> None:
    with pytest.raises(ConvergenceError):
        plot.cross_section(unconverged)
    with pytest.raises(UsageError):
        plot.cross_section(curve)


def test_section_and_map_share_their_colours(spatial: xr.Dataset) -> None:
    ends_higher = spatial.assign(pressure=spatial["pressure"] * (1.0 + (spatial["z"] - 0.025) ** 2 * 1e3))
    fig = plot.operating_point(ends_higher)
    section, pressure_map = fig.axes[0], fig.axes[1]
    assert part(section, "film").get_clim() == pytest.approx(pressure_map.collections[0].get_clim())
