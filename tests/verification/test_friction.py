"""Hysteresis of strips on dry friction: closed loops in closed form (theory 5.1), and Coulomb's limit."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.static import static
from petalfoil.equilibrium.friction_path import FrictionResult, slide
from petalfoil.errors import UsageError
from petalfoil.physics.dry_friction import Friction, halves, slopes
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState
from tests.cases import case
from tests.verification.shell_helpers import (
    UNIT,
    ElasticProblem,
    orders,
    rows_of,
    strip_shell,
    strips_problem,
    uniform_grid,
    uniform_load,
)

Array = NDArray[np.float64]

ARM = 0.01
"""Half a thickness of strips of unit length."""
WIDTH = 3e-4
"""Slip within which friction builds up [UNIT]; the slips of these tests are of the order of 1."""


def start(problem: ElasticProblem, friction: Friction, active: NDArray[np.bool_]) -> FrictionResult:
    """The equilibrium without friction, from which a path begins."""
    begin = np.zeros(problem.n), active
    found, outcome = solve_contacts(problem, begin, LinearSolver(), ContactOptions(tangents=40))
    assert found is not None, outcome
    fresh = FrictionState.fresh(friction, found.x, found.lam)
    return FrictionResult(found.x, found.lam, found.active, found.state.residual, fresh, 0.0)


def follow(problems: list[ElasticProblem], friction: Friction, begin: FrictionResult) -> list[FrictionResult]:
    """Each problem in turn, from where the one before ended."""
    states, before = [], begin
    for problem in problems:
        slid = slide(problem, friction, before, LinearSolver())
        assert slid is not None
        states.append(slid)
        before = slid
    return states


# ------------------------------------------------------------------------------------------ a strip on its tip

GAP = 0.05
LOW, HIGH = 1.0, 2.0
"""Pressures between which the strip is cycled: `G` stays between 1/72 and 1/8, where only the tip touches."""


def propped(cells: int, mu: float) -> tuple[ElasticProblem, Array, Friction]:
    """A clamped strip `GAP` before a wall, nodal forces of a unit pressure, friction at the tip."""
    phi = uniform_grid(1.0, cells)
    shell = strip_shell(phi, 0.0)
    problem = strips_problem(
        [shell], [uniform_load(shell)[1:, 0]], rows_of(cells, ([cells - 1], -1.0)), np.array([GAP])
    )
    slip = sp.csr_array(ARM * slopes(phi)[[cells - 1], 1:])
    return problem, problem.force.copy(), Friction(mu, np.zeros(1), slip, sp.csr_array(np.ones((1, 1))), WIDTH)


def cycle_of_tip(cells: int, mu: float, steps: int = 16) -> float:
    """Energy lost in a cycle of the pressure, in units of `q^2 l^5 / D`: the second one, which is closed."""
    problem, unit, friction = propped(cells, mu)
    path = np.concatenate([np.linspace(a, b, steps + 1)[1:] for a, b in ((LOW, HIGH), (HIGH, LOW)) * 2])
    first = ElasticProblem(problem.K, LOW * unit, problem.G, problem.rest, problem.weight)
    problems = [ElasticProblem(problem.K, q * unit, problem.G, problem.rest, problem.weight) for q in path]
    states = follow(problems, friction, start(first, friction, np.ones(1, dtype=bool)))
    return sum(state.lost for state in states[len(states) // 2 :]) * UNIT / cells


def exact_cycle_of_tip(mu: float) -> float:
    """Area of the loop of tip moment over tip turn (D4): slip, stick, slip back, stick."""
    c = mu * ARM
    reaction = {sign: (lambda q, s=sign: 3.0 * (q / 8.0 - GAP) / (1.0 - s * 1.5 * c)) for sign in (1.0, -1.0)}

    def corner(sign: float, q: float) -> tuple[float, float]:
        """Turn and moment where the strip has slipped with the sign of its moment up to `q`."""
        moment = sign * c * reaction[sign](q)
        return -q / 48.0 + moment / 4.0 + 1.5 * GAP, moment

    def where_it_slips(turn: float, sign: float) -> float:
        """Pressure at which a tip that sticks at `turn` slips with a moment of `sign`."""
        # m = 4 (turn - 3 g / 2) + q / 12 and N = 3 (q / 8 + m / 2 - g) meet m = sign c N
        a, rest = 4.0 * (turn - 1.5 * GAP), sign * c
        return (rest * 3.0 * (a / 2.0 - GAP) - a) / (1.0 / 12.0 - rest * 3.0 * (1.0 / 8.0 + 1.0 / 24.0))

    top, bottom = corner(1.0, HIGH), corner(-1.0, LOW)
    back, forth = where_it_slips(top[0], -1.0), where_it_slips(bottom[0], 1.0)
    if not (LOW < back < HIGH and LOW < forth < HIGH):
        return 0.0
    points = np.array([top, corner(-1.0, back), bottom, corner(1.0, forth)])
    x, y = points.T
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.1, pytest.param(0.3, marks=pytest.mark.slow)])
def test_loop_of_a_strip_on_its_tip(mu: float) -> None:
    """Within 0.2 % on 64 cells; the last cell's turn stands for the tip's, so that the order is between 1 and 2."""
    exact = exact_cycle_of_tip(mu)
    errors = [cycle_of_tip(cells, mu) / exact - 1.0 for cells in (16, 32, 64)]
    assert exact > 0.0
    assert abs(errors[-1]) < 2e-3
    assert orders(errors).min() > 1.2


@pytest.mark.slow
def test_loss_goes_with_friction_where_it_slips_and_vanishes_where_it_sticks() -> None:
    """Half the friction, half the loss, to first order; friction past which the tip holds loses nothing."""
    few, half = cycle_of_tip(32, 0.01), cycle_of_tip(32, 0.005)
    assert few / half == pytest.approx(2.0, rel=1e-2)
    stuck = 20.0
    assert exact_cycle_of_tip(stuck) == 0.0
    assert abs(cycle_of_tip(32, stuck)) < 1e-6 * few


@pytest.mark.slow
def test_loss_does_not_depend_on_the_steps_of_the_path() -> None:
    assert cycle_of_tip(32, 0.2, steps=23) == pytest.approx(cycle_of_tip(32, 0.2), rel=2e-3)


# ------------------------------------------------------------------------------------------ two leaves

PRESS, TIP = 1.0, 0.05
"""Pressure that holds the leaves together; largest tip force."""


def leaves(cells: int, mu: float, width: float = WIDTH) -> tuple[ElasticProblem, Array, Friction]:
    """Two equal clamped strips pressed together, the force of a unit tip load shared by both, friction between."""
    phi = uniform_grid(1.0, cells)
    shell, every = strip_shell(phi, 0.0), np.arange(cells)
    press = PRESS * uniform_load(shell)[1:, 0]
    G = rows_of(2 * cells, (every, -1.0), (every + cells, 1.0))
    problem = strips_problem([shell, shell], [press, -press], G, np.zeros(cells))
    tip = np.zeros(2 * cells)
    tip[[cells - 1, 2 * cells - 1]] = 0.5 * cells
    turn = slopes(phi)[:, 1:]
    slip = sp.csr_array(ARM * sp.hstack([turn, turn], format="csr"))
    return problem, tip, Friction(mu, np.zeros(cells), slip, halves(cells + 1)[:, 1:], width)


def leaf_loop(cells: int, mu: float, width: float = 1e-5, steps: int = 8) -> tuple[Array, Array, float]:
    """Tip force and deflection along a closed cycle, and the energy lost in it."""
    problem, tip, friction = leaves(cells, mu, width)
    path = np.concatenate([np.linspace(a, b, steps + 1)[1:] for a, b in ((0, TIP), (TIP, -TIP), (-TIP, TIP))])
    problems = [
        ElasticProblem(problem.K, problem.force + F * tip, problem.G, problem.rest, problem.weight) for F in path
    ]
    states = follow(problems, friction, start(problem, friction, np.ones(cells, dtype=bool)))
    deflection = np.array([state.x[cells - 1] * UNIT for state in states])
    return path[steps - 1 :], deflection[steps - 1 :], sum(state.lost for state in states[steps:]) * UNIT / cells


def test_loop_of_two_leaves() -> None:
    """A parallelogram (D5): where the leaves slip, `w = (F -+ mu p delta) l^3 / (6 D)`."""
    mu = 0.5
    limit = mu * PRESS * 2.0 * ARM
    exact = 2.0 * limit * (2.0 * TIP - 2.0 * limit) / 6.0
    errors = []
    for cells in (16, 32, 64):
        force, deflection, lost = leaf_loop(cells, mu)
        errors.append(lost / exact - 1.0)
        assert_allclose([deflection[0], deflection[-1]], (TIP - limit) / 6.0, rtol=8.0 / cells**1.5)
        assert_allclose(np.trapezoid(force, deflection), lost, rtol=0.2)  # chords of a loop with corners
    assert abs(errors[-1]) < 1e-2
    assert orders(errors).min() > 0.9


@pytest.mark.slow
def test_width_of_the_stick_converges() -> None:
    """Coulomb's loss is approached as the width goes to zero, in proportion to it."""
    losses = [leaf_loop(16, 0.5, width)[2] for width in (4e-1, 2e-1, 1e-1, 1e-5)]
    away = [abs(loss / losses[-1] - 1.0) for loss in losses[:-1]]
    assert away[0] > away[1] > away[2]
    assert away[1] / away[2] == pytest.approx(2.0, rel=0.2)


