"""Limits and symmetries that every coupled answer must meet."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.testing import assert_allclose

from petalfoil.analysis.solve import solve
from petalfoil.analysis.static import static
from petalfoil.case import Case
from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from tests.cases import case

PAPER = case("paper_n8", **{"model.cells_per_pitch": 32})


def force(record: Record) -> np.ndarray[Any, Any]:
    return np.array([record.scalars["force_x"], record.scalars["force_y"]], dtype=float)


def turned(vector: np.ndarray[Any, Any], angle: float) -> np.ndarray[Any, Any]:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "edges"), [("2d", "ambient"), ("3d", "ambient"), ("3d", "continuous")])
def test_turning_by_one_pitch_turns_the_answer(kind: str, edges: str) -> None:
    base = PAPER.replace(
        **{"model.kind": kind, "model.edges": edges, "model.cells_per_pitch": 16, "model.axial_cells": 4}
    )
    e = np.array([30e-6, -110e-6])
    pitch = base.petals.pitch  # type: ignore[union-attr]
    here = solve.record(base, eccentricity=(float(e[0]), float(e[1])))
    there = solve.record(base, eccentricity=tuple(float(v) for v in turned(e, pitch)))  # type: ignore[arg-type]
    size = np.abs(force(here)).max()
    assert_allclose(force(there), turned(force(here), pitch), rtol=0, atol=1e-10 * size)
    assert_allclose(np.roll(here.fields["pressure"], 1, axis=0), there.fields["pressure"], rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("contacts", "exact"), [("nodes", 1e-10), ("points", 1e-9)])
def test_turning_pack_and_displacement_turns_the_force(contacts: str, exact: float) -> None:
    """To what the last Newton step leaves; with contact points it is one with the factor at hand."""
    bearing = PAPER.replace(**{"model.contacts": contacts})
    e, angle = np.array([0.0, -150e-6]), 0.377
    here = solve.record(bearing, eccentricity=(0.0, -150e-6))
    there = solve.record(
        bearing.replace(**{"petals.first_root": angle}),
        eccentricity=tuple(float(v) for v in turned(e, angle)),  # type: ignore[arg-type]
    )
    assert_allclose(force(there), turned(force(here), angle), rtol=0, atol=exact * np.abs(force(here)).max())


def film_alone(bearing: Case, H: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Pressure over a rigid wall of film thickness `H` (reference lengths), by Newton on the film only."""
    problem = build_problem(bearing)
    balance: FilmBalance = problem.layout.balance
    P = np.ones(balance.mesh.n_unknown)
    for _ in range(60):
        fluxes = balance.fluxes(balance.nodal_pressure(P), H, problem.bearing_number)
        places, values = balance.by_pressure, balance.tangent(fluxes)[0]
        J = sp.coo_array((values, (places.rows, places.cols)), shape=(len(P), len(P))).tocsc()
        step = spla.spsolve(J, -balance.residual(fluxes))
        P = P + min(1.0, float(0.8 * np.min(P / np.maximum(-step, 1e-300)))) * step
        if np.max(np.abs(step)) < 1e-13:
            return balance.nodal_pressure(P)
    raise AssertionError("the film alone did not converge")


@pytest.mark.slow
def test_stiff_petals_are_the_rigid_stepped_bearing() -> None:
    """`E / p_a -> infinity`: petals keep the shape of the assembled pack, and the film is that of a rigid bearing.

    Viscosity falls with the ambient pressure, so that the film's own equation stays the same.
    """
    errors = []
    for thin in (1.0, 0.1, 0.01):
        changes = {"gas.ambient_pressure": 1e5 * thin, "gas.viscosity": 1.85e-5 * thin}
        changes |= {"petals.youngs_modulus": 1e13, "operation.speed": 2000.0, "operation.eccentricity": (0.0, -50e-6)}
        stiff = PAPER.replace(**changes, **{"model.contacts": "nodes"})  # the shape that is taken is that of nodes
        record = solve.record(stiff)
        rest = next(static.records(stiff, (50e-6,)))
        shape = rest.fields["radius"][:, -stiff.cells_per_pitch - 1 :]
        theta = record.coords["root_angle"][:, None] + record.coords["phi_exposed"]
        h = shape - 0.5 * stiff.petals.total_thickness - stiff.bearing.journal_radius
        h = h + 50e-6 * np.sin(theta)[..., None]
        assert h.min() == pytest.approx(stiff.surface.contact_film_thickness, rel=1e-6)
        p = film_alone(stiff, h / build_problem(stiff).layout.scales.length) * stiff.gas.ambient_pressure
        errors.append(float(np.max(np.abs(record.fields["pressure"] - p)) / p.max()))
    assert errors[-1] < 1e-3
    assert_allclose(np.array(errors[:-1]) / np.array(errors[1:]), 10.0, rtol=0.3)  # first order in p_a / E


