"""Natural modes of a rotor: the plain journal's characteristic equation, the whole operator, the threshold."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
import scipy.linalg as la
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy.optimize import newton

from petalfoil.analysis.impedance import elastic
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.stability import stability
from petalfoil.case import NEUTRAL_DAMPING, Case
from petalfoil.dynamics import reduced_impedance
from petalfoil.dynamics.critical_mass import neutral_whirl, whirl_impedance
from petalfoil.dynamics.natural_modes import PEAK, Mode, natural_modes
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import Motion
from tests.cases import case

Complex = NDArray[np.complex128]


def plain(grid: tuple[int, int], e: tuple[float, float] = (0.0, 0.0)) -> Case:
    sizes = {"model.cells_per_pitch": grid[0], "model.axial_cells": grid[1]}
    return case("plain_journal", **sizes, **{"operation.eccentricity": e})


def at(bearing: Case, load: float = 0.0) -> Motion:
    """Small motions under a load along -y, or at the case's eccentricity."""
    answer = operating_point(bearing, (0.0, -load) if load else None).answer
    return elastic(bearing, answer)


def modes_of(bearing: Case, masses: Sequence[float], load: float = 0.0) -> list[list[Mode]]:
    """The modes with each mass [kg]."""
    motion = at(bearing, load)
    Z = whirl_impedance(motion)
    return [natural_modes(Z, Inertia.of_mass(mass), bearing.operation.speed) for mass in masses]


# ---------------------------------------------------------------------------------------------- plain journal


def exact_modes(bearing: Case, mass: float, starts: Complex) -> list[tuple[complex, int]]:
    """`s` near each start, and with (1) or against (-1) the rotation, from the centred journal's closed form.

    `mass omega^2 s^2 + pi/2 p_a L D / c G(Lam (-2 i s -+ 1)) = 0` (reference/README, whirls each way).
    """
    sizes, gas = bearing.bearing, bearing.gas
    c, L, D = sizes.bushing_radius - sizes.journal_radius, sizes.length, 2.0 * sizes.journal_radius
    omega, p_a = bearing.operation.speed, gas.ambient_pressure
    Lam = 6.0 * gas.viscosity * omega * sizes.journal_radius**2 / (p_a * c**2)
    stiffness = 0.5 * math.pi * p_a * L * D / c

    def defect(s: complex, way: int) -> complex:
        ib = Lam * (2.0 * s - way * 1j)
        g = np.sqrt(1.0 + ib)
        G = ib / (1.0 + ib) * (1.0 - np.tanh(g * L / D) / (g * L / D))
        return complex(mass * omega**2 * s**2 / stiffness + G)

    nearest = []
    for s in starts:
        both = [(complex(newton(defect, s, args=(way,), tol=1e-13)), way) for way in (1, -1)]
        nearest.append(both[int(np.argmin([abs(root - s) for root, _ in both]))])
    return nearest


MASSES = (0.02, 1.0, 30.0)


def test_modes_of_the_centred_journal_solve_its_characteristic_equation() -> None:
    """Second order, and within 3e-3 of their size on 64 × 32 cells; each with its own direction of whirl."""
    errors = []
    for grid in ((32, 16), (64, 32)):
        bearing, worst = plain(grid), []
        for mass, modes in zip(MASSES, modes_of(bearing, MASSES), strict=True):
            found = np.array([mode.s for mode in modes])
            exact = exact_modes(bearing, mass, found)
            worst.append(float(np.max(np.abs(found / [s for s, _ in exact] - 1.0))))
            assert_allclose([mode.direction for mode in modes], [way for _, way in exact], rtol=0.0, atol=1e-6)
        errors.append(np.array(worst))
    assert np.all(errors[1] <= 3e-3)
    assert np.all(np.log2(errors[0] / errors[1]) >= 1.9)


def test_a_heavy_rotor_has_a_mode_each_way_and_whirls() -> None:
    """The film's cross stiffness drives the forward one of the centred journal, and damps the backward one."""
    ((forward, backward),) = modes_of(plain((32, 16)), [30.0])
    assert forward.direction > 0.99
    assert backward.direction < -0.99
    assert backward.s.real < 0.0 < forward.s.real


def test_a_record_tells_the_modes_in_its_units() -> None:
    bearing = plain((24, 8))
    record = stability.record(bearing, mass=1.0)
    (modes,) = modes_of(bearing, [1.0])
    speed = bearing.operation.speed
    assert_allclose(record.fields["natural_frequency"], [mode.s.imag * speed for mode in modes], rtol=1e-9, atol=0.0)
    assert_allclose(record.fields["mode_growth_rate"], [mode.s.real * speed for mode in modes], rtol=1e-9, atol=0.0)
    ratio = record.fields["mode_growth_rate"] / np.hypot(
        record.fields["mode_growth_rate"].astype(float), record.fields["natural_frequency"].astype(float)
    )
    assert_allclose(record.fields["damping_ratio"], -ratio, rtol=1e-9, atol=0.0)


