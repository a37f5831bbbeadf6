"""The torque of the journal's dry friction is in every friction torque, once (J4), (D7)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from scipy.integrate import cumulative_trapezoid

from petalfoil import balance, curve, orbit, runup, solve, static
from petalfoil.case import Case
from tests.cases import case

MU = 0.3
LOAD = (0.0, -25.0)
COARSE = {"operation.speed": 300.0, "operation.eccentricity": (0.0, -200e-6), "model.cells_per_pitch": 16}
SPACE = {"model.kind": "3d", "model.cells_per_pitch": 8, "model.axial_cells": 4, "model.axial_density": "uniform"}

VERBS: dict[str, Callable[[Case], xr.Dataset]] = {
    "solve": solve,
    "balance": lambda of: balance(of, LOAD),
    "curve": lambda of: curve(of, "150 um : 200 um : 2"),
    "runup": lambda of: runup(of, LOAD, to="3000 rpm", points=3),
}


def pressing(mu: float, kind: str = "torque", **changes: object) -> Case:
    """The paper's eight petals, pressed by a journal with a coefficient of friction."""
    rubs = {"surface.friction_coefficient": mu, "surface.journal_rubbing": kind}
    return case("paper_n8", **{**COARSE, **rubs, **changes})


def rubbing(result: xr.Dataset, mu: float = MU) -> xr.DataArray:
    """`mu R_j` times the normal force of solid contact on the journal [N m]."""
    return mu * pressing(mu).bearing.journal_radius * result["contact_normal_force"]


@pytest.mark.slow
@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("space", [{}, SPACE], ids=["2d", "3d"])
def test_friction_torque_of_equilibria(verb: str, space: dict[str, object]) -> None:
    """As torque alone it moves nothing: what the coefficient adds to the friction torque is that of the contacts."""
    with_friction, without = (VERBS[verb](pressing(mu, **space)) for mu in (MU, 0.0))
    added = with_friction["friction_torque"] - without["friction_torque"]
    assert float(rubbing(with_friction).max()) > 0.05
    assert_allclose(added, rubbing(with_friction), rtol=1e-6, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("space", [{}, SPACE], ids=["2d", "3d"])
def test_a_journal_that_drags_has_the_torque_of_its_contacts(space: dict[str, object]) -> None:
    """Where no film shears: at rest the starting torque is that of the contacts alone, of either kind of rubbing."""
    for kind in ("torque", "force"):
        found = static(pressing(MU, kind, **space), "100 um : 200 um : 2")
        assert_allclose(found["starting_torque"], rubbing(found), rtol=1e-9)
        assert float(found["starting_torque"].max()) > 0.05


@pytest.mark.slow
@pytest.mark.parametrize("petal_friction", [0.0, 0.1])
def test_work_of_the_shaft_in_a_motion(petal_friction: float) -> None:
    """The shaft's work with friction less that without is the work of rubbing, step by step."""
    moving = {"rotor": {"mass": 3.0}, "surface.petal_friction": petal_friction}
    with_friction, without = (orbit(pressing(mu, **moving), revolutions=0.1) for mu in (MU, 0.0))
    assert_allclose(with_friction["time"], without["time"], rtol=1e-12)
    added = with_friction["shaft_work"] - without["shaft_work"]
    assert float(with_friction["rubbing_work"][-1]) > 1e-2
    assert float(np.max(np.abs(without["rubbing_work"]))) == 0.0
    assert_allclose(added, with_friction["rubbing_work"], rtol=1e-6, atol=1e-9)
    torque = cumulative_trapezoid(with_friction["friction_torque"] * 300.0, with_friction["time"], initial=0.0)
    assert_allclose(with_friction["shaft_work"], torque, rtol=1e-9)
