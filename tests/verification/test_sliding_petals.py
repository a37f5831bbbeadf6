"""Petals that slide along themselves and stretch (M1)-(M3): arches and leaves whose slip is known, and thin limits."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic_and_sliding
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.solve import solve
from petalfoil.case import PetalTheory
from petalfoil.dynamics.harmonic_balance import FrictionCycle, SlidingContacts
from petalfoil.equilibrium.element_response import ElementMotion
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import DefinitionError
from petalfoil.mesh import hermite
from petalfoil.physics.petal_sliding import INNER, OUTER, FacePlaces, Faces, face_compliance, face_slip
from petalfoil.solvers.sparse_lu import LinearSolver
from tests.cases import case
from tests.verification.film_helpers import table
from tests.verification.sliding_helpers import HalfArch

Array = NDArray[np.float64]


def numbers(name: str) -> list[dict[str, float]]:
    """Rows of a reference table whose entries are numbers."""
    return [{key: float(value) for key, value in row.items() if key != "case" and value} for row in table(name)]


ELEMENTS = 64
"""Of a petal, where five digits are asked for."""


# ------------------------------------------------------------------------------------------ kinematics


def places(petal: int, angle: Array, side: float) -> FacePlaces:
    """All nodes of a petal, on one of its faces."""
    element, t = hermite.located(np.append(0.0, np.cumsum(angle)), np.append(0.0, np.cumsum(angle)))
    return FacePlaces(np.full(len(element), petal), element, t, np.full(len(element), side))


def hermite_of(phi: Array, W: Array, slope: Array) -> Array:
    """Nodal (value, slope) pairs, (2 n,)."""
    return np.stack([np.broadcast_to(W, phi.shape), np.broadcast_to(slope, phi.shape)], axis=-1).ravel()


def test_slip_of_a_petal_whose_tip_is_pressed_to_the_bushing() -> None:
    """`W = W1 (s/l)^2`: the mid-surface slips `l / 3 R` of it, the turning of the face gives a hundredth of that."""
    for row in numbers("r4a_kinematics.csv")[:2]:
        R, l, t = row["R_mm"], row["l_mm"], row["t_mm"]
        phi = np.linspace(0.0, l / R, ELEMENTS + 1)
        w = hermite_of(phi, (R * phi / l) ** 2, 2.0 * R**2 * phi / l**2)
        at = places(0, np.diff(phi), OUTER)
        one = np.ones(1)
        turning = Faces(0.5 * t * one, R * one, R * one, one, slides=False)
        sliding = Faces(1e-12 * one, R * one, R * one, one)
        assert (face_slip(turning, at, np.diff(phi)) @ w)[-1] == pytest.approx(
            row["slip by turning of faces/W1"], rel=1e-5
        )
        slip = (face_slip(sliding, at, np.diff(phi)) @ w)[-1]
        assert slip == pytest.approx(row["slip by mid-surface/W1"], rel=1e-5)


def test_slip_of_two_leaves_that_bend_alike() -> None:
    """The same `W1 sin^2(pi s / l)` at equal angles: what the upper leaf has slipped before the lower begins."""
    for row in numbers("r4a_kinematics.csv")[2:]:
        R, l, t, pitch = row["R_mm"], row["l_mm"], row["t_mm"], row["pitch_mm"]
        phi = np.linspace(0.0, l / R, ELEMENTS + 1)

        def field(s: Array, l: float = l, R: float = R) -> tuple[Array, Array]:
            return np.sin(np.pi * s / l) ** 2, R * np.pi / l * np.sin(2.0 * np.pi * s / l)

        two = np.ones(2)
        faces = Faces(1e-12 * two, R * two, R * two, two)
        upper, lower = hermite_of(phi, *field(R * phi)), hermite_of(phi, *field(R * phi + pitch))
        begin = pitch / R
        element, t_up = hermite.located(begin + phi[1:9], phi)
        outer = FacePlaces(np.zeros(8, dtype=int), element, t_up, np.full(8, OUTER))
        below, t_low = hermite.located(phi[1:9], phi)
        inner = FacePlaces(np.ones(8, dtype=int), below, t_low, np.full(8, INNER))
        slip = face_slip(faces, outer, np.diff(phi)) @ upper + face_slip(faces, inner, np.diff(phi)) @ lower
        assert_allclose(slip, row["slip by mid-surface/W1"], rtol=1e-5)
        turned = Faces(0.5 * t * two, R * two, R * two, two, slides=False)
        everywhere = face_slip(turned, places(0, np.diff(phi), OUTER), np.diff(phi)) @ upper
        assert 2.0 * np.max(everywhere) == pytest.approx(row["slip by turning of faces/W1"], rel=1e-5)


def test_a_turn_about_the_root_moves_a_petal_along_itself_without_stretch() -> None:
    """`W = sin(s/R)`, `V = cos(s/R) - 1`, and the faces move as parts of a rigid body."""
    R, half = 40.0, 0.5
    phi = np.linspace(0.0, 1.2, ELEMENTS + 1)
    one = np.ones(1)
    faces, w = Faces(half * one, R * one, R * one, one), hermite_of(phi, np.sin(phi), np.cos(phi))
    for side in (OUTER, INNER):
        slip = face_slip(faces, places(0, np.diff(phi), side), np.diff(phi)) @ w
        V = np.cos(phi) - 1.0
        u = V - side * half * (np.cos(phi) / R - V / R)
        assert_allclose(slip, -side * u, atol=1e-8)


def test_compliance_of_a_petal_that_is_pulled_at_two_places() -> None:
    """`V(s) = sum min(s, s_d) F_d / (B L)`: a bar."""
    faces = Faces(np.zeros(1), np.full(1, 2.0), np.full(1, 3.0), np.full(1, 5.0))
    at = FacePlaces(np.zeros(2, dtype=int), np.array([0, 3]), np.array([0.5, 1.0]), np.array([OUTER, INNER]))
    C = face_compliance(faces, at, np.full(4, 0.25), 7.0)
    s = np.array([0.25, 2.0])
    assert_allclose(C, np.array([[s[0], -s[0]], [-s[0], s[1]]]) / 35.0, rtol=1e-12)


# ------------------------------------------------------------------------------------------ arches


ARC_LEAVES, HELD, BUMPS = (
    numbers(f"{name}.csv") for name in ("r4b_arc_leaf_on_flat", "r6b_held_arch", "r3_link_spring")
)
THIN = 1e6
"""Slenderness of an arch whose stretch does not show in 6 digits of its bending."""


@pytest.mark.parametrize("row", ARC_LEAVES, ids=lambda row: f"{row['t0']}")
def test_an_arc_leaf_on_a_flat_under_pressure(row: dict[str, float]) -> None:
    """Slip, turn and swept area of the inextensible leaf to six digits; sliding both ways; held."""
    arch, mu = HalfArch(row["t0"], THIN, ELEMENTS), 0.2
    out, _, area, turn = arch.pressed()
    assert area == pytest.approx(row["swept half area*D/(q R^5): free (=a)"], rel=1e-6)
    assert out == pytest.approx(row["tip slip*D/(q R^4) frictionless (=b)"], rel=1e-6)
    assert turn == pytest.approx(row["tip turn*D/(q R^3)"], rel=1e-6)
    assert out / (0.5 / row["R/t"] * turn) == pytest.approx(row["slip/((t/2) turn)"], rel=1e-6)
    for friction, name in ((mu, "sliding mu=0.2 loading"), (-mu, "unloading")):
        assert arch.pressed(1.0, friction)[2] == pytest.approx(row[name], rel=1e-6)
    assert arch.pressed(1.0, row["sticks above mu"])[0] == pytest.approx(0.0, abs=1e-6 * out)
    assert 2.0 * loop_area(arch, mu) == pytest.approx(row["loop area*D/(q2^2 R^5) mu=0.2 q1=0.5 q2"], rel=1e-5)


def loop_area(arch: HalfArch, mu: float) -> float:
    """Area over pressure of a cycle between 0.5 and 1: slip, stick, slip back, stick; the stuck arch does not give."""
    loading, unloading = (arch.pressed(1.0, friction)[2] for friction in (mu, -mu))
    back, forth = loading / unloading, 0.5 * unloading / loading
    q = np.array([1.0, back, 0.5, forth])
    area = np.array([loading, loading, 0.5 * unloading, 0.5 * unloading])
    return 0.5 * abs(float(q @ np.roll(area, -1) - area @ np.roll(q, -1)))


@pytest.mark.parametrize("row", HELD, ids=lambda row: f"{row['t0']}-{row['R/t']:g}")
def test_a_held_arch_carries_pressure_by_its_membrane(row: dict[str, float]) -> None:
    """Within 0.01 % at every slenderness, on 32 elements; free feet let it bend as it is told."""
    arch = HalfArch(row["t0"], row["R/t"])
    V = math.sin(row["t0"])
    assert arch.held(V, 1.0)[2] == pytest.approx(row[HELD_AREA], rel=1e-4)
    assert arch.pressed()[2] == pytest.approx(row["free-sliding (bending)"], rel=3e-5)


HELD_AREA = "swept half area/(q R^5/D), held, frame with EA = 12 D/t^2"


@pytest.mark.parametrize("row", BUMPS, ids=lambda row: f"{row['t_m']}-{row['t0_rad']}")
def test_a_bump_under_a_line_load(row: dict[str, float]) -> None:
    """Stiffness on free, sliding and held feet; held, 0.1 % apart: (S2) leaves `(t/R)^2` out."""
    R = row["half_chord_m"] / math.sin(row["t0_rad"])
    arch, unit = HalfArch(row["t0_rad"], R / row["t_m"], ELEMENTS), 6.0 / math.sin(row["t0_rad"]) ** 3
    free, load = 1.0 / arch.under(0.5, 0.0, 0.0)[1], arch.under(0.5, 0.05, 0.0)[1]
    assert free / unit == pytest.approx(row["K_free/(6D/l^3)"], rel=2e-3)
    assert 1.0 / load / free == pytest.approx(row["K_load_mu0.1/K_free"], rel=1e-3)
    held = 1.0 / arch.held(0.5, 0.0)[1]
    assert held / unit == pytest.approx(row["K_held with membrane/(6D/l^3)"], rel=5e-3)


@pytest.mark.parametrize("t0", [0.5, 0.87])
def test_thin_petals_do_not_lock(t0: float) -> None:
    """Error of the held arch and of the free one's slip on 4 elements, `t/R` from 1e-2 to 1e-4: within a factor 2."""
    errors = []
    for slenderness in (1e2, 1e3, 1e4):
        coarse, fine = HalfArch(t0, slenderness, 4), HalfArch(t0, slenderness, 64)
        V = 1.2 * math.sin(t0)  # more than the pressure, so that the held arch bends too
        errors.append([coarse.held(V, 1.0)[1] / fine.held(V, 1.0)[1], coarse.pressed()[0] / fine.pressed()[0]])
    sizes = np.abs(np.array(errors) - 1.0)
    assert np.all(sizes.max(axis=0) < 2.0 * sizes.min(axis=0))
    assert np.all(sizes < 2e-3)


