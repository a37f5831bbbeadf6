"""Contact points that meet the conditions of contact along whole curves, whichever way led to them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.operating_point import at_position
from petalfoil.case import Case
from petalfoil.equilibrium.element_contacts import start_at, tightened
from petalfoil.equilibrium.element_tangent import ElementTangent
from petalfoil.equilibrium.led_points import led_by_points
from petalfoil.equilibrium.point_contacts import PointContacts, with_points
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.settled_points import (
    DEPTH,
    corrected,
    in_stretches,
    settled_points,
    stiffness_at,
    without_needless,
)
from petalfoil.physics.gap_curves import sampled
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem
from petalfoil.system.point_equations import PointEquations
from tests.cases import case
from tests.random_packs import random_case

DENSE = 150
"""Gaps looked at per element: other places than those of the code."""

RIG = case("rig", **{"operation.eccentricity": (0.0, -12e-6)})


def pack(number: int) -> Case:
    """One of the random packs of `test_random_bearings.py`."""
    rng = np.random.default_rng(2024)
    return [random_case(rng) for _ in range(number + 1)][number]


def found_by_search(bearing: Case) -> PointContacts:
    """What the search from nodes leads to."""
    with running():
        answer = at_position(bearing).answer
        whole = answer.problem.layout.elements
        assert whole is not None
        return with_points(whole, answer.problem, start_at(whole, answer))


def lowest_gap(equations: PointEquations) -> float:
    """The lowest gap along all curves, in reference films."""
    return float(sampled(equations.whole.curves, equations.state.points, equations.nodal_gaps, DENSE)[2].min())


def force(found: PointContacts) -> NDArray[np.float64]:
    """Force on the journal in newtons."""
    return np.asarray(found.equations.force * found.equations.problem.layout.scales.force)


def change_of_force(found: PointContacts) -> float:
    """Difference of the force from that of the settled one, over the force."""
    with running():
        settled = settled_points(found, None)
    assert settled is not None
    change = settled.equations.force - found.equations.force
    return float(np.linalg.norm(change) / np.linalg.norm(found.equations.force))


@pytest.mark.slow
@pytest.mark.parametrize("bearing", [RIG, pack(23), pack(135)], ids=["rig", "pack 23", "pack 135"])
def test_gaps_are_positive_between_the_samples_of_the_search(bearing: Case) -> None:
    """The search leaves gaps 2 to 9 nm below zero, within stretches or beside points."""
    searched = found_by_search(bearing)
    assert lowest_gap(searched.equations) < -2e-4
    with running():
        found = tightened(searched, None)
    assert isinstance(found, PointContacts)
    assert lowest_gap(found.equations) >= -2.0 * DEPTH
    assert np.all(found.points.reaction >= 0.0)
    assert np.max(np.abs(found.equations.scaled)) <= 1e-8
    assert 1e-5 < change_of_force(searched) < 1e-2


@pytest.mark.slow
def test_two_ways_lead_to_one_set_of_points() -> None:
    """From contacts at nodes, and by points followed from 0.02 um higher: the search alone has two stretches."""
    one = found_by_search(RIG)
    above = found_by_search(RIG.replace(**{"operation.eccentricity": (0.0, -11.98e-6)}))
    with running():
        settled, near = settled_points(one, None), settled_points(above, None)
        assert settled is not None
        assert near is not None
        answer = led_by_points(near, build_problem(RIG), None)
    assert answer is not None
    other = answer.elements
    assert isinstance(other, PointContacts)
    assert one.points.inner.any()
    assert not settled.points.inner.any()
    assert np.array_equal(other.points.curve, settled.points.curve)
    assert_allclose(other.points.position, settled.points.position, atol=1e-5)
    assert_allclose(force(other), force(settled), rtol=1e-9)
    assert np.linalg.norm(force(one) - force(settled)) > 1e-4 * np.linalg.norm(force(settled))


def test_a_point_without_reaction_is_not_needed() -> None:
    """Of eight petals every point is needed; one whose reaction vanishes is not."""
    found = found_by_search(case("paper_n8", **{"operation.eccentricity": (0.0, -200e-6)}))
    equations = found.equations
    tangent = ElementTangent.at(equations, None, LinearSolver())
    assert corrected(equations, tangent) is None
    points = equations.state.points
    lone = int(np.flatnonzero(~in_stretches(points) & (points.reaction[points.ends] > 0.0))[0])
    reaction = points.reaction.copy()
    reaction[points.ends[lone]] = 0.0
    state = replace(equations.state, points=replace(points, reaction=reaction))
    left = without_needless(replace(equations, state=state), tangent)
    assert left is not None
    assert len(left.curve) == len(points.curve) - 1


def test_the_stiffness_at_a_point_is_that_of_its_equations() -> None:
    """Newton's method with a gap held open: the reaction that the point takes more."""
    found = found_by_search(case("paper_n8", **{"operation.eccentricity": (0.0, -200e-6), "model.cells_per_pitch": 32}))
    equations, number = found.equations, 0
    tangent = ElementTangent.at(equations, None, LinearSolver())
    row = equations.whole.n_wall + equations.whole.n_film + number
    dense = equations.steady.toarray()
    unit = np.zeros(equations.n)
    unit[row] = 1.0
    assert_allclose(stiffness_at(equations, tangent, number), np.linalg.solve(dense, unit)[row], rtol=1e-6)