@pytest.mark.slow
def test_slow_shaft_leaves_ambient_pressure_and_the_static_pack() -> None:
    rest = next(static.records(PAPER, (100e-6,)))
    errors = []
    for speed in (1e-2, 1e-3, 1e-4):
        slow = solve.record(PAPER, speed=speed, eccentricity=(0.0, -100e-6))
        errors.append(float(np.max(slow.fields["pressure"]) / 1e5 - 1.0))
        defect = np.abs(force(slow) - force(rest)).max() / float(rest.scalars["bearing_force"])
        assert defect < 10.0 * errors[-1]
    assert errors[-1] < 1e-3
    assert_allclose(np.array(errors[:-1]) / np.array(errors[1:]), 10.0, rtol=0.1)  # first order in speed


def test_a_shaft_at_rest_is_the_static_pack() -> None:
    rest = next(static.records(PAPER, (100e-6,)))
    still = solve.record(PAPER, speed=0.0, eccentricity=(0.0, -100e-6))
    assert_allclose(force(still), force(rest), rtol=1e-9, atol=1e-9 * float(rest.scalars["bearing_force"]))
    assert still.scalars["contact_fraction"] == pytest.approx(1.0)


@pytest.mark.slow
def test_half_and_whole_length_agree() -> None:
    half = PAPER.replace(**{"model.kind": "3d", "model.cells_per_pitch": 16, "model.axial_cells": 6})
    half = half.replace(**{"petals.theory": "inextensible"})  # petals that stretch: test_stretching_petals.py
    whole = half.replace(**{"model.symmetry": False})
    a, b = solve.record(half), solve.record(whole)
    for name in (
        "force_x",
        "force_y",
        "friction_torque",
        "side_leakage",
        "min_film_thickness",
        "peak_pressure",
        "max_bending_stress",
    ):
        assert_allclose(b.scalars[name], a.scalars[name], rtol=1e-8)
    assert_allclose(b.fields["pressure"], a.fields["pressure"], rtol=1e-9)


def test_contact_and_film_forces_sum_to_the_reaction() -> None:
    record = solve.record(PAPER, speed=1000.0, eccentricity=(0.0, -250e-6))
    s, z = record.scalars, record.coords["z"]
    theta = record.coords["root_angle"][:, None] + record.coords["phi_exposed"]
    cell = np.zeros(theta.shape[1])
    cell[:-1] += 0.5 * np.diff(record.coords["phi_exposed"])
    cell[1:] += 0.5 * np.diff(record.coords["phi_exposed"])
    length, R_j = PAPER.bearing.length, PAPER.bearing.journal_radius
    push = (record.fields["pressure"][..., 0] - 1e5) * R_j * cell * length
    assert len(z) == 1
    assert_allclose(-np.sum(push * np.cos(theta)), s["film_force_x"], rtol=1e-12)
    assert_allclose(-np.sum(push * np.sin(theta)), s["film_force_y"], rtol=1e-12)
    assert_allclose(s["film_force_y"] + s["contact_force_y"], s["force_y"], rtol=1e-12)  # type: ignore[operator]
    assert float(s["contact_normal_force"]) > 1.0  # the case touches: contact is part of the sum
