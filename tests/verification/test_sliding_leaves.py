"""Two stacked leaves that slide along themselves with Coulomb's friction, exactly: the loop of a layered beam.

Two equal clamped strips of thickness `delta`, pressed together by `p`, share a tip force `F`. While they stick they are
one strip of twice the thickness, eight times as stiff as one. The shear between its layers is `3 F / (4 delta)`, the
same along all of the length: at `F = 4/3 c` with `c = mu p delta` all of it slips at once. Slipping leaves bend by
`w = (F -+ c) l^3 / (6 D)`. A cycle between `-+F` is a parallelogram of the area `4 c (F - 4/3 c) l^3 / (6 D)`.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.equilibrium.coulomb_path import slide_exactly
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.physics.petal_sliding import INNER, OUTER, Faces
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState
from petalfoil.walls.sliding import node_slopes, stretching
from tests.verification.shell_helpers import UNIT, ElasticProblem, strip_shell, uniform_grid, uniform_load

Array = NDArray[np.float64]

DELTA, PRESS, MU = 0.05, 1.0, 0.5
"""Thickness over length, pressure in `D / l^3`, friction."""
C = MU * PRESS * DELTA
FLAT = 1e8
"""Bend radius of a leaf that is straight, in lengths."""


def leaves(cells: int, mu: float) -> tuple[ElasticProblem, Array, Friction]:
    """Both leaves pressed together, the force of a unit tip load shared by both, friction between their faces."""
    shell, cell, two = strip_shell(uniform_grid(1.0, cells), 0.0), 1.0 / cells, np.ones(2)
    faces = Faces(0.5 * DELTA * two, two, FLAT * two, 12.0 / DELTA**2 * two)
    K = stretching([StretchingPetal(shell, 12.0 / DELTA**2)] * 2).stiffness * (UNIT / cell)
    press, still = PRESS * uniform_load(shell)[1:, 0] / cell, np.zeros(2 * cells)
    tip = np.zeros(4 * cells)
    tip[[cells - 1, 2 * cells - 1]] = 0.5 / cell
    one, none = sp.eye_array(cells), sp.csr_array((cells, cells))
    turn, petal = node_slopes(shell.phi)[1:, 1:], np.zeros(1, dtype=np.intp)
    along = [faces.share(petal, np.full(1, side))[0] for side in (OUTER, INNER)]
    slip = sp.hstack([*[arm * turn for arm in faces.arm], *[share * one for share in along]], format="csr")
    G = sp.hstack([-one, one, none, none], format="csr")
    problem = ElasticProblem(
        sp.csr_array(K), np.concatenate([press, -press, still]), G, np.zeros(cells), np.ones(cells)
    )
    share = sp.csr_array(sp.eye_array(cells))
    return problem, tip, Friction(mu, np.zeros(cells), sp.csr_array(slip), share, 0.0, exact=True)


def led(cells: int, mu: float, path: Array) -> tuple[Array, list[FrictionResult]]:
    """Tip deflections in `l^3 F / D`, and states along a path of tip forces from none."""
    problem, tip, friction = leaves(cells, mu)
    at = [ElasticProblem(problem.K, problem.force + F * tip, problem.G, problem.rest, problem.weight) for F in path]
    start = np.zeros(problem.n), np.ones(cells, dtype=bool)
    found, outcome = solve_contacts(problem, start, LinearSolver(), ContactOptions(tangents=40))
    assert found is not None, outcome
    fresh = FrictionState.fresh(friction, found.x, found.lam)
    states = [FrictionResult(found.x, found.lam, found.active, found.state.residual, fresh, 0.0)]
    for one in at:
        slid = slide_exactly(one, friction, states[-1], [np.arange(cells)[None, :]], LinearSolver())
        assert slid is not None
        assert slid.residual < 1e-8
        states.append(slid)
    return np.array([state.x[cells - 1] * UNIT for state in states[1:]]), states[1:]


def test_energy_lost_by_two_leaves_is_the_loop_of_a_layered_beam() -> None:
    """Within 0.2 % on 64 cells, of second order; and it is `mu N` times the slip."""
    most, errors = 6.0 * C, []
    exact = 4.0 * C * (most - 4.0 / 3.0 * C) / 6.0
    for cells in (32, 64):
        w, states = led(cells, MU, np.array([most, -most, most]))
        assert_allclose(w[[0, 2]], (most - C) / 6.0, rtol=5e-3)
        lost = sum(state.lost for state in states[1:]) * UNIT / cells
        slipped = abs(states[2].friction.slip - states[1].friction.slip) * UNIT
        assert np.sum(MU * states[2].lam * slipped) / cells == pytest.approx(0.5 * lost, rel=1e-3)
        errors.append(lost / exact - 1.0)
    assert abs(errors[-1]) < 2e-3
    assert abs(errors[-1]) < 0.4 * abs(errors[0])


def test_leaves_that_stick_are_one_and_lose_nothing() -> None:
    """Below `F = 4/3 c`: a strip of twice the thickness."""
    F = C
    w, states = led(64, MU, np.array([F, -F, F]))
    assert_allclose(w, np.array([F, -F, F]) / 24.0, rtol=5e-3)
    assert sum(state.lost for state in states) * UNIT / 64 < 1e-9 * C * F
