"""The minimum film thickness between nodes: the least of cubics, contacts that no node sees, and its derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis.closest_gap import closest_gap, lowest_place
from petalfoil.equilibrium.element_contacts import with_elements
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.under_load import balance_cold
from petalfoil.physics.gap_curves import ContactPoints, sampled
from petalfoil.system.build import build_problem
from petalfoil.system.loaded import load_of
from tests.cases import case
from tests.random_packs import random_case

PETALS = case("paper_n8", **{"model.cells_per_pitch": 16})


def test_the_lowest_place_of_a_cubic_is_that_of_a_fine_search() -> None:
    cubics = np.random.default_rng(1).standard_normal((200, 4))
    cubics[:20, 3] = 0.0  # parabolas
    cubics[20:30, 2:] = 0.0  # lines
    fine = np.linspace(0.0, 1.0, 20001)
    values = np.polynomial.polynomial.polyval(fine, cubics.T)
    place = lowest_place(cubics)
    found = np.sum(cubics * place[:, None] ** np.arange(4), axis=1)
    assert_allclose(found, values.min(axis=1), rtol=0.0, atol=1e-7)
    assert np.all(found <= values.min(axis=1) + 1e-15)


def test_the_derivatives_of_the_least_gap_are_its_differences() -> None:
    problem = build_problem(PETALS)
    with running(None, "test"):
        found = with_elements(balance_cold(problem, load_of(PETALS, (0.0, -45.0), problem.layout))).elements
    assert found is not None
    gaps, whole = found.equations.nodal_gaps, found.equations.whole
    near = closest_gap(gaps, whole)
    curve, _, gap = sampled(whole.curves, ContactPoints.none(), gaps, 50)
    fine = float(gap[curve < whole.pack.mesh.count].min())
    assert 0.0 <= fine - near.gap < 1e-2 * near.gap
    change = np.random.default_rng(2).standard_normal(len(gaps))
    ahead, behind = (closest_gap(gaps + sign * 1e-5 * change, whole).gap for sign in (1.0, -1.0))
    assert (ahead - behind) / 2e-5 == pytest.approx(float(near.weights(whole) @ change), rel=1e-6)


@pytest.mark.slow
def test_a_petal_that_touches_between_nodes_leaves_the_contact_film_thickness() -> None:
    """The nodes beside its contact have 2.8 um: a third of the load is carried by the contact."""
    stiff = random_case(np.random.default_rng(10), **{"model.cells_per_pitch": 16})
    touched = petalfoil.balance(stiff, "17.15 N")
    assert str(touched["contact_model"].item()).startswith("contact points")
    assert float(touched["contact_fraction"]) > 0.1
    assert float(touched["min_film_thickness"]) == stiff.surface.contact_film_thickness
    assert float(touched["film_thickness"].min()) > 2e-6
