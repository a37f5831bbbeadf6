"""Straight strips against walls, a cylinder and each other: `reference/d2_contact.csv`.

Contact is node to node. Where a contact ends inside a cell the grid moves it to a node, so the end is known to a
cell: first order, and so is a line reaction read off the nodes around it. What integrates over the strip (total
reaction, deflection of the tip) is second order, with a factor that depends on where in its cell the contact ends.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from petalfoil.mesh.quadrature import trapezoid
from petalfoil.solvers.contact_equations import ContactOutcome
from tests.verification.shell_helpers import (
    GRIDS,
    UNIT,
    Array,
    ElasticProblem,
    Solved,
    cold_point,
    follow,
    orders,
    polish,
    rows_of,
    solve,
    strip_shell,
    strips_problem,
    table,
    uniform_grid,
    uniform_load,
)

CELLS = (32, 64, 128)


def parameters(text: str) -> float:
    """The value after the last equals sign."""
    return float(text.split("=")[-1].strip(" )"))


def values(case: str, quantity: str) -> list[tuple[float, float]]:
    """Parameter and value of one quantity of one case."""
    return [
        (parameters(row["parameters"]), float(row["value"]))
        for row in table("d2_contact")
        if row["case"] == case and row["quantity"].startswith(quantity)
    ]


# ------------------------------------------------------------------------------------------ A: flat wall


def wall_problem(phi: Array, gap: float) -> ElasticProblem:
    """A strip pressed by `q = 1` against a wall `gap` away."""
    shell, n = strip_shell(phi, 0.0), len(phi) - 1
    G = rows_of(n, (np.arange(n), -1.0))
    return strips_problem([shell], [uniform_load(shell)[1:, 0]], G, np.full(n, gap))


def at_wall(grid: str, cells: int, gap: float) -> tuple[Array, Array, Solved]:
    """Nodes without the root, reactions over `q l`, answer."""
    phi = GRIDS[grid](1.0, cells)
    problem = wall_problem(phi, gap)
    answer = solve(problem, problem.n)
    return phi[1:], answer.lam / (len(phi) - 1), answer


@pytest.mark.parametrize("grid", GRIDS)
def test_wall_out_of_reach(grid: str) -> None:
    for gap, tip in values("A flat wall", "tip deflection"):
        _, lam, answer = at_wall(grid, CELLS[1], gap)
        assert_allclose(answer.x[-1] * UNIT, tip, rtol=1e-3)
        assert lam.sum() < 4e-4  # at G = 1/8 the tip of the grid's own strip just arrives


@pytest.mark.parametrize("grid", GRIDS)
def test_tip_reaction(grid: str) -> None:
    for gap, reaction in values("A flat wall", "tip reaction"):
        errors = []
        for cells in CELLS:
            _, lam, answer = at_wall(grid, cells, gap)
            errors.append(lam.sum() / reaction - 1.0)
            assert answer.active[:-1].sum() <= (1 if gap < 0.0139 else 0)  # at G = 1/72 the strip begins to lie down
        assert abs(errors[1]) < 4e-3, gap
        assert orders(errors).min() > 1.9, gap


@pytest.mark.parametrize("grid", GRIDS)
def test_line_contact(grid: str) -> None:
    ends, lines = dict(values("A flat wall", "lift-off")), dict(values("A flat wall", "line reaction"))
    for gap, a in ends.items():
        assert_allclose(a, (72.0 * gap) ** 0.25, rtol=1e-10)
        for cells in CELLS:
            x, lam, answer = at_wall(grid, cells, gap)
            cell = float(np.diff(x).max())
            first = int(np.argmax(answer.active))
            assert answer.active[first:].all()
            assert abs(x[first] - a) < cell
            # the first two touching nodes bear the line reaction and the pressure on their own share
            line = lam[first : first + 2].sum() - trapezoid(np.append(0.0, x))[1:][first : first + 2].sum()
            assert abs(line - lines[gap]) < 1.5 * cell
            assert_allclose(lam[first + 2 : -1], trapezoid(np.append(0.0, x))[1:][first + 2 : -1], rtol=1e-5)


AVERAGED = (16, 32, 64)
"""Grids of root mean squares over many contacts, that is over places of a contact's end within its cell."""
GAPS = np.geomspace(8e-4, 0.0125, 33)


