"""Packs whose petals snap one by one, or whose contacts pull by less than rounding shows: the kinds that were refused.

Numbers are those of `make fuzz`, which drew them; docs/random-bearings.md tells of them.
"""

from __future__ import annotations

from dataclasses import replace

import pytest

from petalfoil.equilibrium.cold_start import PATH_END, PATHS, attempt, finish
from petalfoil.equilibrium.pack_at_rest import assembled
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.solvers.central_path import PathOptions, follow_central_path
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from tests import fuzz


def drawn(number: int) -> CoupledProblem:
    """The problem of a random bearing with contacts at nodes."""
    return build_problem(fuzz.bearing(number).replace(**{"model.contacts": "nodes"}))


@pytest.mark.slow
def test_contacts_that_pull_once_they_are_refined_are_released() -> None:
    """Three contacts pull with 1.4e-8 of their weight, which rows that lose digits had hidden."""
    found = attempt(drawn(809), 3.0)
    assert found is not None
    assert found.residual <= RESIDUAL_TOLERANCE


@pytest.mark.long
@pytest.mark.parametrize("number", [506, 548, 561])
def test_a_path_with_a_hundred_folds_leads_to_the_equilibrium(number: int) -> None:
    """6 to 40 s each; 200 steps, or steps whose way ahead is told by their angle alone, do not arrive."""
    problem, (barrier, weight, steps) = drawn(number), PATHS[0]
    with running():
        options = replace(PathOptions(), weight=weight, steps=steps)
        start, solver = assembled(problem, barrier), current_run().film_solver
        end = follow_central_path(problem, start, (barrier, PATH_END), solver, options)
        assert end is not None
        found = finish(problem, end, "along the central path")
    assert found is not None
    assert found.residual <= RESIDUAL_TOLERANCE
