"""Loops of leaves with friction at contact points, exactly: an arc leaf on a flat, and two leaves joined at their tips.

The leaves are petals of a pack in which a gap closes at one place only, at the end of its curve. They lie on the
bushing there, or the first lies on the second. Pressures and tip forces stand in for the film.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.equilibrium.point_friction_path import RubbingPoints, slide_at_points
from petalfoil.equilibrium.run_context import running
from petalfoil.mesh import hermite
from petalfoil.physics.gap_curves import ContactPoints, Facing
from petalfoil.physics.petal_sliding import Faces
from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.pack_at_points import THICK, PackAtPoints
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.walls.element_pack import ElementPack
from tests.cases import case
from tests.verification.sliding_helpers import HalfArch

Array = NDArray[np.float64]

OPEN = 1e3
"""Gaps that never close [1]."""
FLAT = 1e8
"""Bend radius of a leaf that is straight, in lengths."""


@dataclass(frozen=True)
class LoadedLeaves(PackAtPoints):
    """The pack with gaps and loads of its own.

    Attributes
    ----------
    pressed : (n_wall,) array
        Generalised forces on the petals [1].
    rest : (2 n_node,) array
        Nodal (value, slope) of the gaps of undeflected petals [1].
    """

    pressed: Array = field(default_factory=lambda: np.zeros(0))
    rest: Array = field(default_factory=lambda: np.zeros(0))

    @cached_property
    def nodal_gaps(self) -> Array:
        """Of the rest given."""
        gaps: Array = self.rest + self.whole.curves.by_w @ self.state.w
        return gaps

    @cached_property
    def residual(self) -> tuple[Array, Array, Array, Array]:
        """With the forces given."""
        wall, film, value, slope = super().residual
        return wall - self.pressed, film, value, slope


@dataclass(frozen=True)
class StackedPack(ElementPack):
    """A pack whose petals have their roots one above another, and face each other along all of their length."""

    @property
    def nodes(self) -> dict[Facing, slice]:
        """The whole petal toward the one below."""
        return {**super().nodes, Facing.PETAL: slice(0, len(self.elements.phi))}


@dataclass(frozen=True)
class Leaves:
    """Petals that touch at the ends of some curves, in units in which `size`, `D` and the bearing's length are 1.

    Attributes
    ----------
    problem, whole
        What the equations are made of.
    touching : (k,) int array
        Curves whose gap closes at their end.
    gap : float
        This gap, undeflected.
    size : float
        Radius of an arc, length of a straight leaf [m].
    unit : float
        Unit of displacements over the reference length of the pack [1].
    """

    problem: CoupledProblem
    whole: PointLayout
    touching: NDArray[np.intp]
    gap: float
    size: float
    unit: float = 10.0

    @property
    def force(self) -> float:
        """Unit of forces that bend by one unit of displacements, over that of the pack [1]."""
        one, scales = self.whole.pack.elements, self.problem.layout.scales
        rigid = one.rigidity * one.length * scales.length / scales.force
        return float(self.unit * rigid / self.size**3)

    @property
    def rest(self) -> Array:
        """Nodal gaps: open, and falling toward the end of the curves that close."""
        curves, phi = self.whole.curves, self.whole.pack.elements.phi
        rest = np.zeros(len(curves.rest))
        rest[0::2] = OPEN
        for curve in self.touching:
            nodes = np.arange(curves.elements[curve] + 1)
            at = 2 * (curves.first[curve] + nodes)
            rest[at], rest[at + 1] = self.unit * (self.gap + phi[nodes[-1]] - phi[nodes]), -self.unit
        return rest

    def led(self, mu: float, loads: list[Array]) -> list[RubbingPoints]:
        """States under one load after another, the first without friction."""
        whole, curves = self.whole, self.whole.curves
        place = curves.elements[self.touching].astype(np.float64)
        points = ContactPoints(self.touching, place, 0 * self.touching, np.ones(len(place)))
        state = PointState(np.zeros(whole.n_wall), np.ones(whole.n_film), points)
        thick = np.full(self.problem.layout.wall.film.shape, THICK)
        start = LoadedLeaves(whole, self.problem, state, thick, np.zeros(len(place)), 0.0, loads[0], self.rest)
        with running() as run:
            begun = slide_at_points(start, None, run.pack_solver)
            assert begun is not None
            states = [begun]
            for load in loads[1:]:
                ahead = replace(states[-1].equations, pressed=load)
                found = slide_at_points(ahead, states[-1].law(mu), run.pack_solver)
                assert found is not None
                assert found.residual < 1e-8
                assert_allclose(found.state.points.every_position, place, rtol=0.0, atol=1e-12)
                states.append(found)
        return states

    def lost(self, states: list[RubbingPoints]) -> float:
        """Energy lost on the way to some states, by each of the contacts, in the units of the leaves."""
        return sum(state.lost for state in states) / len(self.touching) / (self.force * self.unit)


def problem_of(cells: int) -> CoupledProblem:
    """A pack of eight clamped petals at rest."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": cells, "surface.petal_friction": 0.1})
    return build_problem(bearing).at(bearing_number=0.0)