# ------------------------------------------------------------------------------------------ a pack


def loop_of(mu: float, count: int) -> tuple[Array, Array, float]:
    """Load and displacement along the closed cycle of eight petals on 16 cells per pitch, and the dissipated energy."""
    turning = {"model.cells_per_pitch": 16, "surface.petal_friction": mu, "petals.theory": "inextensible"}
    rubbing = case("paper_n8", **turning)
    records = list(static.records(rubbing, np.linspace(0.0, 100e-6, count), loop=True))
    assert all(record.converged for record in records)
    cycle = [record.scalars for record in records[count - 1 :]]
    load, down = (np.array([float(s[name]) for s in cycle]) for name in ("force_y", "eccentricity_y"))
    return load, -down, float(cycle[-1]["petal_friction_work"]) - float(cycle[0]["petal_friction_work"])


@pytest.mark.slow
def test_energy_lost_by_a_pack_is_the_area_of_its_loop() -> None:
    """Work of the journal in a closed cycle, by the trapezium rule, comes to the energy lost as the way is refined."""
    away = []
    for count in (5, 17):
        load, down, lost = loop_of(0.1, count)
        assert load[-1] == pytest.approx(load[0], rel=1e-3)  # the cycle is closed
        away.append(abs(float(np.trapezoid(load, down)) / lost - 1.0))
    assert away[1] < 0.5 * away[0]
    assert away[1] < 0.15


