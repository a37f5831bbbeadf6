"""Friction between petals whose contacts are pressures over asperities: points at which it acts (K18)."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic_and_sliding, impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.case import Case
from petalfoil.dynamics.harmonic_balance import FrictionCycle, SlidingContacts
from petalfoil.equilibrium.asperity_contacts import AsperityContacts
from petalfoil.equilibrium.element_response import ElementMotion
from petalfoil.equilibrium.run_context import current_run, running
from petalfoil.physics.asperity_contact import ContactSamples
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.system.friction import friction_at_points, friction_of
from petalfoil.system.point_layout import PointLayout
from tests.random_packs import random_case
from tests.verification.test_contact_slopes import apart

Array = NDArray[np.float64]

MU = 0.1
WHOLE = 8
"""Points of equal parts of an element that stand for all its samples: with 16 stiffness changes by 6e-4."""


def rubbing(number: int) -> Case:
    """A random pack, petals rub."""
    return random_case(np.random.default_rng(number), **{"model.cells_per_pitch": 16, "surface.petal_friction": MU})


@cache
def found_of(number: int) -> AsperityContacts:
    """Its equilibrium over asperities."""
    with running():
        found = operating_point(rubbing(number), None).answer.elements
    assert isinstance(found, AsperityContacts)
    return found


def in_parts(samples: ContactSamples, pressure: Array, count: int) -> ContactPoints:
    """A point for each of `count` equal parts of every element, at the centroid of its reactions."""
    reaction = samples.weight * pressure
    force = reaction.reshape(len(reaction), count, -1).sum(axis=2)
    moment = (reaction * samples.place).reshape(len(reaction), count, -1).sum(axis=2)
    element, part = np.nonzero(force > 1e-12 * force.sum())
    curve = samples.curve[element]
    position = (
        samples.element[element] - samples.curves.first[curve] + (moment / np.maximum(force, 1e-300))[element, part]
    )
    order = np.lexsort((position, curve))
    return separate_points(curve[order], position[order], force[element, part][order])


def separate_points(curve: NDArray[np.intp], position: Array, reaction: Array) -> ContactPoints:
    """Contacts, each by itself."""
    return ContactPoints(curve, position, np.zeros(len(curve), dtype=np.intp), reaction)


def sliding_at(number: int, points: ContactPoints) -> SlidingContacts:
    """Contacts that slide at some points."""
    found = found_of(number)
    layout = found.equations.problem.layout
    friction = friction_of(rubbing(number), layout)
    assert friction is not None
    whole = PointLayout(found.pack, layout)
    return SlidingContacts.at(friction_at_points(friction, whole, points), points.reaction)


def stuck(number: int, sliding: SlidingContacts) -> tuple[Array, Array]:
    """Stiffness and damping where all contacts stick, at the frequency of the speed."""
    speed = rubbing(number).operation.speed
    with running():
        return impedance(ElementMotion(found_of(number), sliding.friction), speed, speed)


def in_a_cycle(number: int, sliding: SlidingContacts, amplitude: float) -> tuple[Array, Array]:
    """The same in a whirl of an amplitude [m], by one harmonic."""
    motion = ElementMotion(found_of(number))
    with running():
        response = motion.growing(1j, current_run().probe_solver)
        scales = motion.problem.layout.scales
        gradient = FrictionCycle(sliding, response, amplitude / scales.length).force_gradient()
    Z = -gradient * scales.force / scales.length
    return Z.real, Z.imag / rubbing(number).operation.speed


@pytest.mark.slow
@pytest.mark.parametrize(("number", "one", "two"), [(0, (1e-2, 1e-2), (1e-3, 1e-3)), (2, (1e-2, 6e-2), (2e-3, 1e-2))])
def test_stiffness_and_damping_where_petals_stick(
    number: int, one: tuple[float, float], two: tuple[float, float]
) -> None:
    """Against eight points for each element: two are right to 0.2 and 1 %, one to 1.4 and 7 %."""
    equations = found_of(number).equations
    every = stuck(number, sliding_at(number, in_parts(equations.samples, equations.pressure, WHOLE)))
    several = stuck(number, sliding_at(number, equations.friction_points))
    alone = stuck(number, sliding_at(number, equations.points))
    assert all(apart(a, b) >= least for a, b, least in zip(alone, every, one, strict=True))
    assert all(apart(a, b) <= most for a, b, most in zip(several, every, two, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize(("amplitude", "one", "two"), [(1e-6, 0.15, 0.02), (1e-5, 3e-3, 1e-3)])
def test_damping_of_a_cycle(amplitude: float, one: float, two: float) -> None:
    """One point for each element misses 17 % of that of pack 0 at 1 um, where contacts begin to slip one by one."""
    equations = found_of(0).equations
    every, several, alone = (
        in_a_cycle(0, sliding_at(0, points), amplitude)[1]
        for points in (
            in_parts(equations.samples, equations.pressure, WHOLE),
            equations.friction_points,
            equations.points,
        )
    )
    assert apart(alone, every) >= one
    assert apart(several, every) <= two


@pytest.mark.slow
def test_less_than_twice_as_many_points() -> None:
    """For 65 and 53 elements with contact 103 and 80 points; resultant and moment of each element are kept."""
    for number in (0, 2):
        equations = found_of(number).equations
        points, elements = equations.friction_points, equations.points
        on_petals = [np.count_nonzero(one.curve >= equations.whole.pack.mesh.count) for one in (points, elements)]
        assert 1.2 * on_petals[1] <= on_petals[0] <= 1.7 * on_petals[1]
        assert_allclose(points.reaction.sum(), elements.reaction.sum(), rtol=1e-13)
        assert_allclose(points.reaction @ points.position, elements.reaction @ elements.position, rtol=1e-12)


@pytest.mark.slow
def test_points_at_one_place_rub_as_one() -> None:
    """Each of them divided into a third and two thirds at its place: stiffness and damping of stick and slip alike."""
    points = found_of(0).equations.friction_points
    curve, position = np.repeat(points.curve, 2), np.repeat(points.position, 2)
    divided = separate_points(curve, position, np.outer(points.reaction, [1.0 / 3.0, 2.0 / 3.0]).ravel())
    whole, parts = (sliding_at(0, each) for each in (points, divided))
    assert len(parts.limit) == 2 * len(whole.limit)
    for a, b in zip(stuck(0, whole), stuck(0, parts), strict=True):
        assert_allclose(b, a, rtol=1e-7)
    for a, b in zip(in_a_cycle(0, whole, 1e-6), in_a_cycle(0, parts, 1e-6), strict=True):
        assert_allclose(b, a, rtol=1e-6)


@pytest.mark.slow
def test_a_small_cycle_sticks() -> None:
    """Forces as unknowns of the tangent (E17) and slips by Newton's method (E11) give one stiffness and damping."""
    case = rubbing(2)
    with running():
        motion, sliding = elastic_and_sliding(case, operating_point(case, None).answer)
        K, C = impedance(motion, case.operation.speed, case.operation.speed)
    assert sliding is not None
    small = in_a_cycle(2, sliding, 1e-13)
    assert apart(small[0], K) <= 1e-8
    assert apart(small[1], C) <= 1e-6


@pytest.mark.slow
def test_slips_over_asperities_have_several_harmonics() -> None:
    """Pack 2 at 10 um: Newton's method is lost from slips that stick, and goes on from those of (E11).

    Damping is 0.8 and 0.9 of that with one harmonic, as with one point for each element.
    """
    found = coefficients(rubbing(2), amplitude="10 um")
    assert int(found["friction_harmonics"]) >= 8
    assert float(found["friction_harmonics_change"]) < 5e-3
    one = in_a_cycle(2, sliding_at(2, found_of(2).equations.friction_points), 1e-5)[1]
    assert_allclose(np.diag(found["damping"].values[0]) / np.diag(one), [0.807, 0.923], atol=0.01)
