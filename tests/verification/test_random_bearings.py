"""Two hundred random packs: each converges, to an answer that an independent recomputation confirms."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.analysis.solve import solve
from petalfoil.case import Case, Edges, Mount
from petalfoil.errors import ConvergenceError
from petalfoil.mesh.axial import axis_2d
from petalfoil.mesh.pack import pack_mesh
from petalfoil.mesh.quadrature import trapezoid
from petalfoil.physics.shell import PetalShell
from petalfoil.results.record import Record
from tests.random_packs import random_case, wide_case

SEED = 2024


def kkt_residual(case: Case, record: Record) -> float:
    """Largest residual of the equations of a 2-D result, evaluated petal by petal from its published fields.

    Wall: `K W` of each petal against film and contact pressures on its nodes, over ambient pressure (and the digits
    that `K W` loses). Gaps: `|min(gap / 10 um, contact pressure / p_a)|` of all three kinds. Film: the flux (F2)
    through all faces of a strip must be the same.
    """
    petals, pack, p_a = case.petals, case.pack, case.gas.ambient_pressure
    assert petals is not None
    assert pack is not None
    mesh = pack_mesh(petals.count, pack.overlap, petals.first_root, case.cells_per_pitch, axis_2d(case.bearing.length))
    f = {name: values[..., 0] if values.ndim == 3 else values for name, values in record.fields.items()}
    return max(wall_defect(case, mesh, f) / p_a, gap_defect(case, mesh, f), film_defect(case, mesh, f))


def wall_defect(case, mesh, f) -> float:  # type: ignore[no-untyped-def]
    petals, pack = case.petals, case.pack
    shell = PetalShell(
        mesh.phi,
        mesh.axial,
        pack.metric_radius,
        petals.bend_radius,
        petals.bending_stiffness,
        petals.poisson_ratio,
        petals.mount is Mount.CLAMPED,
    )
    K, area = shell.stiffness, pack.metric_radius * mesh.arc_weight * case.bearing.length
    strip = pack.metric_radius * trapezoid(mesh.phi[mesh.exposed]) * case.bearing.length
    n, N = petals.count, case.cells_per_pitch
    worst = 0.0
    for petal in range(n):
        load = -f["bushing_contact_pressure"][petal] * area - f["petal_contact_pressure"][petal] * area
        below = f["petal_contact_pressure"][(petal - 1) % n, N:] * area[N:]  # the petal before lies on this one
        load[: len(below)] += below
        load[mesh.exposed] += f["journal_contact_pressure"][petal] * area[mesh.exposed]
        load[mesh.exposed] += (f["pressure"][petal] - case.gas.ambient_pressure) * strip
        lost = np.finfo(float).eps * 8.0 * (abs(K) @ np.abs(f["deflection"][petal])) / 1e-8
        defect = np.abs(K @ f["deflection"][petal] - load) / np.maximum(area, lost / case.gas.ambient_pressure)
        worst = max(worst, float(defect[1:].max()))
    return worst


def gap_defect(case, mesh, f) -> float:  # type: ignore[no-untyped-def]
    pack, R_B = case.pack, case.bearing.bushing_radius
    delta, N, p_a = pack.thickness, case.cells_per_pitch, case.gas.ambient_pressure
    r = f["radius"]
    pairs = [
        (f["film_thickness"] - case.surface.contact_film_thickness, f["journal_contact_pressure"]),
        (R_B - 0.5 * delta - r[:, 1:N], f["bushing_contact_pressure"][:, 1:N]),
        (np.roll(r, -1, axis=0)[:, : r.shape[1] - N] - r[:, N:] - delta, f["petal_contact_pressure"][:, N:]),
    ]
    return max(float(np.max(np.abs(np.minimum(gap / 1e-5, pressure / p_a)))) for gap, pressure in pairs)


def film_defect(case, mesh, f) -> float:  # type: ignore[no-untyped-def]
    """Spread of the mass flux along each strip over its terms, written out from (F2)."""
    p, h, mu = f["pressure"], f["film_thickness"], case.gas.viscosity
    U, dx = (
        case.operation.speed * case.bearing.journal_radius,
        case.bearing.journal_radius * np.diff(mesh.phi[mesh.exposed]),
    )
    p0, p1, h0, h1 = p[:, :-1], p[:, 1:], h[:, :-1], h[:, 1:]
    D = 2.0 * (h0 * h1) ** 2 / (h0 + h1) * 0.5 * (p0 + p1) / (12.0 * mu)
    pressure_flow = -D * (p1 - p0) / dx
    half_peclet = 0.25 * U * 0.5 * (h0 + h1) * dx / D
    fit = 1.0 / np.tanh(half_peclet) - 1.0 / half_peclet
    shear_flow = 0.25 * U * ((p0 * h0 + p1 * h1) - fit * (p1 * h1 - p0 * h0))
    total = pressure_flow + shear_flow
    size = np.abs(pressure_flow) + np.abs(shear_flow)
    return float(np.max(np.abs(np.diff(total, axis=1)) / (size[:, 1:] + size[:, :-1])))


def run_random(count: int, seed: int) -> tuple[list[tuple[Case, Record]], list[tuple[Case, ConvergenceError]]]:
    rng = np.random.default_rng(seed)
    solved, failed = [], []
    for _ in range(count):
        drawn = random_case(rng, **{"model.contacts": "nodes"})
        try:
            solved.append((drawn, solve.record(drawn)))
        except ConvergenceError as error:
            failed.append((drawn, error))
    return solved, failed


def check(solved: list[tuple[Case, Record]]) -> None:
    for drawn, record in solved:
        s = record.scalars
        assert s["residual"] <= 1e-8  # type: ignore[operator]
        assert s["mass_balance_error"] <= 1e-9  # type: ignore[operator]
        assert s["reaction_balance_error"] <= 1e-9  # type: ignore[operator]
        assert kkt_residual(drawn, record) <= 1e-7, drawn


@pytest.mark.slow
@pytest.mark.parametrize("count", [50, pytest.param(200, marks=pytest.mark.long)])
def test_random_packs(count: int) -> None:
    """Of a hundred 99 at least; the rest end in the typed error. (199 of 200 when this was written.)"""
    solved, failed = run_random(count, SEED)
    assert len(solved) >= 0.99 * count
    assert all(error.history and error.advice for _, error in failed)
    check(solved)


@pytest.mark.long
def test_two_hundred_random_packs_with_contact_points() -> None:
    """199 at least. (All 200 when this was written: 130 at points, 64 over asperities, 6 at nodes.)"""
    rng, records, failed = np.random.default_rng(SEED), [], []
    for _ in range(200):
        try:
            records.append(solve.record(random_case(rng)).scalars)
        except ConvergenceError as error:
            failed.append(error)
    assert all(error.history and error.advice for error in failed)
    assert len(records) >= 199
    for s in records:
        assert s["residual"] <= 1e-8  # type: ignore[operator]
        assert s["mass_balance_error"] <= 1e-9  # type: ignore[operator]
        assert s["reaction_balance_error"] <= 1e-9  # type: ignore[operator]


@pytest.mark.slow
@pytest.mark.parametrize("edges", [Edges.AMBIENT, Edges.CONTINUOUS])
def test_four_bearings_of_the_whole_domain(edges: Edges) -> None:
    """Their contact fraction is a share, also where the film sucks."""
    for number in range(4):
        record = solve.record(wide_case(np.random.default_rng([number, SEED]), **{"model.edges": edges}))
        s = record.scalars
        assert s["residual"] <= 1e-8  # type: ignore[operator]
        assert s["mass_balance_error"] <= 1e-9  # type: ignore[operator]
        assert s["reaction_balance_error"] <= 1e-9  # type: ignore[operator]
        assert 0.0 <= s["contact_fraction"] <= 1.0  # type: ignore[operator]


@pytest.mark.slow
def test_continuous_edges_and_a_coating() -> None:
    """In 3-D."""
    rng = np.random.default_rng(SEED + 2)
    changes = {"model.kind": "3d", "model.edges": Edges.CONTINUOUS, "petals.coating": 5e-6}
    for _ in range(4):
        drawn = random_case(rng, **changes, **{"model.cells_per_pitch": 16, "model.axial_cells": 6})
        record = solve.record(drawn)
        assert record.scalars["residual"] <= 1e-8  # type: ignore[operator]
