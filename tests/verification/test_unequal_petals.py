"""Packs of unequal petals: equal lists are the scalar, turned packs are the same pack, single petals add up to all."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose, assert_array_equal

import petalfoil
from petalfoil.analysis.derivatives import DerivativesOf, equilibrium_results
from petalfoil.analysis.operating_point import at_position
from petalfoil.case import Case
from petalfoil.case.pack_geometry import solid_height
from petalfoil.case.parameters import parameter_of, with_values
from petalfoil.errors import DefinitionError, UnitError, UsageError
from petalfoil.walls import build_wall
from tests.cases import case
from tests.verification.resolved import compared

COUNT = 8
EQUAL = case(**{"model.cells_per_pitch": 8})
FIELDS = ("thickness", "coating", "bend_radius", "root_tilt", "youngs_modulus", "poisson_ratio")
SCATTER = np.array([3.0, -5.0, 1.0, 4.0, -2.0, 5.0, -3.0, -4.0]) * 1e-6


def listed(of: Case) -> Case:
    """The same case with a list for every field that may be one."""
    return of.replace(**{f"petals.{name}": [getattr(of.petals, name)] * COUNT for name in FIELDS})


def scattered(of: Case = EQUAL, turn: int = 0) -> Case:
    """A pack whose thicknesses and bend radii scatter, its list turned by some petals."""
    thickness = of.petals.thickness + SCATTER
    bend_radius = of.petals.bend_radius * (1.0 + 40.0 * SCATTER[::-1])
    return of.replace(
        **{"petals.thickness": np.roll(thickness, turn), "petals.bend_radius": np.roll(bend_radius, turn)}
    )


def assert_same(one: xr.Dataset, other: xr.Dataset) -> None:
    """All numbers but the time that was spent have the same bits."""
    for name in one.data_vars:
        if one[name].dtype.kind == "f" and name != "wall_time":
            assert_array_equal(one[name].values, other[name].values, err_msg=str(name))


SMALL_3D = {"model.kind": "3d", "model.cells_per_pitch": 6, "model.axial_cells": 4}
"""Petals stretch, as by default in 3-D."""


@pytest.mark.parametrize(
    "changes",
    [
        {},
        pytest.param(SMALL_3D, marks=pytest.mark.slow),
        pytest.param({"petals.mount": "clamped"}, marks=pytest.mark.slow),
    ],
    ids=["2d", "3d", "clamped"],
)
def test_equal_lists_are_the_scalar_to_the_bit(changes: dict[str, object]) -> None:
    of = EQUAL.replace(**changes)
    assert_same(petalfoil.solve(of), petalfoil.solve(listed(of)))


def test_the_wall_of_equal_lists_has_the_same_bits() -> None:
    rough = EQUAL.replace(**{"surface.petal_friction": 0.2})
    one, other = build_wall(rough), build_wall(listed(rough))
    assert_array_equal(one.contacts.rest, other.contacts.rest)
    for name in ("slip", "support", "free_motions", "reaction_share"):
        assert_array_equal(getattr(one, name).toarray(), getattr(other, name).toarray())
    assert_array_equal(one.elasticity.stiffness.toarray(), other.elasticity.stiffness.toarray())


def test_gaps_of_unequal_petals_are_between_their_faces() -> None:
    of = scattered()
    wall, packs = build_wall(of), of.packs
    phi, lines = wall.contacts.lines[2].phi, wall.contacts.rest[wall.contacts.lines[2].number]
    pitch = 2.0 * np.pi / COUNT
    for petal in range(COUNT):
        below = packs[(petal + 1) % COUNT]
        outer = packs[petal].free_radius(phi) + 0.5 * packs[petal].thickness
        inner = below.free_radius(phi - pitch) - 0.5 * below.thickness
        assert_allclose(lines[petal], inner - outer, atol=1e-15)
    on_bushing = wall.contacts.rest[wall.contacts.lines[1].number]
    outer = packs[3].free_radius(wall.contacts.lines[1].phi) + 0.5 * packs[3].thickness
    assert_allclose(on_bushing[3], of.bearing.bushing_radius - outer, atol=1e-15)


@pytest.mark.slow
def test_a_pack_whose_list_is_turned_is_the_same_pack_turned() -> None:
    one = petalfoil.solve(scattered())
    pitch = 2.0 * np.pi / COUNT
    other = petalfoil.solve(scattered(turn=1).replace(**{"petals.first_root": -pitch}))
    for name in ("bearing_force", "min_film_thickness", "friction_torque", "max_bending_stress"):
        assert_allclose(other[name], one[name], rtol=1e-7)


@pytest.mark.slow
def test_slopes_of_equal_lists_are_those_of_the_scalar_and_turn_with_the_pack() -> None:
    of = EQUAL.replace(**{"operation.load": (0.0, -20.0), "operation.eccentricity": (0.0, 0.0)})
    one, other = petalfoil.coefficients(of), petalfoil.coefficients(listed(of))
    assert_allclose(other["stiffness"], one["stiffness"], rtol=1e-12)
    here = petalfoil.coefficients(scattered(of))
    turned = petalfoil.coefficients(scattered(of, turn=1).replace(**{"petals.first_root": -2.0 * np.pi / COUNT}))
    largest = float(np.abs(here["stiffness"]).max())
    assert_allclose(turned["stiffness"], here["stiffness"], atol=1e-5 * largest)
    assert float(np.abs(here["stiffness"] - one["stiffness"]).max()) > 1e-3 * largest


def test_a_pack_of_unequal_petals_converges_under_a_load() -> None:
    found = petalfoil.balance(scattered(), "20 N")
    assert float(found["residual"]) < 1e-8
    assert float(found["force_residual"]) < 1e-8
    assert float(found["reaction_balance_error"]) < 1e-9
    assert abs(float(found["eccentricity_x"])) > 1e-8  # equal petals let the journal sink straight down


def test_the_papers_method_is_for_equal_petals() -> None:
    with pytest.raises(DefinitionError, match=r"model\.method: the paper's method is for equal petals"):
        scattered().replace(**{"model.method": "classic"})
    assert listed(EQUAL).replace(**{"model.method": "classic"}).model.method.value == "classic"


# ---------------------------------------------------------------------------------------------- derivatives


@pytest.mark.slow
def test_derivatives_by_single_petals_add_up_to_that_by_all() -> None:
    few = case("paper_n6", **{"model.cells_per_pitch": 6})
    derivatives = DerivativesOf(few, at_position(few).answer, equilibrium_results)
    by_all = derivatives.by("petals.thickness").above
    singles = [derivatives.by(f"petals.thickness[{petal}]").above for petal in range(few.petals.count)]
    for name in ("force_x", "force_y", "peak_pressure", "friction_torque"):
        terms = [single[name] for single in singles]
        assert_allclose(sum(terms), by_all[name], rtol=1e-7, atol=1e-7 * np.max(np.abs(terms)))


@pytest.mark.slow
def test_the_derivative_by_one_petal_of_an_unequal_pack() -> None:
    of = scattered()
    derivatives = DerivativesOf(of, at_position(of).answer, equilibrium_results)
    comparisons = [compared(derivatives, path) for path in ("petals.thickness[6]", "petals.bend_radius[2]")]
    assert any(comparison.clear for comparison in comparisons)
    assert all(comparison.error < 1e-6 for comparison in comparisons)


# ---------------------------------------------------------------------------------------------- definitions


def test_a_case_with_lists_is_written_and_read_again() -> None:
    of = scattered(listed(EQUAL))
    assert Case.from_toml(of.to_toml()) == of


def test_one_petal_of_equal_ones_may_be_changed_by_its_path() -> None:
    changed = with_values(EQUAL, {"petals.thickness[3]": "0.18 mm"})
    assert changed.petals.thickness == tuple(1.8e-4 if petal == 3 else 1.76e-4 for petal in range(COUNT))
    assert parameter_of(changed, "petals.thickness[3]").value == 1.8e-4


def test_the_solid_pack_is_as_high_as_its_thickest_neighbours() -> None:
    of = with_values(EQUAL, {"petals.thickness[0]": 2.0e-4, "petals.thickness[7]": 1.9e-4})
    layers = of.pack.layers
    assert solid_height(of.petals, layers) == pytest.approx(2.0e-4 + 1.9e-4 + (layers - 2) * 1.76e-4, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "given", "refusal", "message"),
    [
        ("thickness", [1e-4] * 7, DefinitionError, r"petals\.thickness: has 7 values for petals\.count = 8; allowed"),
        ("thickness", ["0.1 mm"] * 7 + ["3 kg"], UnitError, r"petals\.thickness: of petal 7: '3 kg' measures"),
        ("youngs_modulus", [2e11] * 7 + [0.0], DefinitionError, r"of petal 7: 0(\.0)? .*greater than 0 Pa"),
        (
            "bend_radius",
            [0.04] * 5 + [3e-3] + [0.04] * 2,
            DefinitionError,
            r"petals\.bend_radius\[5\]: a chordal petal",
        ),
        ("root_tilt", ["chordal"] * 7 + ["radial"], DefinitionError, r"of petal 7: 'radial' is neither 'chordal' nor"),
        ("arc_length", [0.045] * 8, UnitError, r"petals\.arc_length"),
        ("thickness", [0.176e-3] * 7 + [0.9e-3], DefinitionError, "the foil pack does not fit: 3 layers of"),
    ],
)
def test_lists_that_do_not_fit_are_refused(
    name: str, given: list[object], refusal: type[Exception], message: str
) -> None:
    with pytest.raises(refusal, match=message):
        EQUAL.replace(**{f"petals.{name}": given})


def test_a_petal_that_is_not_there_is_no_parameter() -> None:
    with pytest.raises(DefinitionError, match=r"petals\.thickness\[8\]"):
        parameter_of(EQUAL, "petals.thickness[8]")
    with pytest.raises((DefinitionError, UsageError), match=r"petals\.arc_length\[0\]"):
        parameter_of(EQUAL, "petals.arc_length[0]")