# ------------------------------------------------------------------------------------------ a bearing


@cache
def rubbing(**changes: object) -> tuple[ElementMotion, SlidingContacts]:
    """Eight petals under 20 N, with friction."""
    rubs = case("paper_n8", **{"surface.petal_friction": 0.3, "model.cells_per_pitch": 32, **changes})
    with running():
        motion, sliding = elastic_and_sliding(rubs, operating_point(rubs, (0.0, -20.0)).answer)
    assert isinstance(motion, ElementMotion)
    assert sliding is not None
    return motion, sliding


def test_petals_that_stick_are_as_stiff_as_their_membranes() -> None:
    """Friction forces as unknowns (E17), or eliminated: `J + B^T F^-1 B`. Ten times as stiff as without friction."""
    motion, sliding = rubbing()
    law, n = sliding.friction, motion.contacts.equations.n
    assert law.compliance is not None
    assert np.linalg.eigvalsh(law.compliance).min() > 0.0
    B = sp.hstack([law.slip, sp.csr_array((len(law.stiffness), n - law.slip.shape[1]))]).toarray()
    held = sp.csc_array(B.T @ np.linalg.solve(law.flexibility, B))
    units = spla.spsolve(motion.contacts.equations.steady + held, -motion.contacts.equations.forcing())
    stuck = motion.growing(0.0, LinearSolver()).force_gradient
    assert_allclose(motion.contacts.equations.force_rows @ units, stuck, atol=1e-6 * np.max(np.abs(stuck)))
    free = motion.frictionless.growing(0.0, LinearSolver()).force_gradient
    assert stuck[0, 0] < 10.0 * free[0, 0] < 0.0


