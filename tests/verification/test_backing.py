"""Backing springs behind petals: the law of their contact, limits, slopes, loss, and every command on them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import petalfoil
from petalfoil.analysis import known_verbs
from petalfoil.case import Case
from petalfoil.walls.backing import covered
from petalfoil.walls.bump_foil import foundation_stiffness
from petalfoil.walls.petals import PetalWall, build_mesh
from tests.cases import case

COARSE = {"model.cells_per_pitch": 16, "model.axial_cells": 4}


def backed(**changes: object) -> Case:
    """The example on a coarse grid."""
    return case("backed_petals", **{**COARSE, **changes})


def stiffness_of(of: Case) -> float:
    """Its foundation stiffness [Pa/m]."""
    assert of.backing is not None
    return foundation_stiffness(of.backing)


@pytest.mark.parametrize("kind", ["2d", pytest.param("3d", marks=pytest.mark.slow)])
def test_crowns_carry_what_petals_press_on_them_and_no_petal_passes_them(kind: str) -> None:
    bearing = backed(**{"model.kind": kind})
    point = petalfoil.balance(bearing, "60 N")
    assert bearing.backing is not None
    pack = bearing.pack
    assert pack is not None
    pressure, V, r = (point[name].to_numpy() for name in ("bushing_contact_pressure", "backing_deflection", "radius"))
    start = bearing.backing.start / bearing.bearing.bushing_radius
    share = covered(build_mesh(bearing), start)[:, None]
    behind = slice(1, bearing.cells_per_pitch)
    gap = (pack.metric_radius + V - r)[:, behind] - np.where(share > 0.0, bearing.backing.height, 0.0)
    pressed = share * stiffness_of(bearing) * V[:, behind]
    assert float(point["max_backing_deflection"]) == V.max() > 20e-6
    assert_allclose(np.where(share > 0.0, pressure[:, behind], 0.0), pressed, rtol=1e-7, atol=1e-7 * pressure.max())
    assert gap.min() > -1e-13
    assert pressure.min() >= 0.0
    assert np.abs(gap * pressure[:, behind]).max() < 1e-13 * pressure.max()
    assert (gap > 1e-6).any()


@pytest.mark.slow
def test_stiff_springs_are_a_rigid_bushing() -> None:
    """In 3-D, where contacts of both lie at nodes."""
    grid = {"model.kind": "3d", "model.cells_per_pitch": 16, "model.axial_cells": 4, "model.contacts": "nodes"}
    rigid = case("rig", **{**grid, "operation.eccentricity": ("5 um", "-8 um"), "petals.theory": "inextensible"})
    bearing_force = float(petalfoil.solve(rigid)["bearing_force"])
    off = [
        float(petalfoil.solve(rigid.replace(backing={"foundation_stiffness": k}))["bearing_force"]) / bearing_force - 1
        for k in (1e15, 1e16)
    ]
    assert abs(off[1]) < 1e-5
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.01)


@pytest.mark.slow
def test_springs_out_of_reach_change_nothing() -> None:
    """The pack of eight petals does not touch the bushing: nor does it touch crowns at the bushing radius."""
    alone = backed(backing=None, **{"model.contacts": "nodes"})
    assert petalfoil.solve(alone)["bushing_contact_pressure"].max() == 0.0
    behind = petalfoil.solve(alone.replace(backing={"foundation_stiffness": "1 GPa/m"}))
    assert float(behind["bearing_force"]) == pytest.approx(float(petalfoil.solve(alone)["bearing_force"]), rel=1e-10)
    assert float(behind["max_backing_deflection"]) == 0.0


@pytest.mark.slow
def test_derivatives_by_the_springs_are_those_of_bearings_solved_again() -> None:
    paths = ("backing.foundation_stiffness", "backing.height")
    bearing = backed(backing={"foundation_stiffness": "2 GPa/m", "height": "60 um"})
    table = petalfoil.sensitivity(bearing, ", ".join(paths), load="60 N", contacts="nodes")
    found = dict(zip(table["parameter"].to_numpy().tolist(), table["derivative"].to_numpy().tolist(), strict=True))
    quantity = str(table["quantity"].to_numpy()[0])
    for path in paths:
        value = getattr(bearing.backing, path.partition(".")[2])
        ends = [petalfoil.balance(bearing.replace(**{path: value * factor}), "60 N") for factor in (1 - 1e-4, 1 + 1e-4)]
        low, high = (float(end[quantity]) for end in ends)
        assert found[path] == pytest.approx((high - low) / (2e-4 * value), rel=1e-4)


@pytest.mark.slow
def test_stiffness_is_the_slope_of_the_force_and_converges() -> None:
    """Contacts of petals on each other lie at nodes in forces: on 256 cells both slopes agree to some per cent."""
    springs = {"backing": {"foundation_stiffness": "2 GPa/m"}}
    fine = case("rig", **{"model.cells_per_pitch": 256, "operation.eccentricity": ("0 um", "-10 um"), **springs})
    K = petalfoil.coefficients(fine, frequencies="0 Hz")["stiffness"].to_numpy().reshape(2, 2)
    forces = [
        [float(petalfoil.solve(fine.replace(**{"operation.eccentricity": (0.0, y)}))[f"force_{axis}"]) for axis in "xy"]
        for y in (-10.5e-6, -9.5e-6)
    ]
    assert_allclose(K[:, 1], (np.array(forces[0]) - np.array(forces[1])) / 1e-6, atol=0.02 * np.abs(K).max())
    half = petalfoil.coefficients(fine.replace(**{"model.cells_per_pitch": 128}), frequencies="0 Hz")["stiffness"]
    assert_allclose(half.to_numpy().reshape(2, 2), K, atol=0.01 * np.abs(K).max())


@pytest.mark.slow
def test_the_loss_damps_whirl_in_proportion() -> None:
    bearings = [backed(**{"backing.loss_factor": gamma}) for gamma in (0.0, 0.01, 0.02)]
    answers = [petalfoil.coefficients(one, load="60 N", frequencies="3000 rad/s") for one in bearings]
    damping = [answer["damping"].sel(row=1, column=1).item() for answer in answers]
    assert damping[1] > damping[0]
    assert damping[2] - damping[0] == pytest.approx(2.0 * (damping[1] - damping[0]), rel=1e-3)


@pytest.mark.slow
def test_the_energy_of_a_motion_is_accounted_for() -> None:
    rotor = {"mass": "1 kg", "unbalance": "10 um"}
    lossy, coarse, free = (
        petalfoil.orbit(
            backed(rotor=rotor, **{"backing.loss_factor": g}), revolutions=2.0, load="60 N", tolerance=tolerance
        )
        for g, tolerance in ((0.5, 1e-4), (0.5, 1e-3), (0.0, 1e-4))
    )
    assert float(lossy["energy_balance_error"]) < 5e-4
    assert float(lossy["energy_balance_error"]) < 0.3 * float(coarse["energy_balance_error"])
    assert float(np.ravel(lossy["petal_friction_work"])[-1]) > 0.0
    assert "petal_friction_work" not in free or float(np.abs(free["petal_friction_work"]).max()) == 0.0


def test_an_isolated_wall_keeps_its_petals() -> None:
    bearing = backed()
    assert bearing.backing is not None
    bare, springs = PetalWall().build(bearing.replace(backing=None)), PetalWall().build(bearing)
    n = bare.n_unknown
    assert (springs.elasticity.stiffness[:n, :n] != bare.elasticity.stiffness).nnz == 0
    assert springs.elasticity.stiffness[n:, :n].nnz == 0


def test_a_strip_covers_what_lies_behind_its_start() -> None:
    """The stiffness of all springs is that of the area of the strips, wherever between two nodes they begin."""
    for start in ("0 mm", "6 mm", "6.3 mm"):
        bearing = backed(**{"backing.start": start})
        assert bearing.backing is not None
        assert bearing.petals is not None
        pack = bearing.pack
        assert pack is not None
        bare, springs = PetalWall().build(bearing.replace(backing=None)), PetalWall().build(bearing)
        n, area = bare.n_unknown, pack.metric_radius * bearing.bearing.length * bearing.petals.count
        per_cell = bearing.petals.pitch / bearing.cells_per_pitch
        # cells from node to node: the first half of one is the root's
        begin = max(bearing.backing.start / bearing.bearing.bushing_radius, 0.5 * per_cell)
        covered = area * (bearing.petals.pitch - 0.5 * per_cell - begin)
        stiffness = springs.elasticity.stiffness[n:, n:].sum()
        assert stiffness == pytest.approx(stiffness_of(bearing) * covered, rel=2e-2)


VERBS: dict[str, Callable[[Case], xr.Dataset]] = {
    "solve": petalfoil.solve,
    "converge": lambda of: petalfoil.converge(of, levels=2, coarsest=16),
    "curve": lambda of: petalfoil.curve(of, "0 um : 100 um : 2"),
    "static": petalfoil.static,
    "balance": lambda of: petalfoil.balance(of, "30 N"),
    "capacity": lambda of: petalfoil.capacity(of, min_film_thickness="4 um"),
    "liftoff": lambda of: petalfoil.liftoff(of, "10 N"),
    "runup": lambda of: petalfoil.runup(of, "10 N", to="20000 rpm", points=3),
    "coefficients": lambda of: petalfoil.coefficients(of, load="30 N", frequencies="3000 rad/s"),
    "stability": lambda of: petalfoil.stability(of, load="30 N", mass="1 kg"),
    "orbit": lambda of: petalfoil.orbit(of.replace(rotor={"mass": "1 kg"}), revolutions=0.05, load="30 N"),
    "sensitivity": lambda of: petalfoil.sensitivity(of, "backing.height", load="30 N"),
    "check": petalfoil.check,
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["2d", "3d"])
@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_answers(verb: str, kind: str) -> None:
    assert set(VERBS) == set(known_verbs.summaries())
    result = VERBS[verb](backed(**{"model.kind": kind}))
    if verb != "check":
        assert np.all(result["converged"])


ROTOR = {"mass": 6.0, "span": 0.2, "transverse_inertia": 0.02, "polar_inertia": 0.002}
BESIDE: dict[str, Callable[[], xr.Dataset]] = {
    "two bearings": lambda: petalfoil.stability(backed(rotor=ROTOR, **{"model.kind": "3d"}), load="60 N"),
    "a tilted journal": lambda: petalfoil.solve(backed(**{"model.kind": "3d", "operation.tilt": (1e-4, 0.0)})),
    "friction": lambda: petalfoil.static(backed(**{"surface.petal_friction": 0.1}), "0 um : 50 um : 2"),
    "unequal petals": lambda: petalfoil.solve(backed(**{"petals.thickness": (*[0.176e-3] * 7, 0.18e-3)})),
    "clamped petals": lambda: petalfoil.solve(backed(**{"petals.mount": "clamped"})),
    "continuous edges": lambda: petalfoil.balance(backed(**{"model.edges": "continuous"}), "60 N"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", BESIDE)
def test_springs_go_with_the_other_tables(name: str) -> None:
    result = BESIDE[name]()
    assert np.all(result["converged"])
    assert float(np.max(result["residual"])) <= 1e-8