@pytest.mark.slow
@pytest.mark.parametrize("grid", GRIDS)
def test_total_reaction_of_line_contact(grid: str) -> None:
    """`R = q (l - a) + q a / 3`; root mean square over 33 gaps."""
    exact = 1.0 - 2.0 / 3.0 * (72.0 * GAPS) ** 0.25
    errors = []
    for cells in AVERAGED:
        totals = np.array([at_wall(grid, cells, gap)[1].sum() for gap in GAPS])
        errors.append(float(np.sqrt(np.mean((totals / exact - 1.0) ** 2))))
    assert errors[2] < 5e-4
    assert orders(errors).min() > 1.9


# ------------------------------------------------------------------------------------------ B: rigid cylinder


def cylinder_problem(phi: Array, tip: float, pressure: float) -> ElasticProblem:
    """A strip bent over a cylinder of unit radius that it is tangent to at its root."""
    shell, n = strip_shell(phi, 0.0), len(phi) - 1
    force = pressure * uniform_load(shell)[1:, 0]
    force[-1] += tip
    return strips_problem([shell], [force], rows_of(n, (np.arange(n), -1.0)), 0.5 * phi[1:] ** 2)


def tip_loaded(phi: Array, load: float) -> tuple[Array, Array]:
    """Deflections and reactions under a tip load.

    Nothing presses where the strip wraps, so that any of those nodes may count as closed: the interior point answers.
    """
    problem = cylinder_problem(phi, load, 0.0)
    point, _ = follow(problem, cold_point(problem, problem.n), 1e-9)
    return point.x * UNIT, point.lam / (len(phi) - 1)


def pressed(phi: Array, load: float) -> tuple[Array, Array]:
    """Deflections and reactions under a pressure."""
    problem = cylinder_problem(phi, 0.0, load)
    answer = solve(problem, problem.n)
    return answer.x * UNIT, answer.lam / (len(phi) - 1)


@pytest.mark.parametrize("grid", GRIDS)
def test_cylinder_under_tip_load(grid: str) -> None:
    case = "B cylinder tip load"
    for (load, a), (_, tip) in zip(values(case, "a/l"), values(case, "w(l)"), strict=True):
        for cells in CELLS:
            phi = GRIDS[grid](1.0, cells)
            w, lam = tip_loaded(phi, load)
            cell = float(np.diff(phi).max())
            pushing = lam > 0.01 * load
            assert np.abs(phi[1:][pushing] - a).max() < 1.01 * cell
            assert_allclose(lam.sum(), load, rtol=1e-4)
            assert_allclose(lam @ phi[1:] / lam.sum(), a, rtol=1e-4)  # statics: on any grid
            assert_allclose(w[-1], tip, rtol=cell**2 * load)


@pytest.mark.parametrize("grid", GRIDS)
def test_cylinder_under_pressure(grid: str) -> None:
    case = "B cylinder pressure"
    for (load, a), (_, tip), (_, line) in zip(
        values(case, "a/l"), values(case, "w(l)"), values(case, "line reaction"), strict=True
    ):
        for cells in CELLS:
            phi = GRIDS[grid](1.0, cells)
            w, lam = pressed(phi, load)
            share, cell = load * trapezoid(phi)[1:], float(np.diff(phi).max())
            last = int(np.flatnonzero(lam)[-1])
            assert np.all(lam[: last + 1] > 0.0)
            assert abs(phi[1:][last] - a) < cell
            assert abs((lam - share)[last - 1 : last + 1].sum() / load - line) < 1.5 * cell
            assert_allclose(w[-1], tip, rtol=cell**2 * load)


CASES = {"tip load": (tip_loaded, np.geomspace(1.3, 12.0, 33)), "pressure": (pressed, np.geomspace(3.0, 40.0, 33))}


@pytest.mark.slow
@pytest.mark.parametrize("grid", GRIDS)
@pytest.mark.parametrize("case", CASES)
def test_tip_over_the_cylinder(case: str, grid: str) -> None:
    """From `a` on the strip is a cantilever, with the cylinder's slope; root mean square over 33 loads."""
    bent, loads = CASES[case]
    b = 1.0 / loads if case == "tip load" else np.sqrt(2.0 / loads)
    sag = loads * b**3 / 3.0 if case == "tip load" else loads * b**4 / 8.0
    exact = 0.5 * (1.0 - b) ** 2 + (1.0 - b) * b + sag
    errors = []
    for cells in AVERAGED:
        tips = np.array([bent(GRIDS[grid](1.0, cells), load)[0][-1] for load in loads])
        errors.append(float(np.sqrt(np.mean((tips / exact - 1.0) ** 2))))
    assert errors[2] < 2e-4
    assert orders(errors).min() > 1.9