def test_without_a_mass_there_are_no_modes() -> None:
    assert "natural_frequency" not in stability.record(plain((24, 8))).fields


# ---------------------------------------------------------------------------------------------- threshold


@pytest.mark.parametrize(
    ("bearing", "load"),
    [
        pytest.param(plain((48, 12)), 30.0, id="plain"),
        pytest.param(case("paper_n6", **{"model.cells_per_pitch": 32}), 200.0, id="petals", marks=pytest.mark.slow),
    ],
)
def test_at_the_critical_mass_a_mode_neither_grows_nor_dies_out(bearing: Case, load: float) -> None:
    """Its frequency is the whirl ratio's; a little more mass lets it grow, a little less lets it die out."""
    motion = at(bearing, load)
    threshold = neutral_whirl(whirl_impedance(motion), bearing.operation.speed)
    assert math.isfinite(threshold.mass)
    masses = [threshold.mass * by for by in (0.95, 1.0, 1.05)]
    lighter, neutral, heavier = (max((mode.s for mode in modes), key=real) for modes in modes_of(bearing, masses, load))
    assert abs(neutral.real) <= 1e-5 * threshold.ratio
    assert_allclose(neutral.imag, threshold.ratio, rtol=1e-5, atol=0.0)
    assert lighter.real < 0.0 < heavier.real


@pytest.mark.slow
def test_without_a_reduced_model_the_equations_give_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """A model that is not good enough is not used: many factorisations, the same onset of whirl and modes."""
    bearing = case("paper_n6", **{"model.cells_per_pitch": 16})
    mass, found = 0.5, []
    for largest in (reduced_impedance.MODEL_ERROR, 0.0):
        monkeypatch.setattr(reduced_impedance, "MODEL_ERROR", largest)
        with running() as run:
            motion = at(bearing, 200.0)
            Z = whirl_impedance(motion)
            whirl = neutral_whirl(Z, bearing.operation.speed)
            modes = natural_modes(Z, Inertia.of_mass(mass), bearing.operation.speed)
        assert Z.reduced == (largest > 0.0)
        assert modes
        assert (run.probes.factorizations > 30) == (largest == 0.0)
        found.append([whirl.mass, whirl.ratio, *(abs(mode.s) for mode in modes)])
    assert_allclose(found[0], found[1], rtol=1e-6)


def real(s: complex) -> float:
    return s.real


# ---------------------------------------------------------------------------------------------- the whole operator


def whole_operator(motion: SmallMotion, inertia: float) -> tuple[Complex, NDArray[np.float64]]:
    """All finite eigenvalues of film, petals and journal, and the journal's share of each mode; dense.

    Unknowns: free motions `y`, position `e`, velocity `v`. With `N` the motion that keeps gaps closed when the journal
    moves, `x = S y + N e`; the force of the closed contacts on the journal is `-N^T` times what acts on the tied rows.
    """
    problem, contacts, ties = motion.problem, motion.contacts, motion.contacts.constraints
    scales, n = problem.layout.scales, len(ties.group)
    by_e = problem.layout.wall.contacts.by_e
    S = np.column_stack([ties.spread(unit) for unit in np.eye(ties.n_free)])
    N = np.column_stack([ties.close(contacts.gap_by_e[:, k]) for k in (0, 1)])
    push = np.zeros((2, n))
    push[:, problem.positive] = problem.border.row_derivative
    blocks = []
    for matrix, rate in ((motion.steady, 0.0), (motion.stored, 1.0)):
        full = matrix.toarray()
        by_slack = motion.linearized.slack_derivative
        shift = np.column_stack([by_slack(by_e[:, k], rate) - rate * by_slack(by_e[:, k]) for k in (0, 1)])
        if not rate:
            shift += contacts.forcing
        forced = full @ N + shift
        force = (0.0 if rate else push - contacts.forcing.T) - N.T @ full
        offset = -N.T @ shift - (0.0 if rate else contacts.gradient)
        blocks.append((S.T @ full @ S, S.T @ forced, force @ S, force @ N + offset))
    m = ties.n_free
    A, B = np.zeros((m + 4, m + 4)), np.zeros((m + 4, m + 4))
    for target, (J, by_position, force, direct) in zip((A, B), blocks, strict=True):
        target[:m, :m], target[:m, m : m + 2] = J, by_position
        target[m : m + 2, :m], target[m : m + 2, m : m + 2] = -force, -direct
    B[m : m + 2, m + 2 :] = inertia * scales.length / scales.force * np.eye(2)
    A[m + 2 :, m + 2 :], B[m + 2 :, m : m + 2] = np.eye(2), -np.eye(2)
    s, left, right = la.eig(A, -B, left=True)
    with np.errstate(all="ignore"):
        weight = np.einsum("ik,ij,jk->k", left.conj(), -B, right)
        share = 2.0 * np.abs(np.sum(left[m : m + 2].conj() * right[m + 2 :], axis=0) / weight)
    share *= inertia * scales.length / scales.force
    finite = np.isfinite(s) & (np.abs(s) < 1e3)
    return s[finite], share[finite]


