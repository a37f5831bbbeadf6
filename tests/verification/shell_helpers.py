"""Petals and strips alone: elastic problems with gaps that the solvers take, and tables to compare them with."""

import csv
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.axial import AxialGrid, axis_2d
from petalfoil.mesh.pitch import petal_angles
from petalfoil.mesh.quadrature import trapezoid
from petalfoil.physics.shell import PetalShell
from petalfoil.solvers.contact_equations import ContactOutcome
from petalfoil.solvers.contact_newton import ActiveContacts, solve_contacts
from petalfoil.solvers.interior_point import InteriorOptions, InteriorStep, interior_point
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, ContactProblem, PrimalDualPoint
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.sparsity import SparseRows
from petalfoil.system.coupled import WALL_ROUNDING

Array = NDArray[np.float64]
REFERENCE = Path(__file__).parent / "reference"

OVERLAP = 1.77
"""Overlap of the pack's own grid in these tests: two parts of unequal cells in every pitch."""


def table(name: str) -> list[dict[str, str]]:
    """Rows of a reference table by column."""
    with (REFERENCE / f"{name}.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


# ------------------------------------------------------------------------------------------ grids and shells


def uniform_grid(angle: float, cells: int) -> Array:
    """`cells` equal cells over a petal of `angle` [rad]."""
    return np.linspace(0.0, angle, cells + 1)


def pack_grid(angle: float, cells: int) -> Array:
    """A petal's nodes as the pack has them: an overlap of 1.77 pitches, `cells` a pitch."""
    return petal_angles(angle / OVERLAP, OVERLAP, cells)


GRIDS: dict[str, Callable[[float, int], Array]] = {"uniform": uniform_grid, "pack": pack_grid}


def strip_shell(phi: Array, k: float, *, clamped: bool = True, rigidity: float = 1.0) -> PetalShell:
    """A strip of unit width, metric radius 1 and `R_p = 1/k`; straight, with arc length `phi`, where `k = 0`."""
    return plate_shell(phi, axis_2d(1.0), k, 0.3, clamped=clamped, rigidity=rigidity)


def plate_shell(
    phi: Array, axial: AxialGrid, k: float, nu: float, *, clamped: bool = True, rigidity: float = 1.0
) -> PetalShell:
    """A petal of metric radius 1 and `R_p = 1/k`."""
    bend_radius = 1.0 / k if k else math.inf
    return PetalShell(phi, axial, 1.0, bend_radius, rigidity, nu, clamped)


def uniform_load(shell: PetalShell) -> Array:
    """Nodal forces of a unit pressure, shape (node, axial)."""
    return shell.metric_radius * trapezoid(shell.phi)[:, None] * shell.axial.weight[None, :]


def bend(shell: PetalShell, force: Array) -> Array:
    """Deflection of a clamped petal under nodal forces, both of shape (node, axial)."""
    n_z = force.shape[1]
    W = np.zeros_like(force)
    inner = shell.stiffness[n_z:, n_z:]
    W[1:] = LinearSolver().factor(sp.csc_array(inner)).solve(force[1:].ravel()).reshape(-1, n_z)
    return W


# ------------------------------------------------------------------------------------------ problems with gaps


@dataclass(frozen=True)
class ElasticProblem:
    """`min x K x / 2 - x f` over `rest + G x >= 0`, in units that make loads and gaps of order one.

    Attributes
    ----------
    K : (n, n) sparse
        Stiffness.
    force : (n,) array
        Nodal forces.
    G : (m, n) sparse
        Rows hold +-1 on one unknown, or the difference of two.
    rest : (m,) array
        Gaps at `x = 0`.
    weight : (m,) array
        Weights of the gaps.
    """

    K: sp.csr_array
    force: Array
    G: SparseRows
    rest: Array
    weight: Array

    def __post_init__(self) -> None:
        """Take the rows of any sparse matrix."""
        object.__setattr__(self, "G", SparseRows(self.G))

    @property
    def acting(self) -> SparseRows:
        """Reactions act along the gaps."""
        return self.G

    @property
    def n(self) -> int:
        """Unknowns."""
        return len(self.force)

    @property
    def elimination_key(self) -> None:
        """The solver orders the elimination itself."""

    @property
    def positive(self) -> slice:
        """No unknown is bound to stay positive."""
        return slice(0, 0)

    def gaps(self, x: Array) -> Array:
        """Gaps at `x`, (m,)."""
        out: Array = self.rest + self.G @ x
        return out

    def admits(self, x: Array) -> bool:
        """Elasticity can be evaluated anywhere."""
        return True

    def linearize(self, x: Array, shift: Array | None = None) -> "ElasticLine":
        """Residual and tangent; gaps do not enter them."""
        return ElasticLine(self, x)


@dataclass(frozen=True)
class ElasticLine:
    """The problem at one point; rows are measured by a unit force, or by the rounding of `K x` where that is more."""

    problem: ElasticProblem
    x: Array

    @cached_property
    def residual(self) -> Array:
        """`K x - f`, reactions apart."""
        out: Array = self.problem.K @ self.x - self.problem.force
        return out

    @cached_property
    def row_scale(self) -> Array:
        """What each row's residual is compared with."""
        rounding = WALL_ROUNDING * np.finfo(float).eps * (abs(self.problem.K) @ np.abs(self.x))
        scale: Array = np.maximum(1.0, rounding / RESIDUAL_TOLERANCE)
        return scale

    def matrix(self, barrier_weight: Array, rate: float = 0.0) -> sp.csc_array:
        """`K + G^T diag(barrier_weight) G`."""
        G = self.problem.G
        return sp.csc_array(self.problem.K + G.T @ sp.diags_array(barrier_weight) @ G)

    def slack_derivative(self, change: Array, rate: float = 0.0) -> Array:
        """The residual does not depend on the gaps."""
        return np.zeros(len(self.x))


def rows_of(n: int, *terms: tuple[Sequence[int] | NDArray[np.intp], float]) -> sp.csr_array:
    """Rows of gaps over `n` unknowns: each term puts its coefficient at its column of every row."""
    m = len(terms[0][0])
    rows = np.tile(np.arange(m), len(terms))
    cols = np.concatenate([np.asarray(columns, dtype=np.intp) for columns, _ in terms])
    data = np.concatenate([np.full(m, sign) for _, sign in terms])
    return sp.coo_array((data, (rows, cols)), shape=(m, n)).tocsr()


UNIT = 1e-4
"""Unit of deflection in problems of unit length, load and stiffness: small beside 1/8, as 10 um are beside a petal's
travel."""


def strips_problem(
    shells: Sequence[PetalShell], forces: Sequence[Array], G: sp.csr_array, rest: Array
) -> ElasticProblem:
    """Strips side by side with gaps along the first nodes of the first one, root apart; `forces` without the root."""
    phi = shells[0].phi
    cell = float(phi[-1]) / (len(phi) - 1)
    K = sp.block_diag([shell.stiffness[1:, 1:] for shell in shells], format="csr")
    weight = trapezoid(phi)[1 : len(rest) + 1] / cell
    return ElasticProblem(sp.csr_array(K * (UNIT / cell)), np.concatenate(forces) / cell, G, rest / UNIT, weight)


# ------------------------------------------------------------------------------------------ solving them


@dataclass(frozen=True)
class Solved:
    """An answer and what it took.

    Attributes
    ----------
    x, lam : array
        Unknowns and reactions.
    active : bool array
        Active contacts.
    steps : int
        Steps of the interior point down to the first barrier.
    polish : int
        Factorisations of the active set that gave the answer.
    """

    x: Array
    lam: Array
    active: NDArray[np.bool_]
    steps: int
    polish: int


def cold_point(problem: ContactProblem, n: int) -> PrimalDualPoint:
    """Undeformed, with slacks wide enough for every gap and reactions on the central path."""
    gaps = problem.gaps(np.zeros(n))
    width = max(1.0, -float(gaps.min()))
    slack = np.maximum(gaps, width)
    return PrimalDualPoint(np.zeros(n), slack, 300.0 * width * problem.weight / slack)


def follow(problem: ContactProblem, start: PrimalDualPoint, barrier: float = 1e-5) -> tuple[PrimalDualPoint, int]:
    """Interior point from `start` until barrier, residual and infeasibility are small; the point and the steps."""
    solver = LinearSolver()

    def watch(_: PrimalDualPoint, step: InteriorStep) -> bool:
        return step.barrier < barrier and step.residual < 1e-4 and step.infeasibility < 1e-4

    point, done = interior_point(problem, start, solver, InteriorOptions(), watch)
    assert done, f"no answer after {solver.counter.factorizations} steps"
    return point, solver.counter.factorizations


def polish(
    problem: ContactProblem, x: Array, active: NDArray[np.bool_]
) -> tuple[ActiveContacts | None, ContactOutcome, int]:
    """Newton from `x` and `active`; the answer, how it ended, the factorisations."""
    solver = LinearSolver()
    answer, outcome = solve_contacts(problem, (x, active), solver)
    return answer, outcome, solver.counter.factorizations


BARRIERS = (1e-5, 1e-8, 1e-11)
"""Where the active set is tried. Along a stretch of contact whose ends carry little it moves one node a step, so on a
fine grid it must start close."""


def solve(problem: ContactProblem, n: int) -> Solved:
    """From nothing to exact zeros: interior point, then the active set from where it ends."""
    point, steps = cold_point(problem, n), 0
    outcome = ContactOutcome.STEPS
    for barrier in BARRIERS:
        point, more = follow(problem, point, barrier)
        steps = steps or more
        answer, outcome, count = polish(problem, point.x, point.lam / problem.weight > point.s)
        if answer is not None:
            return Solved(answer.x, answer.lam, answer.active, steps, count)
    raise AssertionError(outcome.value)


# ------------------------------------------------------------------------------------------ orders


def orders(errors: Sequence[float] | Array) -> Array:
    """Observed orders between errors on grids that double."""
    size = np.abs(np.asarray(errors))
    out: Array = np.log2(size[:-1] / size[1:])
    return out