def test_cycles_of_no_amplitude_stick() -> None:
    motion, sliding = rubbing()
    cycle = FrictionCycle(sliding, motion.frictionless.respond(0.7, LinearSolver()), 1e-9)
    stuck = motion.respond(0.7, LinearSolver()).force_gradient
    assert_allclose(cycle.force_gradient(), stuck, atol=1e-6 * np.max(np.abs(stuck)))


@pytest.mark.slow
def test_a_stiffer_membrane_holds_more_and_no_friction_holds_nothing() -> None:
    """`B L` of a hundredth: the stuck pack is softer; without friction both theories are one."""
    motion, sliding = rubbing()
    soft = replace(sliding.friction, compliance=100.0 * sliding.friction.compliance)
    softer = replace(motion, stuck=soft).growing(0.0, LinearSolver()).force_gradient
    stuck = motion.growing(0.0, LinearSolver()).force_gradient
    assert stuck[0, 0] < 2.0 * softer[0, 0]
    smooth = case("paper_n8", **{"model.cells_per_pitch": 16})
    shell, bent = (coefficients.record(smooth.replace(**{"petals.theory": name})) for name in ("shell", "inextensible"))
    assert_allclose(shell.fields["stiffness"], bent.fields["stiffness"], rtol=1e-12)


def test_where_petals_do_not_slide_is_said() -> None:
    """The paper's own method is refused with them; friction in 2-D slides unless it is told not to."""
    with pytest.raises(DefinitionError, match=r'petals\.theory: the paper.s petals do not stretch; allowed: "inext'):
        case("paper_n8_spatial", **{"petals.theory": "shell", "model.method": "classic"})
    with pytest.raises(DefinitionError, match=r"petals\.theory"):
        case("paper_n8", **{"petals.theory": "shel"})
    assert case("paper_n8_spatial", **{"surface.petal_friction": 0.3}).petal_theory is PetalTheory.INEXTENSIBLE
    assert case("paper_n8", **{"surface.petal_friction": 0.3}).petal_theory is PetalTheory.SHELL
    assert case("paper_n8").petal_theory is PetalTheory.INEXTENSIBLE
    in_3d = {"model.kind": "3d"}
    assert case("paper_n8", **in_3d).petal_theory is PetalTheory.SHELL
    assert case("paper_n8", **in_3d, **{"model.method": "classic"}).petal_theory is PetalTheory.INEXTENSIBLE
    assert case("backed_petals", **in_3d).petal_theory is PetalTheory.INEXTENSIBLE


