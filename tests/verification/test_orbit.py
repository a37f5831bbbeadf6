"""The journal through time against exact answers: eigenvalues, impedances, squeeze films, the scheme's own order."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import least_squares

from petalfoil.analysis.balance import balance
from petalfoil.analysis.impedance import impedance
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.orbit_motion import Orbit, follow
from petalfoil.analysis.release import OrbitRequest
from petalfoil.analysis.stability import stability
from petalfoil.case import Case
from petalfoil.dynamics.adaptive_steps import MarchOptions, march
from petalfoil.dynamics.time_state import Instant
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.results.record import Record
from tests.cases import case
from tests.verification.film_helpers import table

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

WEIGHT = 9.80665


def plain(**changes: object) -> Case:
    """A plain bearing on a grid that is coarse, but the same for both sides of every comparison."""
    return case("plain_journal", **{"model.cells_per_pitch": 48, "model.axial_cells": 8}, **changes)


def petals(**changes: object) -> Case:
    return case("paper_n8", **{"model.cells_per_pitch": 16}, **changes)


def under(bearing: Case, mass: float, load: float, **rotor: float) -> tuple[Case, tuple[float, float]]:
    """The bearing with a rotor of `mass` under `load` along -y, and where that balances."""
    loaded = bearing.replace(rotor={"mass": mass, **rotor}, **{"operation.load": (0.0, -load)})
    found = balance.record(loaded).scalars
    return loaded, (float(found["eccentricity_x"]), float(found["eccentricity_y"]))


def tail(record: Record, share: float) -> tuple[Array, Array]:
    """Radians turned and positions (n, 2) [m] of the last part of a motion at constant speed."""
    time, speed = np.asarray(record.coords["time"]), np.asarray(record.fields["shaft_speed"])[0]
    kept = time > (1.0 - share) * time[-1]
    x, y = np.asarray(record.fields["x"]), np.asarray(record.fields["y"])
    return time[kept] * speed, np.column_stack([x, y])[kept]


def eigenvalue(tau: Array, path: Array, guess: complex) -> complex:
    """`s` of `c + Re(A exp(s tau))` through a path, by least squares."""

    def misfit(s: Array) -> Array:
        wave = np.exp(complex(*s) * (tau - tau[0]))
        shape = np.column_stack([np.ones_like(tau), wave.real, -wave.imag])
        away = path - shape @ np.linalg.lstsq(shape, path, rcond=None)[0]
        return np.asarray(away.ravel() / np.ptp(path))

    return complex(*least_squares(misfit, [guess.real, guess.imag], xtol=1e-13, ftol=1e-13).x)


# ---------------------------------------------------------------------------------------------- free motions


@pytest.mark.slow
@pytest.mark.parametrize("share", [pytest.param(0.6, marks=pytest.mark.slow), 2.0])
def test_free_orbit_grows_or_dies_out_as_its_natural_mode(share: float) -> None:
    """Growth rate and whirl frequency within 1 %, on both sides of the critical mass."""
    load = 15.0
    bearing = plain(**{"operation.load": (0.0, -load)})
    critical = float(stability.record(bearing).scalars["critical_mass"])
    loaded, (x, y) = under(bearing, share * critical, load)
    told = stability.record(loaded, mass=share * critical)
    omega = loaded.operation.speed
    modes = np.asarray(told.fields["mode_growth_rate"]) + 1j * np.asarray(told.fields["natural_frequency"])
    expected = modes[np.argmax(modes.real)] / omega
    course = OrbitRequest(revolutions=6.0, initial=(x + 1e-10, y), tolerance=1e-7, longest=0.15)
    found = eigenvalue(*tail(follow(loaded, course), 0.6), 1.02 * expected)
    assert np.sign(found.real) == np.sign(share - 1.0)
    assert abs(found.real / expected.real - 1.0) <= 1e-2
    assert abs(found.imag / expected.imag - 1.0) <= 1e-2


@pytest.mark.slow
def test_critical_mass_divides_orbits_that_die_out_from_orbits_that_grow() -> None:
    """2 % below it an orbit shrinks, 2 % above it grows."""
    load = 15.0
    bearing = plain(**{"operation.load": (0.0, -load)})
    critical = float(stability.record(bearing).scalars["critical_mass"])
    rates = []
    for share in (0.98, 1.02):
        loaded, (x, y) = under(bearing, share * critical, load)
        course = OrbitRequest(revolutions=12.0, initial=(x + 1e-10, y), tolerance=1e-7, longest=0.1)
        rates.append(eigenvalue(*tail(follow(loaded, course), 0.6), 0.45j).real)
    assert rates[0] < 0.0 < rates[1]


@pytest.mark.slow
def test_a_released_rotor_settles_on_its_balance() -> None:
    """From the centre, a light rotor under a load that a whirl does not turn round: within 1e-4 of the clearance."""
    loaded, (x, y) = under(plain(), 0.3, 400.0)
    record = follow(loaded, OrbitRequest(revolutions=20.0, initial=(0.0, 0.0)))
    end = np.asarray(record.fields["x"])[-1], np.asarray(record.fields["y"])[-1]
    assert math.hypot(end[0] - x, end[1] - y) <= 1e-4 * loaded.bearing.clearance


# ---------------------------------------------------------------------------------------------- forced motions


def harmonics(time: Array, values: Array, frequencies: list[float]) -> Complex:
    """Complex amplitude at the first of the frequencies, the others fitted beside it."""
    waves = [wave(frequency * time) for frequency in frequencies for wave in (np.cos, np.sin)]
    shape = np.column_stack([np.ones_like(time), *waves])
    found = np.linalg.lstsq(shape, values, rcond=None)[0]
    return np.asarray(found[1] - 1j * found[2])


def measured_impedance(
    bearing: Case, force: float, frequency: float, course: OrbitRequest, free: list[float]
) -> Complex:
    """`Z` (2, 2) from orbits that a load rotating each way forces, [N/m]."""
    moved, pushed = [], []
    for turn in (frequency, -frequency):
        rotor = {"mass": bearing.rotor.mass if bearing.rotor else 1.0, "rotating_load": force, "rotating_speed": turn}
        record = follow(bearing.replace(rotor=rotor), course)
        time = np.asarray(record.coords["time"])
        kept = time > 0.3 * time[-1]
        parts = [
            harmonics(time[kept], np.asarray(record.fields[name])[kept], [frequency, *free])
            for name in ("x", "y", "force_x", "force_y")
        ]
        moved.append(parts[:2])
        pushed.append(parts[2:])
    return np.asarray(-np.array(pushed).T @ np.linalg.inv(np.array(moved).T))


@pytest.mark.slow
@pytest.mark.parametrize(
    "ratio", [pytest.param(0.5, marks=pytest.mark.long), 1.0, pytest.param(2.0, marks=pytest.mark.long)]
)
def test_forced_orbits_of_petals_give_back_stiffness_and_damping(ratio: float) -> None:
    """K and C each within 1 % of their size; free motions hardly die out here, and are fitted beside.

    An orbit holds its contacts at nodes: its slopes are those of the discrete equations, not of contact points.
    """
    loaded, start = under(petals(**{"model.contacts": "nodes"}), 3.0, 3.0 * WEIGHT)
    omega = loaded.operation.speed
    free = [
        float(f) for f in np.asarray(stability.record(loaded, mass=3.0).fields["natural_frequency"]) if f < 0.2 * omega
    ]
    course = OrbitRequest(revolutions=20.0, initial=start, tolerance=1e-6, longest=0.1 / max(1.0, ratio))
    found = measured_impedance(loaded, 0.01, ratio * omega, course, free)
    K, C = impedance(SmallMotion.at_nodes(operating_point(loaded, None).answer), ratio * omega, omega)
    assert np.max(np.abs(found.real - K)) <= 1e-2 * np.max(np.abs(K))
    assert np.max(np.abs(found.imag / (ratio * omega) - C)) <= 1e-2 * np.max(np.abs(C))


STRIPS = [row for row in table("a3_squeeze_linear.csv") if row["shape"] == "strip" and float(row["sigma"]) in (10, 50)]


@pytest.mark.slow
@pytest.mark.parametrize(
    "row",
    [
        pytest.param(row, id=f"sigma={row['sigma']}", marks=[pytest.mark.long] * (row["sigma"] == "50"))
        for row in STRIPS
    ],
)
def test_squeeze_film_of_a_journal_at_rest(row: dict[str, str]) -> None:
    """A journal that does not turn in a very short bearing squeezes strips: stiffness and damping within 0.5 %.

    L/D = 0.02, 64 cells round, 96 over the length; the circle's own share of the flow is 1 / (625 sigma).
    """
    short = {"bearing.journal_radius": "50 mm", "bearing.bushing_radius": "50.005 mm", "bearing.length": "2 mm"}
    still = {"operation.speed": 0.0, "operation.load": (0.0, 0.0), "operation.eccentricity": (0.0, 0.0)}
    grid = {"model.cells_per_pitch": 64, "model.axial_cells": 96}
    bearing = case("plain_journal", rotor={"mass": 1e-3}, **short, **still, **grid)
    sizes, gas = bearing.bearing, bearing.gas
    frequency = (
        float(row["sigma"]) * gas.ambient_pressure * sizes.clearance**2 / (12.0 * gas.viscosity * sizes.length**2)
    )
    stiffness = 0.5 * math.pi * gas.ambient_pressure * sizes.length * 2.0 * sizes.journal_radius / sizes.clearance
    expected = stiffness * complex(float(row["Sk"]), float(row["Sd"]))
    turn = 2.0 * math.pi / frequency
    longest = 0.05 * Orbit.begin(bearing, OrbitRequest(duration=turn)).system.rotor.clock.rate / frequency
    course = OrbitRequest(duration=12.0 * turn, tolerance=1e-7, longest=longest)
    force = 1e-3 * bearing.bearing.clearance * abs(expected - 1e-3 * frequency**2)
    found = measured_impedance(bearing, force, frequency, course, [])
    assert np.allclose(np.diag(found).real, expected.real, rtol=5e-3, atol=0.0)
    assert np.allclose(np.diag(found).imag, expected.imag, rtol=5e-3, atol=0.0)


# ---------------------------------------------------------------------------------------------- the scheme


def equal_steps(bearing: Case, step: float, end: float) -> Orbit:
    """A motion in equal steps [units of time]."""
    orbit = Orbit.begin(bearing, OrbitRequest(duration=1.0))
    options = MarchOptions(tolerance=1e-5, first=step, longest=step, fixed=True)
    for stepped in march(orbit.system, orbit.start, end, options):
        orbit.trace.add(stepped.end)
    return orbit


def after(bearing: Case, step: float, end: float) -> Instant:
    """The state after a motion in equal steps [units of time]."""
    last = equal_steps(bearing, step, end).trace.last
    assert last is not None
    return last


def falling() -> Case:
    """A rotor released off its balance: film, position and velocity all move."""
    return plain(rotor={"mass": 0.1, "unbalance": 2e-6}, **{"operation.eccentricity": (0.0, -5e-6)})


@pytest.mark.slow
def test_second_order_in_time() -> None:
    """Differences of position and film after 1 rad between steps and half the steps fall with slope 2 +- 0.1."""
    bearing = falling()
    ends = [after(bearing, step, 1.0) for step in (0.05, 0.025, 0.0125, 0.00625)]
    errors = [[np.linalg.norm(a.e - b.e), np.linalg.norm(a.x - b.x)] for a, b in pairwise(ends)]
    slopes = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(np.abs(slopes - 2.0) <= 0.1)


@pytest.mark.slow
def test_audits_close_to_second_order() -> None:
    """Gas and energy: a quarter of the defect at half the step, for a plain bearing and for petals."""
    for bearing, least in ((falling(), 1e-9), (petals(rotor={"mass": 1.0, "unbalance": 2e-6}), 1e-9)):
        defects = []
        for step in (0.04, 0.02):
            scalars = equal_steps(bearing, step, 2.0).record().scalars
            defects.append([scalars["mass_balance_error"], scalars["energy_balance_error"]])
        coarse, fine = np.array(defects, dtype=float)
        assert np.all((fine <= 0.35 * coarse) | (fine <= least)), (coarse, fine)
        assert np.all(fine <= 1e-3)


@pytest.mark.slow
def test_steps_adapt_to_the_tolerance() -> None:
    """A hundredth of the tolerance: smaller error, more steps."""
    bearing = falling()
    best = follow(bearing, OrbitRequest(revolutions=0.5, tolerance=1e-6, longest=0.02))
    ends, steps = [], []
    for tolerance in (1e-2, 1e-4):
        record = follow(bearing, OrbitRequest(revolutions=0.5, tolerance=tolerance, longest=10.0))
        ends.append(abs(np.asarray(record.fields["x"])[-1] - np.asarray(best.fields["x"])[-1]))
        steps.append(int(record.scalars["steps"]))
    assert ends[1] < 0.2 * ends[0]
    assert steps[1] > 2 * steps[0]


# ---------------------------------------------------------------------------------------------- contact


@pytest.mark.slow
def test_touching_rubbing_and_lifting_off_without_a_failed_step() -> None:
    """A large unbalance throws the journal onto the petals and off again, contacts at nodes."""
    bearing = petals(rotor={"mass": 3.0, "unbalance": 30e-6}, **{"model.contacts": "nodes"})
    record = follow(bearing, OrbitRequest(revolutions=6.0))
    share = np.asarray(record.fields["contact_fraction"])
    touching = share > 0.01
    assert np.any(touching)
    assert np.count_nonzero(np.diff(touching.astype(int)) == -1) >= 1
    assert record.scalars["failed_steps"] == 0
    assert np.all(np.asarray(record.fields["min_film_thickness"]) >= 0.999e-6)


@pytest.mark.slow
def test_an_unstable_orbit_grows_to_the_wall_and_stays_within() -> None:
    """A heavy rotor whirls at half speed until the bore stops it."""
    bearing = plain(rotor={"mass": 20.0}, **{"operation.load": (0.0, -1.0)})
    record = follow(bearing, OrbitRequest(revolutions=15.0))
    radius = np.hypot(np.asarray(record.fields["x"]), np.asarray(record.fields["y"]))
    room = bearing.bearing.clearance - bearing.surface.contact_film_thickness
    corner = room / math.cos(math.pi / bearing.cells_per_pitch)  # contact is at nodes: the room is a polygon
    assert radius.max() > 0.98 * room
    assert radius.max() <= corner * (1.0 + 1e-9)
    assert np.asarray(record.fields["contact_fraction"]).max() > 0.0


@pytest.mark.slow
def test_speed_may_rise_from_rest() -> None:
    """A run-up in time: the shaft turns as the ramp says, the film lifts the journal on the way."""
    bearing = petals(rotor={"mass": 0.5})
    course = OrbitRequest(speeds=((0.0, 0.0), (2e-3, 8000.0)), initial=(0.0, 0.0))
    record = follow(bearing, course)
    turned = np.asarray(record.fields["shaft_angle"])[-1]
    assert turned == pytest.approx(0.5 * 2e-3 * 8000.0, rel=1e-9)
    assert np.asarray(record.fields["shaft_speed"])[-1] == pytest.approx(8000.0)
    assert replace(course, speeds=None).schedule(bearing).top == bearing.operation.speed


@pytest.mark.slow
def test_a_released_rotor_on_petals_ends_where_its_load_balances() -> None:
    """Petals hardly damp: steps too long to follow the swing, which an L-stable scheme takes out, lead there."""
    loaded, (x, y) = under(petals(**{"model.contacts": "nodes"}), 1e-3, 20.0)
    course = OrbitRequest(revolutions=40.0, initial=(x + 2e-6, y + 5e-6), tolerance=1e3, longest=3.0)
    record = follow(loaded, course)
    end = np.asarray(record.fields["x"])[-1], np.asarray(record.fields["y"])[-1]
    assert math.hypot(end[0] - x, end[1] - y) <= 1e-9


@pytest.mark.parametrize(("of_speed", "told"), [(1.0, True), (0.5, False)], ids=["at speed", "before it"])
def test_a_motion_that_rubs_at_its_speed_says_so(of_speed: float, told: bool) -> None:
    """A journal pressed on its petals: warned of at the speed of the case, not on the way there."""
    pressed = petals(**{"operation.eccentricity": (0.0, -200e-6), "operation.speed": 300.0, "rotor": {"mass": 1.0}})
    record = follow(pressed, OrbitRequest(revolutions=0.01, speeds=((0.0, 300.0 * of_speed),)))
    assert np.max(record.fields["contact_fraction"]) > 0.01
    assert any(text.startswith("contact_fraction:") for text in record.warnings) == told
