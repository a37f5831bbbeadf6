"""Contact points from nodal gaps and reactions: where they are, how the gap curves there."""

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.physics.contact import Contacts, GapLines
from petalfoil.physics.contact_points import IsolatedContacts, cubic_slopes

Array = NDArray[np.float64]
N = 12
UNEVEN = np.cumsum(np.linspace(0.05, 0.1, N))


def contacts(phi: Array, lines: int = 1, stations: int = 1) -> Contacts:
    """Lines of gaps over `phi`, each on an unknown of its own."""
    m, none = lines * len(phi), slice(0, 0)
    every = GapLines(np.arange(m).reshape(lines, -1), phi, stations)
    return Contacts(
        sp.csr_array(sp.eye_array(m)), np.zeros(m), np.zeros((m, 2)), np.ones(m), none, none, none, (every,)
    )


def points(phi: Array, gaps: Array, reactions: dict[int, float]) -> IsolatedContacts:
    """The points of one line with these reactions, which alone are closed."""
    lam = np.zeros(len(gaps))
    lam[list(reactions)] = list(reactions.values())
    return IsolatedContacts.of(contacts(phi), gaps, lam, lam > 0.0)


def position(found: IsolatedContacts) -> float:
    return float(found.groups[0].position[0])


def test_slope_of_a_cubic_is_exact() -> None:
    rng = np.random.default_rng(0)
    offset = np.sort(rng.normal(size=(5, 4)), axis=1)
    coefficients = rng.normal(size=(5, 4, 1))
    values = np.sum(coefficients * offset[:, None, :] ** np.arange(4)[:, None], axis=1)
    assert_allclose(np.sum(cubic_slopes(offset) * values, axis=1), coefficients[:, 1, 0], rtol=1e-9)


def test_a_parabola_has_its_curvature_and_minimum() -> None:
    """One active node; the weight of the minimum is 1 where the gap turns at will."""
    bottom = UNEVEN[5] + 0.01
    gaps = 1.5 * (UNEVEN - bottom) ** 2
    found = points(UNEVEN, gaps, {5: 2.0})
    assert_allclose(found.travel_stiffness, 2.0 / 3.0, rtol=1e-9)
    assert_allclose(position(found.placed(np.zeros(1))), bottom, rtol=1e-12)
    assert_allclose(position(found.placed(np.array([np.inf]))), UNEVEN[5], rtol=1e-12)
    assert_allclose(position(found), UNEVEN[5] + 0.005, rtol=1e-12)
    assert_allclose(found.slope @ gaps, 3.0 * (position(found) - bottom), rtol=1e-9)
    assert not found.at_nodes.any()


def test_two_closed_nodes_are_a_point_between_them() -> None:
    """At the centroid of their reactions where the gap does not turn, half way where it turns at will."""
    phi = np.linspace(0.0, 1.0, N)
    middle = 0.5 * (phi[5] + phi[6])
    gaps = (phi - phi[5]) * (phi - phi[6])
    found = points(phi, gaps, {5: 1.0, 6: 3.0})
    held = found.placed(np.array([np.inf]))
    assert_allclose(position(held), 0.25 * phi[5] + 0.75 * phi[6], rtol=1e-12)
    assert_allclose(held.value.toarray()[0, 5:7], [0.25, 0.75], atol=1e-12)
    assert_allclose(position(found.placed(np.zeros(1))), middle, rtol=1e-12)


def test_the_position_does_not_jump_when_a_second_node_closes() -> None:
    """Where the neighbour's gap vanishes, one active node and two with a reaction of zero put the point alike."""
    phi = np.linspace(0.0, 1.0, N)
    gaps = (phi - phi[5]) * (phi - phi[6])
    for compliance in (0.1, 1.0, 10.0):
        one, two = points(phi, gaps, {5: 1.0}), points(phi, gaps, {5: 1.0, 6: 1e-14})
        places = [position(found.placed(np.array([compliance]))) for found in (one, two)]
        assert_allclose(places[0], places[1], rtol=1e-9)


def test_a_reaction_between_nodes_lowers_the_curvature_by_its_kink() -> None:
    """`p''` of the beam under a reaction `R` at `x_c` is `c + R |x - x_c| / 2`; differences know it at nodes only."""
    phi = np.linspace(0.0, 1.0, 41)
    step, c, R = phi[1], 2.0, 60.0
    centre = phi[20] + 0.3 * step
    nodal = c + 0.5 * R * np.abs(phi - centre)  # a second difference of the gap at each node
    gaps = np.zeros(len(phi))
    for i in range(1, len(phi) - 1):
        gaps[i + 1] = 2.0 * gaps[i] - gaps[i - 1] + nodal[i] * step**2
    found = points(phi, gaps, {20: 0.7 * R, 21: 0.3 * R}).placed(np.array([np.inf]))
    assert_allclose(found.groups[0].curvature, c, rtol=1e-6)


@pytest.mark.parametrize("nodes", [(0,), (1, 2), (N - 2,), (4, 5, 6)])
def test_ends_and_stretches_stay_at_their_nodes(nodes: tuple[int, ...]) -> None:
    gaps = (np.arange(N) - 5.0) ** 2
    found = points(np.arange(N, dtype=float), gaps, dict.fromkeys(nodes, 1.0))
    assert len(found.travel_stiffness) == 0
    assert np.flatnonzero(found.at_nodes).tolist() == list(nodes)


def test_two_nodes_between_which_the_gap_curves_downward_stay_nodes() -> None:
    gaps = np.zeros(N)
    gaps[:4] = gaps[8:] = 1.0
    found = points(np.arange(N, dtype=float), gaps, {5: 1.0, 6: 1.0})
    assert np.flatnonzero(found.at_nodes).tolist() == [5, 6]


def test_points_of_one_petal_form_contact_lines_along_the_shaft() -> None:
    """Two petals of three stations; the first has a second point on one of them."""
    phi = np.arange(N, dtype=float)
    lam = np.zeros((6, N))
    lam[:, 4] = 1.0
    lam[1, 8] = 1.0
    gaps = np.tile(0.1 * np.minimum((phi - 4.0) ** 2, (phi - 8.0) ** 2), 6)
    found = IsolatedContacts.of(contacts(phi, 6, 3), gaps, lam.ravel(), lam.ravel() > 0.0)
    assert found.contact_line.tolist() == [0, 0, 1, 0, 2, 2, 2]
