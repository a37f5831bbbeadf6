"""Random packs with friction between petals that slide along themselves: assembled at rest, then loaded."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.friction_history import assembled
from petalfoil.equilibrium.point_friction_path import RubbingPoints
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import ConvergenceError
from petalfoil.system.build import build_problem
from petalfoil.system.friction import friction_of
from tests.random_packs import random_case

PRESSURE = 0.1
"""Load over ambient pressure on the projected area of the bearing."""


def rubbing(seed: int, cells: int) -> Case:
    """A random steel pack with friction 0.1, its journal free."""
    changes = {"model.cells_per_pitch": cells, "surface.petal_friction": 0.1, "operation.eccentricity": (0.0, 0.0)}
    return random_case(np.random.default_rng(seed), **changes)


def loaded(case: Case) -> tuple[bool, int, int, str | None]:
    """Whether the pack was assembled and loaded, its factorisations, the steps that they were for, and its contacts."""
    load = PRESSURE * case.gas.ambient_pressure * 2.0 * case.bearing.journal_radius * case.bearing.length
    with running() as run:
        try:
            found = SpeedLine(case, (0.0, -load), from_rest=True).at(0.0)
        except ConvergenceError:
            return False, 0, 0, None
        assert found.residual < 1e-8
        assert found.force_residual < 1e-9
        steps = sum(event["phase"] == "friction" for event in run.history)
        return True, run.film.factorizations, steps, found.contact_model


@pytest.mark.long
def test_a_hundred_random_packs_are_assembled_and_loaded() -> None:
    """At least 98 of 100; the rest ends in a typed error."""
    assert sum(loaded(rubbing(seed, 12))[0] for seed in range(100)) >= 98


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 2, 3])
def test_factorisations_a_step_do_not_grow_with_the_grid(seed: int) -> None:
    """Where contacts end alike on both grids: points have more a step than nodes, and fewer steps (12 in 212 at nodes,
    120 in 39 at points, for seed 1 on 12 and 24 cells)."""
    coarse, fine = (loaded(rubbing(seed, cells)) for cells in (12, 24))
    assert coarse[0]
    assert fine[0]
    assert fine[3] == coarse[3]
    assert fine[1] / fine[2] < 1.5 * coarse[1] / coarse[2]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_stiff_packs_keep_contact_points_while_they_are_assembled(seed: int) -> None:
    """In a few halves of steps. Half of the contacts of the first pull by little where they are held, and contacts of
    the second wander along gaps of little curvature: both lost their points, after 62 and 12 halves."""
    case = rubbing(seed, 12)
    problem = build_problem(case).at(bearing_number=0.0)
    friction = friction_of(case, problem.layout)
    assert friction is not None
    with running() as run:
        end = assembled(friction, problem)
    assert end is not None
    assert isinstance(end.state, RubbingPoints)
    assert end.at_points == end.steps
    assert end.state.residual < 1e-8
    assert sum(event.get("outcome") == "halved" for event in run.history) <= 10