@pytest.mark.slow
def test_loading_carries_more_than_unloading() -> None:
    load, _, _ = loop_of(0.1, 5)
    up, down = load[4:], load[4::-1]
    assert np.all(up[1:-1] > down[1:-1])


@pytest.mark.slow
def test_little_friction_is_none() -> None:
    smooth = case("paper_n8", **{"model.cells_per_pitch": 16})
    hardly = smooth.replace(**{"surface.petal_friction": 1e-9})  # contacts at nodes, as those of histories
    without = [float(r.scalars["force_y"]) for r in static.records(hardly, (0.0, 50e-6))]
    rubbing = smooth.replace(**{"surface.petal_friction": 1e-4})
    with_it = [float(r.scalars["force_y"]) for r in static.records(rubbing, (0.0, 50e-6))]
    assert with_it[1] == pytest.approx(without[1], rel=1e-3)
    assert with_it[1] > without[1]


def test_petals_that_nothing_touches_do_not_rub() -> None:
    """Short hinged petals lie on the bushing; it ended in a ValueError of NumPy, for want of a contact."""
    changes = {"petals.arc_length": "22.4 mm", "petals.bend_radius": "26.5 mm", "model.cells_per_pitch": 8}
    loose = case("paper_n8", **changes, **{"model.contacts": "nodes"})
    for coefficient in (0.0, 0.1):
        records = list(static.records(loose.replace(**{"surface.petal_friction": coefficient}), (0.0, 10e-6)))
        assert [record.scalars["status"] for record in records] == ["converged", "converged"]
        assert [record.scalars["contact_normal_force"] for record in records] == [0.0, 0.0]


def test_a_loop_without_friction_is_refused() -> None:
    with pytest.raises(UsageError, match="petal_friction"):
        static.records(case("paper_n8"), (0.0, 50e-6), loop=True)
    with pytest.raises(UsageError, match="two displacements"):
        static.records(case("paper_n8", **{"surface.petal_friction": 0.1}), (0.0,), loop=True)
