"""The cases of the report are those of the examples, and each assumption changes what it names."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.case import Mount
from petalfoil.report.assumptions import ASSUMPTIONS, DOWNWARD
from petalfoil.report.fixed_bounds import bounded
from petalfoil.report.load_characteristics import COMPARED, Scope
from petalfoil.report.paper_cases import paper_case
from petalfoil.system.build import build_problem
from petalfoil.walls.petals import build_mesh
from tests.cases import case

NAMED = {assumption.name: assumption for assumption in ASSUMPTIONS}


@pytest.mark.parametrize("count", [6, 8, 10])
def test_a_case_is_that_of_the_example(count: int) -> None:
    example = case(f"paper_n{count}", **{"operation.eccentricity": (0.0, 0.0)})
    assert paper_case(count) == example


def test_every_curve_has_the_compared_displacements() -> None:
    scope = Scope()
    for places in (scope.displacements_2d, scope.displacements_3d):
        assert places[0] == 0.0
        assert {round(e * 1e6) for e in COMPARED} <= {round(e * 1e6) for e in places}


def test_assumptions_have_unique_names() -> None:
    assert len(NAMED) == len(ASSUMPTIONS)
    assert len({assumption.description for assumption in ASSUMPTIONS}) == len(ASSUMPTIONS)


@pytest.mark.parametrize("count", [6, 8, 10])
def test_every_assumption_but_the_reference_and_the_bounds_changes_the_case(count: int) -> None:
    reference = paper_case(count, **{"model.cells_per_pitch": 16})
    cases = {assumption.name: assumption.case(count, 16) for assumption in ASSUMPTIONS}
    assert {case.petals.count for case in cases.values() if case.petals is not None} == {count}
    assert {name for name, case in cases.items() if case == reference} == {"reference", "bounds"}


def test_a_clamped_assumption_is_clamped_at_its_tilt() -> None:
    petals = NAMED["clamped_5"].case(6, 16).petals
    assert petals is not None
    assert petals.mount is Mount.CLAMPED
    assert_allclose(petals.root_tilt, math.radians(5.0), rtol=1e-12)


@pytest.mark.parametrize("count", [6, 8, 10])
@pytest.mark.parametrize(("name", "node"), [("middle", 8), ("edge", 16)])
def test_roots_are_turned_until_that_place_lies_below(name: str, node: int, count: int) -> None:
    changed = NAMED[name].case(count, 16)
    mesh = build_mesh(changed)
    exposed = mesh.theta[:, mesh.exposed]
    spread = 2.0 * np.pi / count / 16.0  # the pitch is not divided quite evenly: the middle may lie between nodes
    nearest = np.min(np.abs(np.remainder(exposed[:, node] - DOWNWARD + np.pi, 2.0 * np.pi) - np.pi))
    assert nearest <= (1e-12 if name == "edge" else spread)


def test_fixed_bounds_leave_one_layer_for_the_neighbour() -> None:
    changed = NAMED["bounds"].case(8, 16)
    problem, plain = bounded(changed), build_problem(changed)
    rows, before = problem.layout.wall.contacts, plain.layout.wall.contacts
    assert (rows.journal, rows.bushing) == (before.journal, before.bushing)
    mesh, pack_ = build_mesh(changed), changed.pack
    assert pack_ is not None
    assert changed.petals is not None
    r0, delta = pack_.free_radius(mesh.phi), changed.petals.total_thickness
    covered, lap = r0[1 : mesh.n_node - mesh.cells - 1], r0[mesh.on_neighbour]
    W, e = 1e-4 * np.random.default_rng(0).standard_normal(problem.layout.n_wall), np.array([2e-5, -3e-5])
    gaps = rows.gaps(W, e)[rows.petals].reshape(-1)
    count, inner = 8, 8 * len(covered)
    radius = np.concatenate([np.zeros((count, 1)), W.reshape(count, -1)], axis=1) + r0
    theta = mesh.theta[:, 1 : mesh.n_node - mesh.cells - 1]
    journal = 0.025 + e[0] * np.cos(theta) + e[1] * np.sin(theta) + 1e-6
    assert_allclose(
        gaps[:inner].reshape(count, -1), radius[:, 1 : len(covered) + 1] - journal - 1.5 * delta, rtol=0.0, atol=1e-15
    )
    assert_allclose(gaps[inner:].reshape(count, -1), 0.026 - 1.5 * delta - radius[:, -len(lap) :], rtol=0.0, atol=1e-15)