def to_and_fro(low: float, high: float, steps: int) -> Array:
    """Two cycles from `low`, each there and back in so many steps."""
    return np.concatenate([[low], *[np.linspace(a, b, steps + 1)[1:] for a, b in ((low, high), (high, low)) * 2]])


# ------------------------------------------------------------------------------------------ a leaf on a flat

SLENDER, GAP, LOW, HIGH = 230.0, 0.003, 1.0, 2.0
"""Radius over thickness, gap of the tip in `q R^4 / D`, pressures of the cycle in `q`."""
STEPS = 24
"""From one end of a cycle to the other."""


def on_the_bushing(cells: int) -> tuple[Leaves, Array, HalfArch]:
    """Eight arc leaves before the bushing, of which a pitch is pressed; forces of a unit pressure; the same leaf."""
    problem = problem_of(cells)
    assert problem.layout.elements is not None
    pack = problem.layout.elements.pack
    one, count = pack.elements, pack.mesh.count
    R, every = one.metric_radius, np.ones(count)
    faces = Faces(0.0 * every, R * every, R * every, 12.0 * one.rigidity * SLENDER**2 / R**2 * every)
    petal = replace(one, bend_radius=R, clamped=True)
    pack = replace(pack, petals=(petal,) * count, faces=faces)
    leaves = Leaves(problem, PointLayout(pack, problem.layout), np.arange(count, 2 * count), GAP, R)
    area = hermite.integrals(np.array([pack.per_pitch - 1]), np.ones(1), petal.element_angle)[0]
    pressure = leaves.force * np.tile(petal.nodal.T @ area, count)
    return leaves, pressure, HalfArch(float(petal.phi[pack.per_pitch]), SLENDER, 64)


@pytest.mark.slow
@pytest.mark.parametrize("cells", [12, 24])
def test_loop_of_an_arc_leaf_on_its_tip(cells: int) -> None:
    """Slip, stick, slip back, stick in closed form: within 1e-5, on any grid; and it is `mu N` times the slip."""
    mu = 0.2
    leaves, pressure, arch = on_the_bushing(cells)
    states = leaves.led(mu, [q * pressure for q in to_and_fro(LOW, HIGH, STEPS)])
    cycle = range(2 * STEPS + 1, 4 * STEPS + 1)
    lost = leaves.lost([states[number] for number in cycle])
    assert lost == pytest.approx(arch.loss(mu, GAP, (LOW, HIGH)), rel=1e-5)
    of_slips = 0.0
    for number in cycle:
        mean = 0.5 * (states[number].state.points.reaction + states[number - 1].state.points.reaction)
        of_slips += mu * float(mean @ np.abs(states[number].friction.slip))
    assert of_slips == pytest.approx(sum(states[number].lost for number in cycle), rel=1e-9)