@pytest.mark.slow
@pytest.mark.parametrize(("name", "load"), [("paper_n8", 20.0), ("rig", 55.6)])
def test_damping_converges(name: str, load: float) -> None:
    """At 1, 10 and 50 um within 1 % of a film twice as fine, and within 5 % where petals are twice as fine too."""
    cells = case(name).cells_per_pitch
    found = []
    for film, petals in ((cells, 32), (2 * cells, 32), (2 * cells, 64)):
        grid = {"model.cells_per_pitch": film, "model.petal_cells": petals}
        rubs = case(name, **{"surface.petal_friction": 0.3, **grid})
        whirls = [coefficients.record(rubs, load=(0.0, -load), amplitude=a) for a in (1e-6, 10e-6, 50e-6)]
        found.append(np.array([whirl.fields["damping"][0].diagonal() for whirl in whirls]))
    assert_allclose(found[1], found[0], rtol=1e-2)
    assert_allclose(found[2], found[0], rtol=5e-2)


def test_equilibria_are_those_without_friction() -> None:
    """A turning shaft is balanced without friction forces; tangential displacements as unknowns change nothing."""
    smooth = case("paper_n8", **{"model.cells_per_pitch": 12})
    with_V, without = solve.record(smooth.replace(**{"surface.petal_friction": 0.3})), solve.record(smooth)
    for name in ("bearing_force", "min_film_thickness", "max_bending_stress"):
        assert float(with_V.scalars[name]) == pytest.approx(float(without.scalars[name]), rel=1e-7)
    assert_allclose(with_V.fields["deflection"], without.fields["deflection"], atol=1e-12)
