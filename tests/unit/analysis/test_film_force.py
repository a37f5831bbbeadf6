"""Forces for one's own integrator: the trajectory of `orbit`, a state that stays, gas that is not lost, refusals."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

import petalfoil
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError, UsageError
from tests.cases import EXAMPLES, case

Array = NDArray[np.float64]

PLAIN = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})
PETALS = case("paper_n8", **{"model.cells_per_pitch": 12, "operation.eccentricity": ("0 um", "-100 um")})
BUMPS = case("bump_foil", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})


def followed(of: Case, steps: int, turns: float) -> tuple[Array, Array]:
    """Times and positions of the rigid rotor of a case by steps of RK23, `steps` of a turn."""
    assert of.rotor is not None
    film, speed, m, off = petalfoil.Film(of), of.operation.speed, of.rotor.mass, of.rotor.unbalance
    dt, t, y = 2.0 * np.pi / speed / steps, 0.0, np.array([*of.operation.eccentricity, 0.0, 0.0])

    def rates(time: float, y: Array) -> Array:
        turning = m * off * speed**2 * np.array([np.cos(speed * time), np.sin(speed * time)])
        force = film.force(*y, speed, time=time) + turning + [0.0, -m * 9.80665]
        return np.array([y[2], y[3], *(force / m)])

    times, states = [0.0], [y]
    one = {"method": "RK23", "first_step": dt, "max_step": dt, "rtol": 1.0, "atol": 1.0}
    for _ in range(round(steps * turns)):
        y = solve_ivp(lambda after, y, t=t: rates(t + after, y), (0.0, dt), y, **one).y[:, -1]
        t += dt
        film.advance(*y, speed, time=t)
        times.append(t)
        states.append(y)
    return np.array(times), np.array(states)


def apart(of: Case, steps: int, turns: float = 1.0) -> float:
    """Largest distance from the trajectory of `orbit`, over the size of that."""
    times, states = followed(of, steps, turns)
    motion = petalfoil.orbit(of, revolutions=turns, tolerance=1e-5)
    found, size = 0.0, max(float(np.ptp(motion[axis].to_numpy())) for axis in "xy")
    for axis, column in (("x", 0), ("y", 1)):
        known = CubicHermiteSpline(*(motion[name].to_numpy() for name in ("time", axis, f"velocity_{axis}")))(times)
        found = max(found, float(np.abs(states[:, column] - known).max()) / size)
    return found


@pytest.mark.slow
def test_a_rigid_rotor_takes_the_way_of_orbit() -> None:
    assert apart(PETALS.replace(rotor={"mass": 3.0, "unbalance": 2e-6}, **{"model.contacts": "nodes"}), 40, 0.25) < 3e-3


@pytest.mark.slow
@pytest.mark.parametrize("of", [BUMPS], ids=["bumps with loss"])
def test_other_walls_take_the_way_of_orbit_and_nearer_with_shorter_steps(of: Case) -> None:
    moving = of.replace(rotor={"mass": 0.3, "unbalance": 1e-6})
    coarse, fine = apart(moving, 40), apart(moving, 80)
    assert fine < 2e-3
    assert coarse / fine > 2.0


def test_a_force_leaves_the_state_as_it_is_and_an_advance_moves_it() -> None:
    film, speed = petalfoil.Film(PLAIN), PLAIN.operation.speed
    x, y = film.position
    at_rest = film.force(x, y, 0.0, 0.0, speed, time=0.0)
    solved = petalfoil.solve(PLAIN)
    assert_allclose(at_rest, [float(solved["force_x"]), float(solved["force_y"])], rtol=1e-9)
    once, again = (film.force(x, y - 1e-6, 0.0, -0.1, speed, time=1e-5) for _ in range(2))
    assert_allclose(once, again, rtol=1e-8)
    assert film.time == 0.0
    assert_allclose(film.advance(x, y - 1e-6, 0.0, -0.1, speed, time=1e-5), once, rtol=1e-8)
    assert film.time == 1e-5
    assert abs(once - at_rest).max() > 1.0  # a squeeze pushes back
    assert once[1] > at_rest[1]


@pytest.mark.slow
def test_a_journal_that_is_held_comes_to_its_equilibrium() -> None:
    film, speed = petalfoil.Film(BUMPS), BUMPS.operation.speed
    x, y = 2e-6, -12e-6
    film.advance(x, y, 0.0, 0.0, speed, time=1e-4)
    for k in range(2, 60):
        force = film.advance(x, y, 0.0, 0.0, speed, time=k * 2e-4)
    there = petalfoil.solve(BUMPS.replace(**{"operation.eccentricity": (x, y)}))
    assert_allclose(force, [float(there["force_x"]), float(there["force_y"])], rtol=1e-4)
    told = film.results()
    assert told["min_film_thickness"] == pytest.approx(float(there["min_film_thickness"]), rel=1e-4)
    assert told["peak_pressure"] == pytest.approx(float(there["peak_pressure"]), rel=1e-5)
    assert told["contact_fraction"] == 0.0


def test_the_minimum_film_of_petals_is_that_of_contacts_at_nodes() -> None:
    """A film that others move has contacts at nodes, and its minimum is that of every verb with contacts there."""
    there = petalfoil.solve(PETALS.replace(**{"model.contacts": "nodes"}))
    told = petalfoil.Film(PETALS).results()
    assert told["min_film_thickness"] == pytest.approx(float(there["min_film_thickness"]), rel=1e-9)


@pytest.mark.slow
def test_the_gas_that_is_gained_has_come_in() -> None:
    film, speed = petalfoil.Film(PLAIN), PLAIN.operation.speed
    told = [film.results()]
    for k in range(1, 41):
        film.advance(0.0, -10e-6 - 1e-7 * k, 0.0, -0.05, speed, time=2e-6 * k)
        told.append(film.results())
    assert told[0]["gas"] == pytest.approx(
        1.19 * 25e-6 * 2.0 * np.pi * 25e-3 * 50e-3, rel=0.35
    )  # a quarter at the edges
    gas, out = (np.array([each[name] for each in told]) for name in ("gas", "outflow"))
    lost = np.sum(0.5 * (out[1:] + out[:-1])) * 2e-6
    assert abs(gas[-1] - gas[0]) > 1e-4 * gas[0]
    assert gas[0] - gas[-1] == pytest.approx(lost, rel=2e-2)


@pytest.mark.slow
def test_energy_and_gas_of_a_motion_are_accounted_for() -> None:
    """Eight petals: what the rotor gains is the work on it, and the gas that the film loses has flown out."""
    of = PETALS.replace(rotor={"mass": 3.0, "unbalance": 2e-6})
    times, states = followed(of, 40, 0.5)
    film, speed = petalfoil.Film(of), of.operation.speed
    forces, told = [film.force(*states[0], speed, time=0.0)], [film.results()]
    for t, state in zip(times[1:], states[1:], strict=True):
        forces.append(film.advance(*state, speed, time=t))
        told.append(film.results())
    turning = 3.0 * 2e-6 * speed**2 * np.stack([np.cos(speed * times), np.sin(speed * times)], axis=1)
    whole, v = np.array(forces) + turning + [0.0, -3.0 * 9.80665], states[:, 2:]
    power = np.sum(whole * v, axis=1)
    rate = np.gradient(power, times)
    dt = np.diff(times)
    # the trapezium with its end correction: of fourth order, as the motion between two steps is smooth
    work = np.sum(0.5 * dt * (power[1:] + power[:-1])) - dt[0] ** 2 / 12.0 * (rate[-1] - rate[0])
    gained = 1.5 * float(np.sum(v[-1] ** 2) - np.sum(v[0] ** 2))
    assert np.sum(np.abs(power)) * dt[0] > 2e-5
    assert work == pytest.approx(gained, abs=2e-3 * np.sum(np.abs(power)) * dt[0])
    gas, out = (np.array([each[name] for each in told]) for name in ("gas", "outflow"))
    lost = np.sum(0.5 * dt * (out[1:] + out[:-1]))
    assert gas[0] - gas[-1] == pytest.approx(lost, abs=1e-2 * np.ptp(gas))


def test_a_journal_that_tilts_feels_a_moment() -> None:
    film, speed = petalfoil.Film(PLAIN, tilts=True), PLAIN.operation.speed
    x, y = PLAIN.operation.eccentricity
    slope = 1e-4
    for k in range(1, 40):
        force = film.advance(x, y, 0.0, 0.0, speed, time=2e-4 * k, tilt=(0.0, slope, 0.0, 0.0))
    assert force.shape == (4,)
    tilted = petalfoil.solve(PLAIN.replace(**{"operation.tilt": (0.0, slope)}))
    assert force[2:] == pytest.approx([float(tilted["moment_x"]), float(tilted["moment_y"])], rel=1e-3)
    assert film.position[2:] == pytest.approx([0.0, slope])


def test_what_cannot_be_followed_is_refused() -> None:
    film, speed = petalfoil.Film(PLAIN), PLAIN.operation.speed
    film.advance(0.0, -10e-6, 0.0, 0.0, speed, time=1e-4)
    with pytest.raises(UsageError, match=r"the film is at 0\.0001 s already"):
        film.force(0.0, -10e-6, 0.0, 0.0, speed, time=0.5e-4)
    with pytest.raises(UsageError, match="takes no tilt"):
        film.force(0.0, -10e-6, 0.0, 0.0, speed, time=2e-4, tilt=(0.0, 0.0, 0.0, 0.0))
    with pytest.raises(UsageError, match="petals without friction"):
        petalfoil.Film(PETALS.replace(**{"surface.petal_friction": 0.1}))
    with pytest.raises(ConvergenceError, match=r"no film at .* after 0\.0001 s"):
        film.force(0.0, -40e-6, 0.0, 0.0, speed, time=2e-4)


def example() -> ModuleType:
    """The script of a rotor of one's own."""
    spec = importlib.util.spec_from_file_location("own_rotor", Path(EXAMPLES) / "own_rotor.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_the_flexible_rotor_of_the_example_swings_about_its_balance() -> None:
    script = example()
    _, states = script.run(PETALS, turns=1.0)
    assert np.all(np.isfinite(states))
    stretched = states[:, :2] - states[:, 2:4]
    assert np.abs(stretched).max() < 2e-4
    assert np.abs(states[:, 2:4]).max() < PETALS.bearing.clearance
