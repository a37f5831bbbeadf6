"""Contact with Coulomb friction as a dense problem: against all combinations of states, and from far off."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.solvers.coulomb import (
    ContactForces,
    ContactSpace,
    KnownForces,
    States,
    contact_forces,
    led,
    of_states,
    wrong,
)

Array = NDArray[np.float64]


def random_contacts(rng: np.random.Generator, m: int, mu: float) -> tuple[ContactSpace, tuple[Array, Array]]:
    """Contacts of an elastic body, all open: gaps and slips by reactions and friction forces, and without any."""
    A = rng.standard_normal((2 * m, 2 * m))
    E = A @ A.T / m + 0.3 * np.eye(2 * m)
    gap, slip = np.hstack([E[:m, :m], -E[:m, m:]]), np.hstack([E[m:, :m], -E[m:, m:]])  # friction is against the slip
    start = rng.uniform(-2.0, 1.0, m), rng.uniform(-2.0, 2.0, m)
    return ContactSpace(np.zeros(m, dtype=bool), gap, slip, np.arange(m), mu), start


def assert_solves(space: ContactSpace, start: tuple[Array, Array], found: ContactForces) -> None:
    """(M6) itself."""
    z = np.concatenate([found.unknown, found.friction])
    gap, slip = space.answer @ z + start[0], space.slip @ z + start[1]
    lam, T = found.unknown, found.friction
    assert np.all(gap > -1e-9)
    assert np.all(lam > -1e-9)
    assert_allclose(lam * gap, 0.0, atol=1e-9)
    assert np.all(np.abs(T) <= space.coefficient * lam + 1e-9)
    assert_allclose((space.coefficient * lam - np.sign(slip) * T) * slip, 0.0, atol=1e-8)


def known(space: ContactSpace, closed: NDArray[np.bool_], slips: NDArray[np.intp]) -> KnownForces:
    """Contacts in given states, pushed by 1 or open by 1, slipped by 1 or sticking without force."""
    one = np.ones(len(closed))
    return KnownForces.of(space, States(closed, slips), (one, one), (0.0 * one, one))


def all_open(space: ContactSpace) -> KnownForces:
    """Nothing touches."""
    return known(space, np.zeros(len(space.held), dtype=bool), np.zeros(len(space.rubs), dtype=np.intp))


@pytest.mark.parametrize("seed", range(12))
def test_of_little_friction_the_one_solution_of_all_states(seed: int) -> None:
    space, start = random_contacts(np.random.default_rng(seed), 3, 0.2)
    found = contact_forces(space, start, all_open(space))
    assert found is not None
    assert_solves(space, start, found)
    right = 0
    for combination in product((None, -1, 0, 1), repeat=3):
        closed = np.array([state is not None for state in combination])
        states = States(closed, np.array([state or 0 for state in combination], dtype=np.intp))
        tried = of_states(space, start, states)
        bad, slips = wrong(space, tried) if tried is not None else (np.ones(1, dtype=bool), states.slips)
        if not bad.any() and np.array_equal(slips, states.slips):
            right += 1
            assert tried is not None
            assert_allclose(tried.friction, found.friction, atol=1e-9)
    assert right == 1


@pytest.mark.parametrize("mu", [0.1, 0.5])
def test_many_contacts_from_any_guess(mu: float) -> None:
    rng = np.random.default_rng(5)
    for _ in range(10):
        space, start = random_contacts(rng, 20, mu)
        guess = known(space, rng.random(20) < 0.5, rng.integers(-1, 2, 20).astype(np.intp))
        for search in (contact_forces, led):
            found = search(space, start, guess)
            assert found is not None
            assert_solves(space, start, found)


def test_a_block_on_a_spring_sticks_and_slips() -> None:
    """Pressed by 2 with friction 0.3: it holds 0.6, and gives beyond; an open contact has no friction."""
    one = np.zeros(1, dtype=np.intp)
    unit = ContactSpace(np.zeros(1, dtype=bool), np.array([[1.0, 0.0]]), np.array([[0.0, -0.5]]), one, 0.3)
    for gap, slip, force in ((-2.0, 0.2, 0.4), (-2.0, -0.9, -0.6), (-2.0, 1.0, 0.6), (0.5, 1.0, 0.0)):
        found = contact_forces(unit, (np.array([gap]), np.array([slip])), all_open(unit))
        assert found is not None
        assert found.friction[0] == pytest.approx(force, abs=1e-12)


def test_a_contact_that_snaps() -> None:
    """A gap that a push closes further has two states or none: the near one is found, and none where there is none."""
    one = np.zeros(1, dtype=np.intp)
    space = ContactSpace(np.zeros(1, dtype=bool), np.array([[-1.0, 0.0]]), np.array([[0.0, -1.0]]), one, 0.0)
    found = led(space, (np.array([0.5]), np.zeros(1)), known(space, np.ones(1, dtype=bool), one))
    assert found is not None
    assert found.unknown[0] == pytest.approx(0.5)
    assert led(space, (np.array([-0.5]), np.zeros(1)), all_open(space)) is None  # nothing solves it


def test_contacts_that_the_factor_holds_are_opened() -> None:
    """The same problem with its contacts held: unknowns are openings, and the solution is the same."""
    open_space, start = random_contacts(np.random.default_rng(7), 3, 0.2)
    held = np.linalg.inv(open_space.answer[:, :3])
    # lam = held (g - g_0 - gap_T T)
    answer = np.hstack([held, -held @ open_space.answer[:, 3:]])
    slip = np.hstack([open_space.slip[:, :3] @ held, open_space.slip[:, 3:] + open_space.slip[:, :3] @ answer[:, 3:]])
    closed = ContactSpace(np.ones(3, dtype=bool), answer, slip, np.arange(3), 0.2)
    begin = -held @ start[0], start[1] - open_space.slip[:, :3] @ held @ start[0]
    guess = np.ones(3, dtype=bool), np.zeros(3, dtype=np.intp)
    one = contact_forces(open_space, start, known(open_space, *guess))
    other = contact_forces(closed, begin, known(closed, *guess))
    assert one is not None
    assert other is not None
    assert_allclose(other.reaction(closed), one.reaction(open_space), atol=1e-9)
    assert_allclose(other.friction, one.friction, atol=1e-9)