@pytest.mark.slow
def test_an_arc_leaf_whose_tip_sticks_loses_nothing() -> None:
    """Friction past which the tip holds: what it lost is none of what it loses where it slips."""
    leaves, pressure, arch = on_the_bushing(12)
    states = leaves.led(20.0, [q * pressure for q in (LOW, 1.3, 1.6, HIGH, 1.5, LOW)])
    assert leaves.lost(states) < 1e-9 * arch.loss(0.2, GAP, (LOW, HIGH))
    assert np.max(np.abs([state.friction.slip for state in states])) < 1e-9 * leaves.unit


# ------------------------------------------------------------------------------------------ two leaves

THICKNESS, PRESS, MU = 0.05, 1.0, 0.5
"""Thickness over length, pressure in `D / l^3`, friction."""
C = MU * 0.375 * PRESS
"""Limit of friction: the tip carries 3/8 of a pressure that presses two leaves together."""


def two_leaves() -> tuple[Leaves, Array, Array]:
    """Two straight leaves of length 1 that touch at their tips; forces that press them together; unit tip force.

    The tip force is shared by both, outward.
    """
    problem = problem_of(12)
    assert problem.layout.elements is not None
    pack = problem.layout.elements.pack
    one, count = pack.elements, pack.mesh.count
    R = 1.0 / float(one.phi[-1])
    petal, every = replace(one, metric_radius=R, bend_radius=FLAT, clamped=True), np.ones(count)
    thickness = 0.5 * THICKNESS * every
    faces = Faces(thickness, R * every, FLAT * every, 12.0 * one.rigidity / THICKNESS**2 * every)
    stacked = StackedPack((petal,) * count, pack.mesh, pack.wall, pack.per_pitch, faces)
    leaves = Leaves(problem, PointLayout(stacked, problem.layout), np.array([2 * count]), 0.0, 1.0)
    force, n = leaves.force, petal.nodal.shape[1]
    area = petal.nodal.T @ hermite.integrals(np.array([len(petal.phi) - 2]), np.ones(1), petal.element_angle)[0]
    press, tip = np.zeros(count * n), np.zeros(count * n)
    press[:n], press[n : 2 * n] = force * PRESS * R * area, -force * PRESS * R * area
    tip[[n - 2, 2 * n - 2]] = 0.5 * force
    return leaves, press, tip


def tip_of(leaves: Leaves, states: list[RubbingPoints]) -> Array:
    """Mean deflection of both tips in the units of the leaves."""
    n = leaves.whole.n_wall // leaves.whole.pack.mesh.count
    return np.array([0.5 * (state.state.w[n - 2] + state.state.w[2 * n - 2]) for state in states]) / leaves.unit


@pytest.mark.slow
def test_loop_of_two_leaves_joined_at_their_tips() -> None:
    """They stick up to `F = 8/3 c delta`, then slip against `c`: the loop of a frame of two bars, exactly.

    Tips deflect by `F/6 - c delta/4`; a cycle between `-+F` loses `c delta (F - 8/3 c delta)`.
    """
    leaves, press, tip = two_leaves()
    most = 6.0 * C * THICKNESS
    states = leaves.led(MU, [press + F * tip for F in (0.0, most, -most, most)])
    assert_allclose(tip_of(leaves, states[1:]), (most / 6.0 - C * THICKNESS / 4.0) * np.array([1, -1, 1]), rtol=1e-6)
    exact = C * THICKNESS * (most - 8.0 / 3.0 * C * THICKNESS)
    assert leaves.lost(states[2:]) == pytest.approx(exact, rel=1e-6)


@pytest.mark.slow
def test_two_leaves_that_stick_at_their_tips_lose_nothing() -> None:
    """Below `F = 8/3 c delta` they are the frame: `F (1/6 - 3/32)` at the tip."""
    leaves, press, tip = two_leaves()
    F = 2.0 * C * THICKNESS
    states = leaves.led(MU, [press + q * tip for q in (0.0, F, -F, F)])
    assert_allclose(tip_of(leaves, states[1:]), F * (1.0 / 6.0 - 3.0 / 32.0) * np.array([1, -1, 1]), rtol=1e-6)
    assert leaves.lost(states) < 1e-9 * C * THICKNESS * F