OPERATORS = {
    "plain": (plain((24, 8)), 30.0, (0.05, 1.0, 20.0)),
    "petals": (case("paper_n8", **{"model.cells_per_pitch": 16, "operation.speed": 8000.0}), 20.0, (1e-4, 0.1, 5.0)),
    "petals touching": (case("paper_n8", **{"model.cells_per_pitch": 16, "operation.speed": 1500.0}), 20.0, (0.1,)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(OPERATORS))
def test_modes_are_the_eigenvalues_of_the_whole_operator(name: str) -> None:
    """Each found mode is one, with its participation; and each one in which the rotor takes part is found."""
    bearing, load, masses = OPERATORS[name]
    motion = SmallMotion.about(operating_point(bearing, (0.0, -load)).answer)
    Z = whirl_impedance(motion)
    for mass in masses:
        inertia = mass * bearing.operation.speed**2
        modes = natural_modes(Z, Inertia.of_mass(mass), bearing.operation.speed)
        s, share = whole_operator(motion, inertia)
        assert modes
        for mode in modes:
            near = int(np.argmin(np.abs(s - mode.s)))
            assert abs(s[near] - mode.s) <= 1e-6 * max(abs(mode.s), 1e-2)
            assert_allclose(mode.participation, share[near], rtol=1e-4, atol=1e-6)
        ours = (s.imag >= 0.0) & (-s.real < 0.98 * PEAK * np.abs(s)) & (np.abs(s) < 3.0) & (share > 1e-2)
        for wanted in s[ours]:
            assert min(abs(mode.s - wanted) for mode in modes) <= 1e-6 * max(abs(wanted), 1e-2)


MICRO = """
[bearing]
journal_radius = "1.5 mm"
bushing_radius = "1.6 mm"
length = "3 mm"
[petals]
count = 4
arc_length = "3.5 mm"
thickness = "40 um"
bend_radius = "2 mm"
mount = "clamped"
material = "inconel x-750"
[gas]
name = "helium"
ambient_pressure = "1 bar"
temperature = "20 degC"
[surface]
contact_film_thickness = "0.3 um"
[operation]
speed = "500000 rpm"
load = "0.2 N"
[rotor]
mass = "5 g"
[model]
kind = "2d"
slip = true
cells_per_pitch = 32
petal_cells = 16
"""
"""Four stiff petals that press the journal: a backward whirl grows by 2 1/s at 461 000 rpm, and no mass is critical."""


@pytest.mark.slow
def test_a_mode_that_grows_below_the_critical_mass_leaves_no_threshold_speed() -> None:
    """The critical mass is followed to find one; far above, it falls below the rotor's."""
    found = stability(Case.from_toml(MICRO))
    assert np.max(found["mode_growth_rate"].values) > 0.0
    assert float(found["critical_mass"]) > float(found["rotor_mass"])
    assert math.isnan(float(found["threshold_speed"]))
    assert "no threshold speed: a mode of the rotor grows already" in str(found["status"])


@pytest.mark.slow
def test_a_mode_that_hardly_grows_is_neutral_and_so_is_one_that_hardly_decays() -> None:
    """A growth of 2 1/s at 461 000 rpm, and a map of states that decay at 0.005 1/s, were unstable and stable."""
    found = stability.record(Case.from_toml(MICRO))
    assert 0.0 < np.max(found.fields["mode_growth_rate"]) < NEUTRAL_DAMPING * found.fields["natural_frequency"].max()
    assert ": neutral, growth rate" in str(found.scalars["verdict"])
    petals = case("paper_n8", **{"model.cells_per_pitch": 16})
    for bearing in (petals, petals.replace(rotor={"mass": 2.0})):
        for record in stability.records(bearing, loads=[20.0], speeds=[4000.0, 8000.0]):
            assert ": neutral, growth rate -0.0" in str(record.scalars["verdict"])
            assert "a mode is neutral" in str(record.scalars["status"])
            assert record.scalars["critical_mass"] == math.inf
            assert any(warning.startswith("verdict: ") for warning in record.warnings)
