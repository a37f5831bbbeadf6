"""Half of an arch whose foot stands on a frictional flat, followed along paths of pressure with Coulomb's law exactly.

Its crown does not turn and sinks by `D`; the foot is `up` above where it was seen from the crown, so that the gap below
it is `up - D`. A pressure does the work of the area that the arch sweeps. Closed forms by `U = (R/D) int M^2 dx`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.coulomb_path import slide_exactly
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.petal_sliding import face_compliance
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState
from tests.verification.shell_helpers import UNIT, ElasticProblem
from tests.verification.sliding_helpers import HalfArch, mid_surface
from tests.verification.test_sliding_petals import HELD_AREA, numbers

Array = NDArray[np.float64]

ELEMENTS = 32
MU, LOW = 0.2, 0.5
"""Friction, and the pressure to which a cycle from 1 goes back."""
STICKS = 50.0
"""Friction with which no foot slips."""
FIRST = 0.01
"""Pressure at which paths begin, without friction."""


@dataclass(frozen=True)
class StandingArch:
    """The arch, whose unknowns are those of its bending, its stretch at the foot, if any, and `D`.

    The value of `w` at the foot is replaced by `up`: gaps are differences of two unknowns.
    """

    arch: HalfArch
    stretches: bool

    @cached_property
    def rows(self) -> tuple[Array, Array, Array]:
        """(up, out, area swept) of bending and stretch."""
        (W, V, area), c, s = self.arch.rows, math.cos(self.arch.t0), math.sin(self.arch.t0)
        W, V, area = (np.append(row, one) for row, one in zip((W, V, area), (0.0, 1.0, 0.0), strict=True))
        used = slice(None) if self.stretches else slice(-1)
        return (c * W - s * V)[used], (s * W + c * V)[used], -area[used]

    @cached_property
    def stiffness(self) -> Array:
        """Of bending and stretch."""
        bending = self.arch.petal.stiffness.toarray()
        if not self.stretches:
            return np.asarray(bending)
        faces, angle = mid_surface(self.arch.membrane), self.arch.petal.element_angle
        give = face_compliance(faces, self.arch.foot, angle, 1.0)[0, 0]
        return np.asarray(sp.block_diag([bending, 1.0 / give]).toarray())

    @property
    def foot(self) -> int:
        """Number of the value of `w` at the foot: the last but its slope."""
        return self.arch.petal.stiffness.shape[0] - 2

    @cached_property
    def basis(self) -> Array:
        """Bending and stretch by the unknowns."""
        up = self.rows[0]
        basis = np.eye(len(up))
        basis[self.foot] = -up / up[self.foot]
        basis[self.foot, self.foot] = 1.0 / up[self.foot]
        return basis

    @property
    def swept(self) -> Array:
        """The area by the unknowns."""
        return np.append(self.rows[2] @ self.basis, math.sin(self.arch.t0))

    def under(self, q: float) -> ElasticProblem:
        """The problem under a pressure."""
        n = len(self.swept)
        K = np.zeros((n, n))
        K[:-1, :-1] = self.basis.T @ self.stiffness @ self.basis
        G = sp.csr_array(([1.0, -1.0], ([0, 0], [self.foot, n - 1])), shape=(1, n))
        return ElasticProblem(sp.csr_array(UNIT * K), q * self.swept, G, np.zeros(1), np.ones(1))

    def friction(self, mu: float) -> Friction:
        """Between foot and flat."""
        out = sp.csr_array(np.append(self.rows[1] @ self.basis, 0.0)[None])
        return Friction(mu, np.zeros(1), out, sp.csr_array(np.eye(1)), 0.0, exact=True)

    def led(self, mu: float, pressures: list[float]) -> list[FrictionResult]:
        """States along a path that begins without friction."""
        first, law = self.under(pressures[0]), self.friction(mu)
        found, outcome = solve_contacts(
            first, (np.zeros(first.n), np.ones(1, dtype=bool)), LinearSolver(), ContactOptions(tangents=40)
        )
        assert found is not None, outcome
        fresh = FrictionState.fresh(law, found.x, found.lam)
        states = [FrictionResult(found.x, found.lam, found.active, found.state.residual, fresh, 0.0)]
        for q in pressures[1:]:
            slid = slide_exactly(self.under(q), law, states[-1], [np.zeros((1, 1), dtype=np.intp)], LinearSolver())
            assert slid is not None
            assert slid.residual < 1e-8
            assert slid.lam[0] == pytest.approx(q * math.sin(self.arch.t0), rel=1e-8)
            states.append(slid)
        return states

    def areas(self, states: list[FrictionResult]) -> Array:
        """Areas swept."""
        return np.array([UNIT * float(self.swept @ state.x) for state in states])


LEAVES, HELD = (numbers(f"{name}.csv") for name in ("r4b_arc_leaf_on_flat", "r6b_held_arch"))
LOADED, UNLOADED = "sliding mu=0.2 loading", "unloading"


@pytest.mark.parametrize("row", LEAVES, ids=lambda row: f"{row['t0']}")
def test_an_arc_leaf_along_a_path_of_pressure(row: dict[str, float]) -> None:
    """Free, sliding both ways, held, and the loop with its energy: five digits on 32 elements."""
    leaf = StandingArch(HalfArch(row["t0"], row["R/t"], ELEMENTS), stretches=False)
    free = leaf.areas(leaf.led(0.0, [FIRST, 1.0]))[-1]
    assert free == pytest.approx(row["swept half area*D/(q R^5): free (=a)"], rel=1e-5)
    held = leaf.areas(leaf.led(STICKS, [FIRST, 0.4, 1.0]))
    assert abs(held[-1] - held[0]) < 1e-7 * free
    back, forth = row[LOADED] / row[UNLOADED], LOW * row[UNLOADED] / row[LOADED]
    pressures = [FIRST, 0.3, 1.0, back, 0.5 * (back + LOW), LOW, forth, 1.0]
    states = leaf.led(MU, pressures)
    area, q = leaf.areas(states), np.array(pressures)
    assert area[[1, 2, 7]] / q[[1, 2, 7]] == pytest.approx(row[LOADED], rel=1e-5)
    assert area[[4, 5]] / q[[4, 5]] == pytest.approx(row[UNLOADED], rel=1e-5)
    cycle = slice(2, 7)
    around = 0.5 * abs(float(q[cycle] @ np.roll(area[cycle], -1) - area[cycle] @ np.roll(q[cycle], -1)))
    loop = 0.5 * row["loop area*D/(q2^2 R^5) mu=0.2 q1=0.5 q2"]  # of half the arch
    assert around == pytest.approx(loop, rel=1e-5)
    assert UNIT * sum(state.lost for state in states[3:]) == pytest.approx(loop, rel=1e-5)


@pytest.mark.parametrize("row", HELD, ids=lambda row: f"{row['t0']}-{row['R/t']:g}")
def test_a_held_arch_along_a_path_of_pressure(row: dict[str, float]) -> None:
    """A foot that sticks: the membrane carries the pressure, within 0.5 % on 32 elements, and nothing is lost."""
    arch = StandingArch(HalfArch(row["t0"], row["R/t"], ELEMENTS), stretches=True)
    states = arch.led(STICKS, [FIRST, 0.6, 1.0, 0.3])
    area, q = arch.areas(states), np.array([FIRST, 0.6, 1.0, 0.3])
    assert np.diff(area) / np.diff(q) == pytest.approx(row[HELD_AREA], rel=5e-3)
    assert UNIT * sum(abs(state.lost) for state in states) < 1e-9 * area[2]  # the work of a pressure of 1
    free = arch.areas(arch.led(0.0, [FIRST, 1.0]))[-1]
    assert free == pytest.approx(row["free-sliding (bending)"], rel=5e-3)
