"""Histories of petals that slide along themselves: loops in closed form, energy, packs assembled and led, a rotor."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.hysteresis import follow, legs
from petalfoil.analysis.impedance import cycle_impedance, elastic_and_sliding, impedance, sliding_at
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.orbit import orbit
from petalfoil.analysis.static import static
from petalfoil.case import Rotor
from petalfoil.equilibrium.coulomb_path import slide_exactly
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import running
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.petal_membrane import StretchingPetal
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState
from petalfoil.walls.sliding import membrane_force, stretching
from tests.cases import case
from tests.verification.shell_helpers import UNIT, ElasticProblem, strip_shell, uniform_grid, uniform_load
from tests.verification.sliding_helpers import HalfArch
from tests.verification.test_orbit import equal_steps

Array = NDArray[np.float64]

# ------------------------------------------------------------------------------------------ a leaf on its tip

ARC, SLENDER, GAP = 0.87, 230.0, 0.005
"""Angle and slenderness of a clamped leaf of radius 1, and the gap of its tip to a wall across it, in `q R^4 / D`."""
LOW, HIGH = 1.0, 2.0
"""Pressures of the cycle."""
LEAF = HalfArch(ARC, SLENDER, 64)
"""The leaf in Hermite elements."""


def leaf(cells: int, mu: float) -> tuple[ElasticProblem, Array, Friction]:
    """The leaf before the wall, forces of a unit pressure, friction of the mid-surface at the tip."""
    shell = strip_shell(uniform_grid(ARC, cells), 1.0)
    cell = ARC / cells
    K = stretching([StretchingPetal(shell, 12.0 * SLENDER**2)]).stiffness * (UNIT / cell)
    pressure = np.concatenate([uniform_load(shell)[1:, 0], np.zeros(cells)]) / cell
    G = sp.csr_array(([-1.0], ([0], [cells - 1])), shape=(1, 2 * cells))
    slip = sp.csr_array(([-1.0], ([0], [2 * cells - 1])), shape=(1, 2 * cells))
    problem = ElasticProblem(sp.csr_array(K), pressure, G, np.array([GAP / UNIT]), np.ones(1))
    return problem, pressure, Friction(mu, np.zeros(1), slip, sp.csr_array(np.ones((1, 1))), 0.0, exact=True)


def led(problem: ElasticProblem, unit: Array, friction: Friction, path: Array) -> list[FrictionResult]:
    """The leaf along a path of pressures, from a start without friction at the first."""
    at = [ElasticProblem(problem.K, q * unit, problem.G, problem.rest, problem.weight) for q in path]
    start = np.zeros(problem.n), np.ones(1, dtype=bool)
    found, outcome = solve_contacts(at[0], start, LinearSolver(), ContactOptions(tangents=40))
    assert found is not None, outcome
    fresh = FrictionState.fresh(friction, found.x, found.lam)
    states = [FrictionResult(found.x, found.lam, found.active, found.state.residual, fresh, 0.0)]
    for one in at[1:]:
        slid = slide_exactly(one, friction, states[-1], [np.zeros((1, 1), dtype=np.intp)], LinearSolver())
        assert slid is not None
        assert slid.residual < 1e-8
        states.append(slid)
    return states


@pytest.mark.slow
def test_loop_of_an_arc_leaf_on_its_tip() -> None:
    """Within 0.2 % of slip, stick, slip back, stick in closed form, on 64 cells."""
    mu = 0.2
    path = np.concatenate([np.linspace(a, b, 25)[1:] for a, b in ((LOW, HIGH), (HIGH, LOW)) * 2])
    errors = []
    for cells in (32, 64):
        problem, unit, friction = leaf(cells, mu)
        states = led(problem, unit, friction, np.concatenate([[LOW], path]))
        lost = sum(state.lost for state in states[-48:]) * UNIT * (ARC / cells)
        errors.append(lost / LEAF.loss(mu, GAP, (LOW, HIGH)) - 1.0)
    assert abs(errors[-1]) < 2e-3
    assert abs(errors[-1]) < 0.5 * abs(errors[0])


def test_the_membrane_carries_what_friction_pulls() -> None:
    """Along a leaf that is held at its root and rubs at its tip the membrane force is the friction there."""
    cells = 32
    problem, unit, friction = leaf(cells, 0.2)
    (_, state) = led(problem, unit, friction, np.array([LOW, HIGH]))
    shell = strip_shell(uniform_grid(ARC, cells), 1.0)
    force = membrane_force([StretchingPetal(shell, 12.0 * SLENDER**2)], state.x * UNIT)
    assert state.friction.force[0] != 0.0
    assert_allclose(force, np.full(force.shape, state.friction.force[0] * ARC / cells), rtol=1e-6)


def test_an_arc_leaf_whose_tip_sticks_loses_nothing() -> None:
    """Friction past which the tip holds: an arch, whose slip stays."""
    problem, unit, friction = leaf(32, 20.0)
    states = led(problem, unit, friction, np.array([LOW, 1.3, 1.6, HIGH, 1.5, LOW]))
    assert sum(state.lost for state in states) < 1e-9 * LEAF.loss(0.2, GAP, (LOW, HIGH))
    assert_allclose([state.friction.slip[0] for state in states], states[0].friction.slip[0], atol=1e-9)


# ------------------------------------------------------------------------------------------ packs


def loop(name: str, mu: float, down: Array, **changes: object) -> tuple[Array, Array, float]:
    """Displacement and force down along the closed cycle of a pack, and the energy lost in it."""
    rubbing = case(name, **{"model.cells_per_pitch": 16, "surface.petal_friction": mu, **changes})
    records = list(static.records(rubbing, down, loop=True))
    assert all(record.converged for record in records)
    assert max(float(record.scalars["residual"]) for record in records) < 1e-8
    cycle = [record.scalars for record in records[len(down) - 1 :]]
    e, force = (np.array([float(point[key]) for point in cycle]) for key in ("eccentricity_y", "force_y"))
    return -e, force, float(cycle[-1]["petal_friction_work"]) - float(cycle[0]["petal_friction_work"])


@pytest.mark.slow
def test_energy_lost_by_a_pack_is_the_area_of_its_loop() -> None:
    away = []
    for count in (5, 17):
        e, force, lost = loop("paper_n8", 0.1, np.linspace(0.0, 40e-6, count))
        away.append(abs(float(np.trapezoid(force, e)) / lost - 1.0))
        assert force[-1] == pytest.approx(force[0], rel=2e-2)  # petals that stuck on the way back hold 1.5 % of it
        assert np.all(force[count - 2 : 0 : -1] < force[count:-1])
    assert away[1] < 0.5 * away[0]
    assert away[1] < 0.05


@pytest.mark.slow
def test_little_friction_loses_its_limit_times_the_slip_and_changes_little() -> None:
    """Half the friction, half the loss; and no friction between petals that slide is no friction. Contacts at nodes."""
    nodes = {"model.cells_per_pitch": 12, "model.contacts": "nodes"}
    _, few, lost = loop("rig", 2e-4, np.array([0.0, 4e-6]), **nodes)
    _, _, half = loop("rig", 1e-4, np.array([0.0, 4e-6]), **nodes)
    assert lost == pytest.approx(2.0 * half, rel=2e-2)
    turning = {"surface.petal_friction": 1e-6, "petals.theory": "inextensible"}  # hardly any, contacts at nodes too
    (none,) = static.records(case("rig", **{"model.cells_per_pitch": 12, **turning}), (4e-6,))
    assert few[0] == pytest.approx(float(none.scalars["force_y"]), rel=1e-3)


@pytest.mark.slow
def test_motion_of_a_rotor_keeps_the_balance_of_energy() -> None:
    """Half a turn of an unbalanced rotor: what friction takes is among the works, to the order of the steps."""
    errors = []
    for tolerance in (1e-3, 1e-4):
        rubbing = case("orbit_n8", **{"model.cells_per_pitch": 12, "surface.petal_friction": 0.1})
        record = orbit.record(rubbing, revolutions=0.5, initial="balance", tolerance=tolerance)
        assert float(np.asarray(record.fields["petal_friction_work"])[-1]) > 0.0
        errors.append(float(record.scalars["energy_balance_error"]))
    assert errors[0] < 1e-2
    assert errors[1] < 0.7 * errors[0]  # friction jumps where contacts begin to slip


def swings(t: Array, x: Array) -> tuple[Array, Array]:
    """Half the way between successive turning points of a free oscillation, and the times that they take."""
    turns = [k for k in range(1, len(x) - 1) if (x[k] - x[k - 1]) * (x[k + 1] - x[k]) < 0.0]
    times, places = [t[0]], [x[0]]
    for k in turns:
        parabola = np.polyfit(t[k - 1 : k + 2] - t[k], x[k - 1 : k + 2], 2)
        vertex = -0.5 * parabola[1] / parabola[0]
        times.append(t[k] + vertex)
        places.append(float(np.polyval(parabola, vertex)))
    return 0.5 * np.abs(np.diff(places)), np.diff(times)


@pytest.mark.slow
@pytest.mark.parametrize(("released", "friction"), [(8e-6, 0.002), pytest.param(50e-6, 0.0125, marks=pytest.mark.long)])
def test_a_rotor_decays_as_harmonic_balance_says(released: float, friction: float) -> None:
    """A rotor of 100 g released from off its balance: damping ratios of later swings within 5 %, mostly of friction.

    The loss of a cycle is taken from the stiffness without friction, for contacts hold as much energy at every turn
    (`test_friction_harmonics.py`). The first swing begins without friction. Histories are those of contacts at nodes
    (`test_decay.py` has contact points).
    """
    mass = 0.1
    bearing = case("paper_n8", **{
        "model.cells_per_pitch": 24, "surface.petal_friction": friction, "surface.friction_width": 1e-11,
        "operation.load": (0.0, -20.0),
    })  # fmt: skip
    with running():
        answer = operating_point(bearing, None).answer
        at_points, points = elastic_and_sliding(bearing, answer)
        at_nodes, nodes = SmallMotion.at_nodes(answer), sliding_at(bearing, answer)
        assert points is not None
        assert nodes is not None
        x, y = answer.problem.displacement * answer.problem.layout.scales.length
        rotor = bearing.replace(rotor=Rotor(mass=mass), **{"model.contacts": "nodes"})
        record = orbit.record(rotor, revolutions=18.0, initial=(x + released, y))
        sizes, times = swings(record.coords["time"].astype(float), np.asarray(record.fields["x"], dtype=float))
        for k in (1, 2):
            ratio = np.log(sizes[k] / sizes[k + 1]) / np.pi
            amplitude, frequency = np.sqrt(sizes[k] * sizes[k + 1]), 2.0 * np.pi / (times[k] + times[k + 1])
            for motion, sliding in ((at_nodes, nodes), (at_points.frictionless, points)):
                rubs = cycle_impedance(motion, frequency, bearing.operation.speed, (sliding, float(amplitude)))
                K_free, C_free = impedance(motion.frictionless, frequency, bearing.operation.speed)
                assert ratio == pytest.approx(frequency * rubs.damping[0, 0] / (2.0 * K_free[0, 0]), rel=0.05)
                assert K_free[0, 0] < rubs.stiffness[0, 0]
                assert C_free[0, 0] < 0.2 * rubs.damping[0, 0]


@pytest.mark.slow
def test_a_step_costs_one_factorisation_on_every_grid() -> None:
    """Eight petals moved by 10 um in steps of 5 um: as many factorisations as steps, whatever the number of cells.

    Contacts at nodes.
    """
    nodes = {"surface.petal_friction": 0.1, "model.contacts": "nodes"}
    for cells in (12, 48):
        rubbing = case("paper_n8", **{"model.cells_per_pitch": cells, **nodes})
        way = legs([rubbing.replace(**{"operation.eccentricity": (0.0, -e)}) for e in (0.0, 10e-6)], False)
        start, moved = follow(way)
        assert start.answer is not None
        assert moved.answer is not None
        steps = [event for event in moved.run.history if "share" in str(event)]
        assert moved.run.pack_solver.counter.factorizations == len(steps) <= 4


DRAGGING = {"surface.journal_rubbing": "force", "operation.speed": 300.0, "operation.eccentricity": (0.0, -240e-6)}
RUBS = {"petals": ({"surface.petal_friction": 0.1}, 1.0), "journal": (DRAGGING, 0.25)}
"""What rubs, and how long it is followed [units of time]."""


@pytest.mark.slow
@pytest.mark.parametrize("rubs", RUBS)
def test_energy_closes_to_second_order_with_friction(rubs: str) -> None:
    """Of a rotor released on petals: steps halved thrice. Events that fall into other steps spread the slopes."""
    (changes, end), errors = RUBS[rubs], []
    bearing = case("orbit_n8", **{"model.cells_per_pitch": 8, **changes})
    for halved in range(4):
        with running():
            trace = equal_steps(bearing, 0.2 * end / 2.0**halved, end).trace
        over = trace.histories()[1]
        assert over["petal_friction_work"][-1] > 0.0 if rubs == "petals" else trace.column("rubbing_torque")[-1] > 0.1
        errors.append(trace.audits(over).energy_balance_error)
    slopes = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(np.abs(slopes - 2.0) < 0.3)