# ------------------------------------------------------------------------------------------ C: stacked leaves


def leaves_problem(cells: int, a: float, D2: float) -> tuple[ElasticProblem, int]:
    """A leaf with `P = 1` at its tip on a shorter one of length `a` and stiffness `D2`; nodes of the shorter one."""
    phi = uniform_grid(1.0, cells)
    m, n = round(a * cells), cells
    long, short = strip_shell(phi, 0.0), strip_shell(phi[: m + 1], 0.0, rigidity=D2)
    force = np.zeros(n)
    force[-1] = 1.0
    G = rows_of(n + m, (n + np.arange(m), 1.0), (np.arange(m), -1.0))
    return strips_problem([long, short], [force, np.zeros(m)], G, np.zeros(m)), m


def stacked(quantity: str) -> list[tuple[float, float, float]]:
    found = []
    for row in table("d2_contact"):
        if row["case"] == "C stacked leaves" and row["quantity"].startswith(quantity):
            length, stiffness = row["parameters"].split()
            found.append((parameters(length), parameters(stiffness), float(row["value"])))
    return found


@pytest.mark.slow
def test_stacked_leaves() -> None:
    """Grids on which the shorter leaf ends at a node; between, the leaves part, and nothing else touches."""
    for (a, D2, X), (_, _, tip) in zip(stacked("X/P"), stacked("w1"), strict=True):
        if a == 1.0:
            continue
        errors = []
        for cells in (20, 40, 80):
            problem, m = leaves_problem(cells, a, D2)
            answer = solve(problem, problem.n)
            assert np.flatnonzero(answer.active).tolist() == [m - 1]
            errors.append([answer.lam.sum() / cells / X - 1.0, answer.x[cells - 1] * UNIT / tip - 1.0])
        assert np.abs(errors[2]).max() < 1e-3
        assert orders(np.array(errors)).min() > 1.9


def test_equal_leaves_lie_on_each_other() -> None:
    """Of equal length they bend alike: every gap is zero, all but the last without reaction (interior point)."""
    for (a, D2, X), (_, _, tip) in zip(stacked("X/P"), stacked("w1"), strict=True):
        if a != 1.0:
            continue
        errors = []
        for cells in (20, 40, 80):
            problem, m = leaves_problem(cells, a, D2)
            point, _ = follow(problem, cold_point(problem, problem.n), 1e-9)
            errors.append(point.x[cells - 1] * UNIT / tip - 1.0)
            assert_allclose(point.lam @ np.arange(1, m + 1) / cells**2, X, rtol=1e-5)
            assert_allclose(problem.gaps(point.x) * UNIT, 0.0, atol=1e-7)
        assert abs(errors[2]) < 1e-3
        assert orders(errors).min() > 1.9


# ------------------------------------------------------------------------------------------ counts


@pytest.mark.parametrize("gap", [0.1, 0.01, 0.001])
def test_interior_point_takes_as_many_steps_on_every_grid(gap: float) -> None:
    counts = {}
    for cells in (32, 256):
        problem = wall_problem(uniform_grid(1.0, cells), gap)
        counts[cells] = follow(problem, cold_point(problem, problem.n))[1]
    assert counts[32] <= 12
    assert counts[256] <= 1.5 * counts[32]


@pytest.mark.parametrize("gap", [0.1, 0.01, 0.001])
def test_active_set_is_quick_from_the_set_of_a_coarser_grid(gap: float) -> None:
    coarse = at_wall("uniform", 64, gap)[2]
    fine = wall_problem(uniform_grid(1.0, 128), gap)
    closed = np.repeat(coarse.active, 2)
    start = np.interp(np.arange(1, 129) / 128.0, np.arange(65) / 64.0, np.append(0.0, coarse.x))
    answer, outcome, count = polish(fine, start, closed)
    assert outcome is ContactOutcome.CONVERGED
    assert answer is not None
    assert count <= 5
    assert_allclose(answer.x, solve(fine, fine.n).x, atol=1e-6)


@pytest.mark.parametrize("cells", [32, 256])
def test_active_set_from_nothing_answers_rightly_or_not_at_all(cells: int) -> None:
    problem = wall_problem(uniform_grid(1.0, cells), 0.001)
    answer, outcome, _ = polish(problem, np.zeros(problem.n), np.zeros(problem.n, dtype=bool))
    if answer is None:
        assert outcome is not ContactOutcome.CONVERGED
    else:
        assert_allclose(answer.x, solve(problem, problem.n).x, atol=1e-6)
