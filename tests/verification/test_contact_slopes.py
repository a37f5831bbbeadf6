"""Slopes of answers with contact: a strip on a round stop with a known limit, and bearings from grid to grid."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import simpson
from scipy.optimize import fsolve

from petalfoil.analysis.impedance import elastic, impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.case import Case
from petalfoil.equilibrium.continuation import follow
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.travelling_contacts import travelling_contacts, turning_compliance
from petalfoil.physics.contact import Contacts, GapLines
from petalfoil.physics.contact_points import IsolatedContacts
from petalfoil.solvers.problem import Border
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from tests.cases import FAULTS, case
from tests.verification.shell_helpers import (
    UNIT,
    rows_of,
    solve,
    strip_shell,
    strips_problem,
    uniform_grid,
    uniform_load,
)

Array = NDArray[np.float64]

# ------------------------------------------------------------------------------------------ a strip on a round stop
#
# A strip of unit length, stiffness and load, clamped at 0, on a stop with its top at (x0, g0) and curvature k: it
# touches at one point, which travels when the stop is moved.

STOP, CURVATURE = np.array([0.02, 0.62]), 0.3  # g0, x0


def touching(stop: Array) -> tuple[float, float]:
    """Reaction and contact point, from `w = q x^2 (6 - 4 x + x^2) / 24 - R (3 x - x_c) x_c^2 / 6`, tangent there."""

    def apart(unknown: Array) -> list[float]:
        R, x = unknown
        w = x**2 * (6.0 - 4.0 * x + x**2) / 24.0 - R * x**3 / 3.0
        turned = x * (3.0 - 3.0 * x + x**2) / 6.0 - R * x**2 / 2.0
        return [w - stop[0] - 0.5 * CURVATURE * (x - stop[1]) ** 2, turned - CURVATURE * (x - stop[1])]

    R, x = fsolve(apart, [0.5, stop[1]], xtol=1e-13)
    return float(R), float(x)


def force_on_stop(stop: Array) -> Array:
    """Force that the strip feels along both coordinates of the stop: `R n_e`, `n_e = (1, -k (x - x0))`."""
    R, x = touching(stop)
    return np.array([R, -R * CURVATURE * (x - stop[1])])


def exact_gradient() -> Array:
    """Derivative of the force at constant `n_e`: gaps of bearings are linear in the journal's position."""
    step, (R, _) = 1e-5, touching(STOP)
    moved = [(force_on_stop(STOP + step * e) - force_on_stop(STOP - step * e)) / (2.0 * step) for e in np.eye(2)]
    return np.column_stack(moved) - np.diag([0.0, R * CURVATURE])


def strip_gradient(cells: int, *, travelling: bool) -> Array:
    """The same on a grid, contacts as points that travel or at their nodes."""
    phi, n, none = uniform_grid(1.0, cells), cells, slice(0, 0)
    shell = strip_shell(phi, 0.0)
    rest = STOP[0] + 0.5 * CURVATURE * (phi[1:] - STOP[1]) ** 2
    problem = strips_problem([shell], [uniform_load(shell)[1:, 0]], rows_of(n, (np.arange(n), -1.0)), rest)
    answer, matrix = solve(problem, n), sp.csc_array(problem.K)
    by_e = np.column_stack([np.ones(n), -CURVATURE * (phi[1:] - STOP[1])])
    lines = (GapLines(np.arange(n)[None], phi[1:], 1),) if travelling else ()
    contacts = Contacts(problem.G, rest, by_e, np.ones(n), none, none, none, lines)
    points = IsolatedContacts.of(contacts, problem.gaps(answer.x), answer.lam, answer.active)
    assert len(points.travel_stiffness) == int(travelling)
    compliance = turning_compliance(problem.G, matrix, points, None)
    moving = travelling_contacts((problem.G, problem.G), by_e, points.placed(compliance))
    matrix, constraints = sp.csc_array(matrix + moving.tangent), moving.constraints
    tangent = Tangent(matrix, constraints, constraints.factor(matrix, LinearSolver(), None))
    border = Border(moving.gap_by_e, -moving.forcing.T, slice(0, n))
    gradient = BorderedTangent.of(tangent, border, moving.forcing).gradient - moving.gradient
    return np.asarray(gradient / cells / UNIT)  # gaps are over UNIT, reactions over a cell's load


def strip_error(cells: int, *, travelling: bool) -> float:
    """Error of the gradient over its largest entry."""
    exact = exact_gradient()
    return float(np.max(np.abs(strip_gradient(cells, travelling=travelling) - exact)) / np.max(np.abs(exact)))


@pytest.mark.parametrize("cells", [24, 40, 64, 96, 128, 192, 256])
def test_gradient_of_a_strip_on_a_stop_converges(cells: int) -> None:
    """First order, as the reaction of a contact at nodes, with 0.3 % left at 100 cells; nodes never come near it."""
    assert strip_error(cells, travelling=True) <= 0.3 / cells
    assert strip_error(cells, travelling=False) >= 0.3


