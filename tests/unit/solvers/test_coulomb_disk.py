"""Coulomb friction in a plane as a dense problem: against the law, against one line, and Newton's step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.coulomb import ContactForces, ContactSpace, KnownForces, States, contact_forces, of_states
from petalfoil.solvers.coulomb_disk import SlipLines, disk_forces, known_from, slip_resistance

Array = NDArray[np.float64]


def random_contacts(rng: np.random.Generator, m: int, mu: float) -> tuple[ContactSpace, tuple[Array, Array]]:
    """Contacts of an elastic body, all open: gaps and slips by reactions and friction forces, and without any."""
    A = rng.standard_normal((3 * m, 3 * m))
    E = A @ A.T / m + 0.3 * np.eye(3 * m)
    gap, slip = np.hstack([E[:m, :m], -E[:m, m:]]), np.hstack([E[m:, :m], -E[m:, m:]])  # friction is against the slip
    start = rng.uniform(-2.0, 1.0, m), rng.uniform(-0.6, 0.6, 2 * m)
    return ContactSpace(np.zeros(m, dtype=bool), gap, slip, np.arange(m), mu, (np.ones(m), np.zeros(m))), start


def untouched(space: ContactSpace) -> KnownForces:
    """Nothing touches."""
    m, f = len(space.held), len(space.rubs)
    states = States(np.zeros(m, dtype=bool), np.zeros(f, dtype=np.intp))
    return KnownForces(states, np.ones(m), np.zeros(m), np.zeros(2 * f), np.zeros(2 * f))


def assert_solves(space: ContactSpace, start: tuple[Array, Array], found: ContactForces) -> None:
    """(K4) and (M11) themselves; friction takes energy."""
    z = np.concatenate([found.unknown, found.friction])
    gap, slip = space.answer @ z + start[0], (space.slip @ z + start[1]).reshape(2, -1)
    lam, T, size = found.unknown, found.friction.reshape(2, -1), np.linalg.norm(slip, axis=0)
    assert np.all(gap > -1e-9)
    assert np.all(lam > -1e-9)
    assert_allclose(lam * gap, 0.0, atol=1e-9)
    assert np.all(np.linalg.norm(T, axis=0) <= space.coefficient * lam + 1e-9)
    assert_allclose(T * size, space.coefficient * lam * slip, atol=1e-8)
    assert np.all(np.sum(T * slip, axis=0) > -1e-9)


@pytest.mark.parametrize(("m", "mu"), [(6, 0.5), (20, 0.2), (20, 0.5), (60, 0.3)])
def test_many_contacts_from_none(m: int, mu: float) -> None:
    rng = np.random.default_rng(5)
    slipping = sticking = 0
    for _ in range(5):
        space, start = random_contacts(rng, m, mu)
        found = disk_forces(space, start, untouched(space))
        assert found is not None
        assert_solves(space, start, found)
        slipping += np.count_nonzero(found.states.slips)
        sticking += np.count_nonzero(found.states.closed & (found.states.slips == 0))
    assert slipping > 0
    assert sticking > 0


def test_other_axes_give_the_same_forces() -> None:
    """A law of a disk has no axes, as two laws of lines would: turned by an angle each, forces turn along."""
    rng = np.random.default_rng(11)
    space, start = random_contacts(rng, 12, 0.3)
    angle = rng.uniform(0.0, 2.0 * np.pi, 12)
    axes = SlipLines(np.stack([np.cos(angle), np.sin(angle)]), space.across)
    other = disk_forces(axes.seen(space), (start[0], axes.turned(start[1])), untouched(space))
    one = disk_forces(space, start, untouched(space))
    assert one is not None
    assert other is not None
    assert_allclose(axes.back(other.friction), one.friction, atol=1e-8)
    assert_allclose(other.unknown, one.unknown, atol=1e-8)


def test_contacts_that_nothing_moves_across_have_the_law_of_a_line() -> None:
    """As in a plane of symmetry: no force across, and that along is of (M6)."""
    space, start = random_contacts(np.random.default_rng(3), 8, 0.3)
    still = space.slip.copy()
    still[8:], still[:, 16:] = 0.0, 0.0
    answer = space.answer.copy()
    answer[:, 16:] = 0.0
    plane = replace(space, slip=still, answer=answer)
    constant = start[0], np.concatenate([start[1][:8], np.zeros(8)])
    found = disk_forces(plane, constant, untouched(plane))
    line = ContactSpace(space.held, space.answer[:, :16], space.slip[:8, :16], space.rubs, 0.3)
    begin = KnownForces(untouched(plane).states, np.ones(8), np.zeros(8), np.zeros(8), np.zeros(8))
    expected = contact_forces(line, (start[0], start[1][:8]), begin)
    assert found is not None
    assert expected is not None
    assert_allclose(found.friction[:8], expected.friction, atol=1e-9)
    assert_allclose(found.friction[8:], 0.0, atol=1e-12)
    assert_allclose(found.unknown, expected.unknown, atol=1e-9)


def test_newtons_lines_are_the_tangent_of_the_disk() -> None:
    """Along its step the residual `T - P(y)` of contacts that slip falls as one minus the length, but for squares."""
    space, start = random_contacts(np.random.default_rng(7), 6, 0.2)
    start = start[0] - 3.0, start[1]
    rho, z0 = slip_resistance(space), np.concatenate([np.full(6, 2.0), 0.1 * np.arange(12.0)])

    def law(z: Array) -> tuple[Array, Array, Array]:
        """Residuals of gaps and of the disk, `y`, and limits."""
        slip = (space.slip @ z + start[1]).reshape(2, -1)
        y, limit = z[6:].reshape(2, -1) + rho * slip, space.coefficient * z[:6]
        off = z[6:].reshape(2, -1) - limit * y / np.linalg.norm(y, axis=0)
        return np.concatenate([space.answer @ z + start[0], off.ravel()]), y, limit

    left, y, limit = law(z0)
    assert np.all(np.linalg.norm(y, axis=0) > limit)
    lines = SlipLines.along(y, limit, rho)
    slides = States(np.ones(6, dtype=bool), np.ones(6, dtype=np.intp))
    found = of_states(lines.seen(space), (start[0], lines.turned(start[1])), slides)
    assert found is not None
    step = np.concatenate([found.unknown, lines.back(found.friction)]) - z0
    lengths = 2.0 ** -np.arange(6, 12)
    remainder = [np.linalg.norm(law(z0 + t * step)[0] - (1.0 - t) * left) for t in lengths.tolist()]
    assert_allclose(np.log2(np.divide(remainder[:-1], remainder[1:])), 2.0, rtol=0.0, atol=0.05)


def test_forces_that_move_nothing_stay_as_known() -> None:
    """Two contacts whose forces are one to the body: it moves as if they were one, and what they do apart stays."""
    rng, mu, twice = np.random.default_rng(8), 0.5, 0
    for _ in range(20):
        space, start = random_contacts(rng, 10, mu)
        twins = np.array([0, 1])
        for part in (space.answer, space.slip):
            part[:, 10 + 10 + twins] = part[:, 10 + 10 + twins].mean(axis=1, keepdims=True)
        space.slip[10 + twins] = space.slip[10 + twins].mean(axis=0)
        start[0][twins], start[1][twins], start[1][10 + twins] = -2.0, 0.0, 0.0
        first = disk_forces(space, start, untouched(space))
        assert first is not None
        assert_solves(space, start, first)
        if not np.all(first.states.closed[twins] & (first.states.slips[twins] == 0)):
            continue
        T = first.friction.reshape(2, -1)
        limit = mu * first.reaction(space)[space.rubs]
        left = np.sqrt(limit[twins] ** 2 - T[0, twins] ** 2) - np.abs(T[1, twins])
        apart = 0.5 * float(np.min(left)) * np.array([1.0, -1.0])
        known = known_from(space, first)
        known.friction[10 + twins] += apart
        again = disk_forces(space, start, known)
        assert again is not None
        assert_solves(space, start, again)
        assert_allclose(again.friction, known.friction, atol=1e-6)  # rounding over `GIVE`
        twice += 1
    assert twice > 2
