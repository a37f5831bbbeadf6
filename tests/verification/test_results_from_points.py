"""Results of 2-D packs are those of contact points: one equilibrium, one tangent, one balance."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from numpy.typing import NDArray

import petalfoil
from petalfoil.analysis.derivatives import DerivativesOf, equilibrium_results
from petalfoil.analysis.impedance import elastic, impedances
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings
from petalfoil.case import Case
from petalfoil.case.parameters import parameter_of, with_values
from petalfoil.equilibrium.contact_sets import TravellingContact, split
from petalfoil.equilibrium.nodal_state import NodalState
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_POINTS, HELD_AT_NODES
from petalfoil.errors import DefinitionError
from tests.cases import case
from tests.random_packs import random_case
from tests.verification.test_contact_slopes import BEARINGS, apart

Array = NDArray[np.float64]

COARSE = {"model.cells_per_pitch": 32}
PLACED = ("contact_petal", "contact_facing", "contact_angle", "contact_force", "contact_bending_stress")


def solved(cells: int, **changes: object) -> xr.Dataset:
    """Eight petals at 200 um."""
    return petalfoil.solve(case("paper_n8", **{"model.cells_per_pitch": cells, **changes}), eccentricity=(0.0, -200e-6))


@pytest.mark.slow
def test_forces_and_stress_converge_at_second_order() -> None:
    """Force components on 32, 64, 128 cells per pitch; with contacts at nodes they go back and forth by 0.03 N."""
    x, y, stress = (
        np.array([solved(cells)[name].item() for cells in (32, 64, 128)])
        for name in ("force_x", "force_y", "max_bending_stress")
    )
    for values in (x, y, stress):
        coarse, fine = np.diff(values)
        assert np.log2(coarse / fine) >= 1.7
    assert abs(y[2] - y[1]) <= 1e-3 * y[2]
    assert abs(stress[2] - stress[1]) <= 2e-4 * stress[2]


def test_the_preload_does_not_depend_on_the_films_grid() -> None:
    """At rest the petals alone decide: the same to 1e-7; with contacts at nodes it differs by 0.8 %."""
    preload = [
        petalfoil.static(case("paper_n8", **{"model.cells_per_pitch": cells}))["contact_normal_force"].item()
        for cells in (32, 64)
    ]
    assert_allclose(preload[1], preload[0], rtol=1e-7)


def test_a_load_is_carried_where_the_result_says() -> None:
    """The force at the position of a balance, asked for by itself, is the load."""
    bearing = case("paper_n8", **COARSE)
    balanced = petalfoil.balance(bearing, (3.0, -20.0))
    assert balanced["force_residual"].item() <= 1e-9
    place = (balanced["eccentricity_x"].item(), balanced["eccentricity_y"].item())
    there = petalfoil.solve(bearing, eccentricity=place)
    assert_allclose([there["force_x"].item(), there["force_y"].item()], [-3.0, 20.0], atol=1e-6)


def test_reactions_at_nodes_are_those_of_the_points() -> None:
    """Shared by two nodes they keep normal force and, to second order, force on the journal; places are told."""
    bearing = case("paper_n8", **{"model.cells_per_pitch": 64})
    with running():
        answer = operating_point(bearing.replace(**{"operation.speed": 600.0}), None).answer
    assert answer.elements is not None
    state, points = NodalState.of(answer), answer.elements.points
    assert_allclose(state.lam.sum(), points.reaction.sum(), rtol=1e-12)
    assert_allclose(state.problem.contact_force(state.lam), state.contact_force, atol=2e-4 * state.lam.sum())
    ds = petalfoil.solve(bearing, speed=600.0)
    assert ds["contact_model"].item() == AT_POINTS
    assert all(ds[name].dims == ("contact",) for name in PLACED)
    on_journal = ds["contact_facing"] == 0
    assert_allclose(ds["contact_force"][on_journal].sum(), ds["contact_normal_force"], rtol=1e-12)
    theta = ds["root_angle"].values[ds["contact_petal"].values.astype(int)] + ds["contact_angle"].values
    push = -(ds["contact_force"] * np.exp(1j * theta))[on_journal].sum().item()
    assert_allclose([push.real, push.imag], [ds["contact_force_x"], ds["contact_force_y"]], atol=1e-9)


@pytest.mark.slow
def test_points_of_a_curve_may_have_other_contacts() -> None:
    """Shorter rows of contacts end in NaN."""
    curve = petalfoil.curve(case("paper_n8", **{"model.cells_per_pitch": 16}), "0 um : 240 um : 3", speed=600.0)
    counts = np.isfinite(curve["contact_force"]).sum("contact").values
    assert curve.sizes["contact"] == counts.max()
    assert np.all(counts > 0)


def test_contacts_at_nodes_when_asked() -> None:
    nodal = solved(16, **{"model.contacts": "nodes"})
    assert nodal["contact_model"].item() == HELD_AT_NODES
    assert "contact_force" not in nodal
    assert "nodal_force_difference" not in nodal
    assert not nodal.attrs.get("warnings")
    points = solved(16)
    assert 0.0 < points["nodal_force_difference"].item() <= 0.1
    force = [np.array([ds["force_x"].item(), ds["force_y"].item()]) for ds in (points, nodal)]
    difference = np.linalg.norm(force[0] - force[1]) / np.linalg.norm(force[1])
    assert_allclose(points["nodal_force_difference"].item(), difference, rtol=1e-6)


@pytest.mark.parametrize(("key", "value"), [("petal_cells", 8), ("petal_cells", 100), ("contacts", "lines")])
def test_refusals_name_the_key(key: str, value: object) -> None:
    with pytest.raises(DefinitionError, match=rf"model\.{key}"):
        case("paper_n8", **{f"model.{key}": value})


def test_a_point_with_low_gaps_beside_it_splits_in_two() -> None:
    """The halves are halfway to the gaps and keep the centroid of the reaction."""
    (first, second), left = split([TravellingContact(3, 10.0, 4.0, [])], [(3, 9.0, -1), (3, 10.5, 0)])
    assert left == []
    assert_allclose([first.position, second.position], [9.5, 10.25])
    assert_allclose(first.reaction + second.reaction, 4.0)
    assert_allclose(first.reaction * first.position + second.reaction * second.position, 40.0)
    (first, second), _ = split([TravellingContact(3, 10.0, 4.0, [])], [(3, 11.0, 0)])
    assert_allclose([first.position, second.position], [9.75, 10.5])
    stretch = [TravellingContact(3, 10.0, 4.0, [1.0]), TravellingContact(3, 12.0, 4.0, [])]
    assert split(stretch, [(3, 9.0, -1)]) == (stretch, [(3, 9.0, -1)])


@pytest.mark.parametrize("path", ["gas.viscosity", pytest.param("petals.thickness", marks=pytest.mark.slow)])
def test_derivatives_are_those_of_printed_equilibria(path: str) -> None:
    """Against central differences of balances solved again, within 3e-5 of the largest relative effect."""
    bearing = case("paper_n8", **{**COARSE, "operation.eccentricity": (0.0, 0.0), "operation.load": (0.0, -20.0)})
    value = parameter_of(bearing, path).value
    assert value is not None
    with running():
        found = DerivativesOf(bearing, operating_point(bearing, None).answer, equilibrium_results, as_points=True)
        exact, step, sides = found.by(path), 1e-4 * value, []
        for side in (-step, step):
            moved = with_values(bearing, {path: value + side})
            sides.append(equilibrium_results(moved, operating_point(moved, None).answer))
    assert not exact.at_kink
    names = ("min_film_thickness", "peak_pressure", "friction_torque", "max_bending_stress", "eccentricity_y")
    effects = [(exact.above[n] * value / found.values[n], n) for n in names]
    resolved = [(sides[1][n] - sides[0][n]) / (2.0 * step) * value / found.values[n] for n in names]
    largest = max(abs(effect) for effect, _ in effects)
    assert_allclose([effect for effect, _ in effects], resolved, rtol=0.0, atol=3e-5 * largest)


# ------------------------------------------------------------------------------------------ default grid, ten bearings

TEN = {
    **{name: BEARINGS[name] for name in BEARINGS if not name.startswith("random")},
    **{
        f"random {number}": random_case(np.random.default_rng(number), **{"model.cells_per_pitch": 128})
        for number in (1, 3, 6, 7, 9)
    },
}


CHANGES_WITHIN_TOLERANCE = "random 1"
"""Two sets of contacts fulfil the tolerances there, 0.03 N apart: differences over 0.01 um jump."""


MINUTES = ("random 1", "random 7")
"""Nodes of these settle late on four times the cells."""

LEAST_DIFFERENCE = 1e-5
"""Difference of stiffness from grid to grid, over the largest entry, below which its order is that of rounding."""


def duration(name: str) -> pytest.MarkDecorator:
    """What takes minutes is run by hand."""
    return pytest.mark.long if name in MINUTES else pytest.mark.slow


def on(bearing: Case, finer: int) -> Case:
    """The bearing on its grid or a finer one."""
    return bearing.replace(**{"model.cells_per_pitch": finer * bearing.cells_per_pitch})


def small_motions(bearing: Case) -> tuple[Array, Array, Array]:
    """Stiffness and damping [N/m, N s/m] at no frequency, and natural frequencies of a rotor of 2 kg [rad/s]."""
    with running():
        answer, speed = operating_point(bearing, None).answer, bearing.operation.speed
        rotor = RotorOnBearings(bearing, 2.0)
        impedance = rotor.impedance(answer)
        assert impedance.motion.contact_model == AT_POINTS
        ((K, C),) = impedances(elastic(bearing, answer), np.array([0.0]), speed)
        frequencies = np.array([mode.s.imag * speed for mode in rotor.modes(impedance, speed)])
    return K, C, frequencies


@pytest.mark.parametrize("name", [pytest.param(name, marks=duration(name)) for name in TEN])
def test_coefficients_and_frequencies_on_the_default_grid(name: str) -> None:
    """On the default grid, twice and four times as fine: K and C within 1 % of the largest, of order 1.5 at least from
    there, frequencies within 0.5 %. Measured: K 0.03 %, C 0.4 %, frequencies 0.02 %, order 1.8 to 2.1."""
    K, C, frequencies = zip(*(small_motions(on(TEN[name], finer)) for finer in (1, 2, 4)), strict=True)
    for matrices in (K, C):
        coarse, fine = apart(*matrices[:2]), apart(*matrices[1:])
        assert coarse <= 1e-2
        assert np.log2(coarse / fine) >= 1.5 or coarse <= LEAST_DIFFERENCE
    assert len(frequencies[0]) == len(frequencies[2]) == 2
    assert_allclose(frequencies[0], frequencies[1], rtol=5e-3)
    assert_allclose(frequencies[1], frequencies[2], rtol=1e-3)


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=duration(name)) for name in TEN if name != CHANGES_WITHIN_TOLERANCE]
)
def test_stiffness_is_the_slope_of_printed_forces(name: str) -> None:
    """Central differences over 0.01 um and 1 um, and the chord of 1 um between both, on the default grid."""
    bearing = TEN[name]
    with running():
        place = operating_point(bearing, None).answer.operating_state.displacement
    held = bearing.replace(**{"operation.load": None, "operation.eccentricity": tuple(place)})
    K = petalfoil.coefficients(held, [0.0])["stiffness"].values.reshape(2, 2)
    for step, within in ((0.01e-6, 2e-3), (1e-6, 1e-2)):
        columns = []
        for axis in np.eye(2):
            ends = [petalfoil.solve(held, eccentricity=tuple(place + side * step * axis)) for side in (-1.0, 1.0)]
            forces = [np.array([end["force_x"].item(), end["force_y"].item()]) for end in ends]
            columns.append(-(forces[1] - forces[0]) / (2.0 * step))
        assert apart(K, np.column_stack(columns)) <= within