def test_gradient_of_a_strip_is_symmetric() -> None:
    gradient = strip_gradient(48, travelling=True)
    assert_allclose(gradient[0, 1], gradient[1, 0], rtol=1e-6)


# ------------------------------------------------------------------------------------------ bearings

PAPER = {"operation.eccentricity": (0.0, -200e-6)}
BEARINGS = {
    "turbocharger": Case.load(FAULTS / "turbocharger.toml"),
    "six petals": case("paper_n6", **PAPER),
    "eight petals": case("paper_n8", **PAPER),
    "ten petals": case("paper_n10", **PAPER),
    "rig": case("rig", **{"operation.eccentricity": (0.0, -12e-6)}),
}


def stiffness(bearing: Case, cells: int) -> Array:
    """`K` on a grid [N/m]."""
    bearing = bearing.replace(**{"model.cells_per_pitch": cells})
    with running():
        answer = operating_point(bearing, None).answer
        return impedance(elastic(bearing, answer), 0.0, bearing.operation.speed)[0]


def apart(one: Array, other: Array) -> float:
    """Largest difference over the largest entry of the second."""
    return float(np.max(np.abs(one - other)) / np.max(np.abs(other)))


@pytest.mark.slow
def test_stiffness_of_a_turbocharger_bearing_has_a_limit() -> None:
    """33.50, -0.97, -1.62, 148.1 kN/m on 256 cells; contacts at nodes give 140 to 154 kN/m for the last."""
    limit = stiffness(BEARINGS["turbocharger"], 256)
    assert_allclose(limit.ravel(), [33.50e3, -0.97e3, -1.62e3, 148.1e3], rtol=0.0, atol=0.15e3)
    for cells, error in ((64, 7e-3), (96, 3e-3), (128, 3e-3)):
        assert apart(stiffness(BEARINGS["turbocharger"], cells), limit) <= error


@pytest.mark.slow
@pytest.mark.parametrize("name", BEARINGS)
def test_stiffness_on_the_default_grid_is_that_on_a_finer_one(name: str) -> None:
    """Within 1 % of the largest entry."""
    bearing = BEARINGS[name]
    cells = bearing.cells_per_pitch
    assert apart(stiffness(bearing, cells), stiffness(bearing, 2 * cells)) <= 1e-2


def walk(bearing: Case, steps: int, step: float) -> list[Solution]:
    """Equilibria on the way of the journal downward by `steps` of `step` [m], each from the one before."""
    with running():
        answer = operating_point(bearing, None).answer
        first = follow(answer, answer.problem.at(displacement=answer.problem.displacement))  # with contacts at nodes
        assert first is not None
        found, de = [first], np.array([0.0, -step / answer.problem.layout.scales.length])
        for _ in range(steps):
            near = follow(found[-1], found[-1].problem.at(displacement=found[-1].problem.displacement + de))
            assert near is not None
            found.append(near)
    return found


@pytest.mark.slow
def test_stiffness_is_smooth_along_a_sweep() -> None:
    """In steps of 0.1 um the stiffness of points strays by 0.1 % from a smooth curve, that of nodes by per cents."""
    bearing = BEARINGS["turbocharger"].replace(**{"model.cells_per_pitch": 64})
    found, speed = walk(bearing, 40, 0.1e-6), bearing.operation.speed
    noise = []
    for kind in (SmallMotion.about, SmallMotion.at_nodes):
        with running():
            K = np.array([impedance(kind(answer), 0.0, speed)[0][1, 1] for answer in found])
        place = np.linspace(-1.0, 1.0, len(K))
        noise.append(float(np.max(np.abs(K - np.polyval(np.polyfit(place, K, 4), place))) / np.mean(K)))
    assert noise[0] <= 1.5e-3
    assert noise[1] >= 3e-2


@pytest.mark.slow
def test_stiffness_is_the_slope_of_equilibria_far_apart() -> None:
    """Chords over 16 um, in which contacts pass some cells, against the mean stiffness on the way: 0.5 %."""
    bearing = BEARINGS["turbocharger"].replace(**{"model.cells_per_pitch": 256})
    found = walk(bearing, 16, 1e-6)
    scales = found[0].problem.layout.scales
    ends = [a.problem.journal_force(a.x, a.lam) * scales.force for a in (found[0], found[-1])]
    chord = (ends[1] - ends[0]) / 16e-6
    with running():
        K = np.array([impedance(SmallMotion.about(answer), 0.0, bearing.operation.speed)[0][:, 1] for answer in found])
    mean = simpson(K, dx=1.0 / 16.0, axis=0)
    assert_allclose(chord, mean, rtol=0.0, atol=5e-3 * float(np.max(np.abs(mean))))
