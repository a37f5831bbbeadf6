"""Membrane stress of 2-D petals that friction pulls along themselves, told by results with contact points."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.analysis.hysteresis import follow, legs
from petalfoil.analysis.solve import solve
from petalfoil.analysis.static import static
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_POINTS
from petalfoil.walls.pack_slip import membrane_of_pulls, stretched_along
from tests.cases import case


@pytest.mark.slow
def test_points_stretch_petals_as_contacts_at_nodes_do() -> None:
    """Eight petals assembled and pressed down by 100 um: the largest stress within 1 %, two thirds of a megapascal."""
    rubs = case("paper_n8", **{"surface.petal_friction": 0.3, "model.cells_per_pitch": 32})
    points, nodes = (static(rubs.replace(**{"model.contacts": at}), ["-100 um"]) for at in ("points", "nodes"))
    assert points["contact_model"].item() == AT_POINTS
    assert points["membrane_stress"].dims == nodes["membrane_stress"].dims
    assert nodes["max_membrane_stress"].item() > 5e5
    assert_allclose(points["max_membrane_stress"], nodes["max_membrane_stress"], rtol=1e-2)


def test_membrane_forces_are_the_strains_of_what_they_stretch() -> None:
    """`N = B V_s` in every cell without a contact (M1), by the displacements of (M2)."""
    rubs = case("paper_n8", **{"surface.petal_friction": 0.3, "model.cells_per_pitch": 12})
    with running():
        (start,) = follow(legs([rubs], False))
    assert start.answer is not None
    found = start.answer.elements
    assert found is not None
    pack, points = found.pack, found.points
    force = np.random.default_rng(2).uniform(-1.0, 1.0, len(points.every_curve))
    N = membrane_of_pulls(pack, points, force, np.zeros_like(force))
    V = np.pad(stretched_along(pack, points, force), ((0, 0), (1, 0)))
    faces, r_m = pack.faces, pack.faces.metric_radius[:, None]
    stretched = faces.membrane[:, None] * np.diff(V, axis=1) / (r_m * np.diff(pack.mesh.phi))
    same = np.isclose(N[:, :-1], N[:, 1:], rtol=0.0, atol=1e-9 * np.abs(N).max())
    assert 0.5 < same.mean() < 1.0
    assert_allclose(stretched[same], N[:, 1:][same], atol=1e-9 * np.abs(N).max())


@pytest.mark.slow
def test_a_journal_pulls_every_petal_by_its_friction() -> None:
    """At the root `mu_f` of all that a petal presses on the journal, by the arm of its face; else nothing."""
    dragging = {"surface.journal_rubbing": "force", "surface.friction_coefficient": 0.3, "petals.theory": "shell"}
    pressed = {"operation.speed": 300.0, "operation.eccentricity": (0.0, -250e-6), "model.cells_per_pitch": 16}
    of = case("paper_n8", **dragging, **pressed)
    ds = solve(of)
    assert ds["contact_model"].item() == AT_POINTS
    assert of.petals is not None
    on_journal = ds["contact_facing"].values == 0
    petal, force = (ds[name].values[on_journal] for name in ("contact_petal", "contact_force"))
    each = np.bincount(petal.astype(int), weights=force, minlength=8)
    thickness, R = of.petals.thickness, of.petals.bend_radius
    pulled = 0.3 * (1.0 - 0.5 * thickness / R) * each / (of.bearing.length * thickness)
    assert pulled.max() > 4e5
    assert_allclose(ds["membrane_stress"].values[:, 0, 0], pulled, rtol=1e-9)
    assert ds["max_membrane_stress"].item() == pytest.approx(pulled.max(), rel=1e-9)
    still = solve(of.replace(**{"surface.journal_rubbing": "torque", "surface.petal_friction": 0.3}))
    assert still["max_membrane_stress"].item() == 0.0
