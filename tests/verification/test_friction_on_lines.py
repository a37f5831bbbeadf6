"""Friction of small motions in 3-D at contact lines between nodes: slips, whole solutions, damping that converges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic_and_sliding, impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.case import Case
from petalfoil.dynamics.harmonic_balance import FrictionCycle, SlidingContacts
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import ON_LINES, Motion
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import friction_of, friction_on_lines, friction_tangent, slips
from tests.cases import case

Array = NDArray[np.float64]


def rubbing(**changes: object) -> Case:
    """Eight petals of the paper in 3-D with friction under 20 N, on a coarse grid."""
    coarse = {"model.cells_per_pitch": 16, "model.axial_cells": 4, "surface.petal_friction": 0.3}
    loaded = {"petals.theory": "shell", "operation.load": (0.0, -20.0), "operation.eccentricity": (0.0, 0.0)}
    return case("paper_n8_spatial", **{**coarse, **loaded, **changes})


def about(of: Case) -> tuple[LineContacts, Friction, Motion, SlidingContacts]:
    """The equilibrium with contact lines, its friction at nodes, small motions about it and what slides."""
    with running():
        answer = operating_point(of, None).answer
        motion, sliding = elastic_and_sliding(of, answer)
    friction = friction_of(of, answer.problem.layout)
    assert isinstance(answer.lines, LineContacts)
    assert friction is not None
    assert sliding is not None
    assert motion.contact_model == ON_LINES
    return answer.lines, friction, motion, sliding


@pytest.mark.slow
def test_slips_between_nodes_are_interpolated_and_those_at_nodes_are_theirs() -> None:
    lines, friction, _, _ = about(rubbing())
    x = np.random.default_rng(5).standard_normal(len(lines.x))
    first, k = lines.problem.layout.wall.contacts.bushing.start, friction.slip.shape[0] // 2
    nodal = np.zeros((2, len(lines.held)))
    nodal[:, first:] = slips(friction, x).reshape(2, k)  # every gap on bushing and petals has its own slip
    held = np.flatnonzero(lines.held)
    at = slips(friction_on_lines(friction, lines.held, lines.points), x).reshape(2, -1)
    assert_allclose(at[:, : len(held)], nodal[:, held], rtol=0.0, atol=1e-12)
    assert_allclose(at[:, len(held) :], nodal @ lines.points.value.T, rtol=0.0, atol=1e-12)
    near, far = lines.points.beside.T
    moved = replace(lines.points, phi=lines.points.phi + lines.points.to_nodes[1])  # onto the node that follows
    there = slips(friction_on_lines(friction, lines.held, moved), x).reshape(2, -1)[:, len(held) :]
    assert_allclose(there, nodal[:, far], rtol=0.0, atol=1e-9)
    assert not np.allclose(there, nodal[:, near])


@pytest.mark.slow
def test_a_cycle_solves_the_whole_system_and_sticking_is_its_limit() -> None:
    """Columns of one factor give what the system with the equivalent stiffness in its tangent gives."""
    of = rubbing()
    lines, _, motion, sliding = about(of)
    assert isinstance(motion, SmallMotion)
    with running():
        response = motion.frictionless.respond(0.7, LinearSolver())
        cycle = FrictionCycle(sliding, response, 10e-6 / lines.problem.layout.scales.length)
        slip = cycle.settled(slips(sliding.friction, response.units[:, 1]), cycle.compliance())
        stiffness, _ = sliding.equivalent(slip, cycle.amplitude)
        held = friction_tangent(sliding.friction, stiffness, len(lines.x))
        whole = replace(motion.frictionless, sticking=held).respond(0.7, LinearSolver())
        assert np.any(stiffness.imag > 0.0)
        assert_allclose(cycle.force_gradient()[1, 1], whole.force_gradient[1, 1], rtol=1e-8)
        small = FrictionCycle(sliding, response, 1e-12).force_gradient()
        stuck = motion.respond(0.7, LinearSolver()).force_gradient
    assert_allclose(np.diag(small), np.diag(stuck), rtol=1e-7)


@pytest.mark.slow
def test_hardly_any_friction_is_none() -> None:
    """Far beyond the slip that contacts stick within, the motion is that of frictionless lines."""
    of = rubbing(**{"surface.petal_friction": 1e-11})
    _, _, motion, _ = about(of)
    speed = of.operation.speed
    with running():
        free = impedance(motion.frictionless, speed, speed)
    far = coefficients(of, amplitude=10e-6)
    for name, entries in zip(("stiffness", "damping"), free, strict=True):
        found = far[name].values[0]
        assert_allclose(found, entries, rtol=0.0, atol=1e-6 * np.max(np.abs(entries)))


@pytest.mark.slow
def test_contacts_near_a_root_are_no_clamps() -> None:
    """The rig's petals lie on roots 1.2 cells from them, where two nodes that stick nearly doubled the damping."""
    rig = case("rig", **{"model.kind": "3d", "surface.petal_friction": 0.3, "operation.load": (0.0, -55.6)})
    of = rig.replace(**{"model.cells_per_pitch": 32, "model.axial_cells": 12})
    lines, _, _, _ = about(of)
    between = lines.points.lines[2]
    clamped = lines.held[between.number[:, 1:3]].all(axis=1) & ~lines.held[between.number[:, 0]]
    assert not clamped.any()
    near = (lines.points.kind == 2) & (lines.points.phi < between.phi[2])
    assert np.count_nonzero(near) > 50
    found = coefficients(of, load=(0.0, -55.6), amplitude="1 um")
    assert_allclose(np.diag(found.damping.values[0]), [319.6, 327.4], rtol=0.08)  # on 64 x 24 cells


@pytest.mark.long
@pytest.mark.parametrize("amplitude", ["1 um", "10 um", "50 um"])
def test_damping_of_the_rig_converges(amplitude: str) -> None:
    """The default grid against one half as fine again, within 4 %; contacts at nodes miss the finer one by 11 %."""
    rig = case("rig", **{"model.kind": "3d", "surface.petal_friction": 0.3})
    C = []
    for cells, stations in ((64, 24), (96, 36)):
        of = rig.replace(**{"model.cells_per_pitch": cells, "model.axial_cells": stations})
        found = coefficients(of, load=(0.0, -55.6), amplitude=amplitude)
        assert found["contact_model"] == ON_LINES
        C.append(np.diag(found.damping.values[0]))
    assert_allclose(C[0], C[1], rtol=0.04)
