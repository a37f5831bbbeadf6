"""Friction between petals in small motions: stuck against equilibria, in cycles by harmonic balance."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.analysis import threshold
from petalfoil.analysis.coefficients import coefficients
from petalfoil.analysis.impedance import elastic, impedance, sliding_at
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.stability import stability
from petalfoil.case import Case
from petalfoil.dynamics.harmonic_balance import FrictionCycle
from petalfoil.dynamics.rubbing_cycle import FREQUENCIES
from petalfoil.equilibrium.friction_path import FrictionResult, slide
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import UnitError, UsageError
from petalfoil.physics.dry_friction import Friction
from petalfoil.results.record import Record
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import FrictionState, friction_of, friction_tangent, slips
from tests.cases import case

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

LOAD, MICRON = (0.0, -20.0), 1e-6


def bearing(friction: float = 0.3, width: float = 1e-9, speed: float = 8000.0) -> Case:
    changes = {"surface.petal_friction": friction, "surface.friction_width": width, "operation.speed": speed}
    return case("paper_n8", **{"model.cells_per_pitch": 24, "petals.theory": "inextensible", **changes})


@cache
def answer_of(speed: float = 8000.0) -> Solution:
    """The equilibrium under the load; friction has no force there."""
    answer = operating_point(bearing(speed=speed), LOAD).answer
    return answer


def run(rubs: Case, **asked: float) -> Record:
    return coefficients.record(rubs, [2000.0, 8000.0], load=LOAD, **asked)


def impedances(record: Record) -> Complex:
    Omega = record.coords["whirl_frequency"].astype(float)[:, None, None]
    return record.fields["stiffness"].astype(complex) + 1j * Omega * record.fields["damping"].astype(complex)


def assert_near(found: Complex, wanted: Complex, rtol: float) -> None:
    assert_allclose(found, wanted, rtol=0.0, atol=rtol * float(np.max(np.abs(wanted))))


# ------------------------------------------------------------------------------------------ petals that stick


@pytest.mark.parametrize(("speed", "touching"), [(8000.0, False), (800.0, True)])
def test_stiffness_of_stuck_petals_is_the_slope_of_equilibria_with_friction(speed: float, touching: bool) -> None:
    """Within 1e-5 of its size; friction is strong and soft, so that nothing slips in a step of 1 nm."""
    rubs, answer = bearing(5.0, 5e-9 / 0.3, speed), answer_of(speed)
    assert bool(answer.active[answer.problem.layout.wall.contacts.journal].any()) == touching
    sliding = sliding_at(rubs, answer)
    assert sliding is not None
    K, _ = impedance(SmallMotion.at_nodes(answer, sliding.sticking(len(answer.x))), 0.0, speed)
    free, _ = impedance(SmallMotion.at_nodes(answer), 0.0, speed)
    slope = differences(rubs, answer, 1e-4)
    assert_allclose(K, slope, rtol=0.0, atol=1e-5 * float(np.max(np.abs(slope))))
    assert K[0, 0] > 2.0 * free[0, 0]


def differences(rubs: Case, answer: Solution, step: float) -> Array:
    """`-dF/de` [N/m] from equilibria with friction on either side, reached from `answer` where it has no force yet."""
    layout = answer.problem.layout
    friction, columns = friction_of(rubs, layout), []
    assert friction is not None
    before = unslid(answer, friction)
    for k in (0, 1):
        forces = []
        for side in (-step, step):
            moved = answer.problem.displacement.copy()
            moved[k] += side
            problem = answer.problem.at(displacement=moved)
            near = slide(problem, friction, before, LinearSolver())
            assert near is not None
            assert np.array_equal(near.active, answer.active)
            forces.append(problem.journal_force(near.x, near.lam))
        columns.append(-(forces[1] - forces[0]) / (2.0 * step))
    return np.column_stack(columns) * layout.scales.force / layout.scales.length


@pytest.mark.slow
def test_natural_modes_are_those_of_stuck_petals(monkeypatch: pytest.MonkeyPatch) -> None:
    """They solve (E7) with sticking contacts in the tangent, and are stiffer."""
    monkeypatch.setattr(threshold, "RANGE", 1.0)  # no search for a threshold speed
    mass, bearings = 0.05, [bearing(mu).replace(**{"model.cells_per_pitch": 12}) for mu in (0.3, 0.0)]
    stuck, free = (stability.record(one, load=LOAD, mass=mass).fields for one in bearings)
    assert np.all(stuck["natural_frequency"][-1] > 1.3 * free["natural_frequency"])
    answer = operating_point(bearings[0], LOAD).answer
    scales = answer.problem.layout.scales
    s = (stuck["mode_growth_rate"] + 1j * stuck["natural_frequency"]) / 8000.0
    for value in s:
        gradient = elastic(bearings[0], answer).growing(value, LinearSolver()).force_gradient
        inertia = mass * (8000.0 * value) ** 2 * np.eye(2)
        sizes = np.linalg.svd(inertia - gradient * scales.force / scales.length, compute_uv=False)
        assert sizes[1] < 1e-6 * abs(inertia[0, 0])


# ------------------------------------------------------------------------------------------ cycles


def cycle(amplitude: float, nu: float = 0.7) -> tuple[FrictionCycle, Complex]:
    """A cycle at a whirl ratio, and its slips by a unit displacement along x, (k,)."""
    answer = answer_of()
    sliding = sliding_at(bearing(), answer)
    assert sliding is not None
    response = SmallMotion.about(answer).respond(nu, LinearSolver())
    whirl = FrictionCycle(sliding, response, amplitude / answer.problem.layout.scales.length)
    free = slips(sliding.friction, response.tangent.units[:, 0])
    return whirl, whirl.settled(free, whirl.compliance())


@pytest.mark.parametrize("amplitude", [0.6e-6, 1e-6, 3e-6, 30e-6])
def test_cycles_are_motions_with_their_equivalent_stiffness_in_the_tangent(amplitude: float) -> None:
    """What Newton found in the slips alone solves the whole linear system; most of the contacts slip, or few."""
    whirl, slip = cycle(amplitude)
    stiffness, _ = whirl.sliding.equivalent(slip, whirl.amplitude)
    assert (np.mean(stiffness.imag > 0.0) > 0.6) == (amplitude > 2e-6)
    assert np.any(stiffness.imag > 0.0)
    n = len(answer_of().x)
    sticking = friction_tangent(whirl.sliding.friction, stiffness, n)
    whole = replace(whirl.response.motion, sticking=sticking).respond(0.7, LinearSolver())
    assert_near(slips(whirl.sliding.friction, whole.tangent.units[:, 0]), slip, 1e-9)
    assert_near(whirl.force_gradient()[:, 0], whole.force_gradient[:, 0], 1e-9)


def test_what_a_cycle_takes_is_the_area_of_its_loops_and_the_work_of_the_film() -> None:
    """To rounding: `pi Omega C a^2` against `4 mu N (A - mu N / k)` over the contacts that slip, and `int p dV`."""
    whirl, slip = cycle(MICRON)
    sliding, a, problem = whirl.sliding, whirl.amplitude, answer_of().problem
    size = np.abs(slip) * a
    loops = np.sum(4.0 * sliding.limit * np.maximum(size - sliding.limit / sliding.friction.stiffness, 0.0))
    n, layout = len(answer_of().x), problem.layout
    sticking = friction_tangent(sliding.friction, sliding.equivalent(slip, a)[0], n)
    whole = replace(whirl.response.motion, sticking=sticking).respond(0.7, LinearSolver())
    change = whole.tangent.units[:, 0]
    w, P = change[: layout.n_wall], change[problem.positive]
    film = -np.pi * a**2 * np.imag(np.conj(w) @ (layout.push @ P) + (problem.border.row_derivative @ P)[0])
    taken = -np.pi * a**2 * whirl.force_gradient()[0, 0].imag
    assert loops > 0.5 * taken > 0.0
    assert_allclose(taken, loops + film, rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("amplitude", [1e-6, 3e-6])
def test_cycles_are_near_those_that_the_bearing_is_led_through(amplitude: float) -> None:
    """A slow cycle in equilibria whose reactions and contacts change: stiffness within 2 %, loss within 12 %."""
    rubs, answer = bearing(), answer_of()
    scales, sliding = answer.problem.layout.scales, sliding_at(rubs, answer)
    assert sliding is not None
    a = amplitude / scales.length
    response = SmallMotion.at_nodes(answer).respond(1e-6, LinearSolver())
    balanced = FrictionCycle(sliding, response, a).force_gradient()[0, 0]
    led = slow_cycle(rubs, answer, a)
    assert led.real == pytest.approx(balanced.real, rel=2e-2)
    assert led.imag == pytest.approx(balanced.imag, rel=1.2e-1)


def unslid(answer: Solution, friction: Friction) -> FrictionResult:
    """The equilibrium before its petals slide."""
    fresh = FrictionState.fresh(friction, answer.x, answer.lam)
    return FrictionResult(answer.x, answer.lam, answer.active, answer.residual, fresh, 0.0)


def slow_cycle(rubs: Case, answer: Solution, a: float, steps: int = 32) -> complex:
    """First harmonic of the force along x over a displacement of `a` there, in the second cycle."""
    friction, forces = friction_of(rubs, answer.problem.layout), []
    assert friction is not None
    phase = 2.0 * np.pi * np.arange(1, 2 * steps + 1) / steps
    before = unslid(answer, friction)
    for angle in phase:
        problem = answer.problem.at(displacement=answer.problem.displacement + np.array([a * np.sin(angle), 0.0]))
        near = slide(problem, friction, before, LinearSolver())
        assert near is not None
        before = near
        forces.append(problem.journal_force(near.x, near.lam)[0])
    return complex(2j / steps * np.exp(-1j * phase[steps:]) @ np.array(forces[steps:]) / a)


@pytest.mark.slow
def test_small_cycles_stick_and_large_ones_do_not_feel_friction() -> None:
    rubs, free = bearing(), bearing(0.0)
    assert_near(impedances(run(rubs, amplitude=1e-15)), impedances(run(rubs)), 1e-6)
    assert_near(impedances(run(rubs, amplitude=100.0)), impedances(run(free)), 1e-6)
    assert_near(impedances(run(bearing(1e-9), amplitude=MICRON)), impedances(run(free)), 1e-6)


@pytest.mark.slow
def test_friction_damps_both_ways_and_most_where_it_neither_sticks_nor_is_small() -> None:
    rubs = bearing()
    none, *rubbing = (run(case_, **asked).fields["damping"][:, (0, 1), (0, 1)] for case_, asked in (
        (bearing(0.0), {}), (rubs, {"amplitude": 0.2e-6}), (rubs, {"amplitude": 3e-6}), (rubs, {"amplitude": 100e-6}),
    ))  # fmt: skip
    assert np.all(rubbing[1] > 0.0)
    assert np.all(rubbing[1] > rubbing[0])
    assert np.all(rubbing[1] > rubbing[2])
    assert np.all(rubbing[1] > 5.0 * none)


def test_a_frequency_costs_a_factorisation_for_each_of_three_harmonics() -> None:
    counts = [
        int(coefficients.record(bearing(), np.linspace(1e3, 9e3, n).tolist(), load=LOAD, amplitude=MICRON).scalars[
            "probe_factorizations"
        ])
        for n in (1, 5)
    ]  # fmt: skip
    assert counts[1] - counts[0] == 4 * FREQUENCIES


@pytest.mark.slow
def test_where_little_gives_way_newton_still_arrives() -> None:
    """Friction that is a thousand times as steep, and strong."""
    for amplitude in (0.1e-6, 1e-6, 10e-6):
        record = run(bearing(1.0, 1e-12), amplitude=amplitude)
        assert record.scalars["whirl_amplitude"] == amplitude
        assert np.all(record.fields["damping"][:, (0, 1), (0, 1)] > 0.0)


def test_what_cannot_be_asked() -> None:
    for amplitude in (0.0, -MICRON):
        with pytest.raises(UsageError, match=r"amplitude: .* is outside its range; allowed: greater than 0 m"):
            run(bearing(), amplitude=amplitude)
    for amplitude in (float("nan"), float("inf")):
        with pytest.raises(UnitError, match=r"amplitude: .* is not finite"):
            run(bearing(), amplitude=amplitude)
    with pytest.raises(UsageError, match="petal_friction is 0"):
        run(bearing(0.0), amplitude=MICRON)
    with pytest.raises(UsageError, match="petals that rub"):
        coefficients.record(case("plain_journal", **{"surface.petal_friction": 0.3}), [1.0], amplitude=MICRON)
    with pytest.raises(UsageError, match="above zero"):
        coefficients.records(bearing(), [0.0, 100.0], speeds=[8000.0], amplitude=MICRON)
