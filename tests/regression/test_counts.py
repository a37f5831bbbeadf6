"""Numbers of factorisations that must not grow: of cold starts, of curves, of packs at zero speed."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.analysis.curve import curve
from petalfoil.analysis.solve import solve
from petalfoil.analysis.stability import stability
from petalfoil.case import Case
from petalfoil.equilibrium.branches import coarse, probe
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.pack_at_rest import at_rest
from petalfoil.equilibrium.run_context import running
from petalfoil.equilibrium.small_motion import AT_POINTS
from petalfoil.system.build import build_problem
from tests.cases import case
from tests.random_packs import random_case
from tests.verification.test_results_from_points import TEN

PACKAGES = ("paper_n6", "paper_n8", "paper_n10")
DISPLACEMENTS = (0.0, 100e-6, 200e-6, 280e-6)

COLD_AT_32 = 20
"""Worst cold start on 32 cells per pitch, pack included; 19 when this was written (required: 30)."""


def bearing(name: str, cells: int, e: float = 0.0) -> Case:
    return case(name, **{"model.cells_per_pitch": cells, "operation.eccentricity": (0.0, -e)})


def cold(cells: int) -> list[int]:
    counts = []
    for name in PACKAGES:
        for e in DISPLACEMENTS:
            with running() as run:
                solve_cold(build_problem(bearing(name, cells, e)))
            counts.append(run.film.factorizations + run.pack.factorizations)
    return counts


@pytest.mark.slow
def test_cold_starts_cost_the_same_on_any_grid() -> None:
    coarse, fine = cold(32), cold(128)
    assert max(coarse) <= COLD_AT_32
    assert max(fine) <= 30
    assert np.median(fine) <= 1.5 * np.median(coarse)
    assert max(fine) <= 1.5 * max(coarse)


@pytest.mark.slow
def test_cold_starts_on_the_finest_grid() -> None:
    """Sixteen times finer than 32 cells: the median holds; one start of twelve takes longer (43 seen)."""
    fine = cold(512)
    assert np.median(fine) <= 1.5 * np.median(cold(32))
    assert np.sort(fine)[-2] <= 30


COSTS = ("factorizations", "pack_iterations", "probe_factorizations")

SPEED, LOW_SPEED = 8000.0, 2000.0
"""Speeds of the curves [rad/s]."""


def warm(cells: int, speeds: tuple[float, ...], contacts: str = "nodes") -> list[int]:
    counts: list[int] = []
    for name in PACKAGES:
        for speed in speeds:
            asked = bearing(name, cells).replace(**{"model.contacts": contacts})
            points = curve.records(asked, np.linspace(0.0, 280e-6, 15), speed=speed)
            records = list(points)
            assert all(record.converged for record in records)
            assert not any(record.scalars["jump"] for record in records)
            counts += [int(record.scalars["factorizations"]) for record in records[1:]]
    return counts


def check_warm_counts(counts: list[int]) -> None:
    assert np.median(counts) <= 5  # 4 when this was written (required: 8)
    assert max(counts) <= 20  # 16 (required: 25)


@pytest.mark.slow
def test_warm_points_of_a_curve() -> None:
    check_warm_counts(warm(32, (SPEED,)))


@pytest.mark.slow
def test_contact_points_add_few_factorisations_to_a_curve() -> None:
    """A point or two where sets of contacts keep changing take dozens (88 at most, ten petals)."""
    counts = np.array(warm(32, (SPEED,), "points"))
    assert np.median(counts) <= 5
    assert np.quantile(counts, 0.9) <= 16


@pytest.mark.slow
def test_warm_points_cost_the_same_on_a_fine_grid() -> None:
    coarse, fine = (warm(cells, (SPEED, LOW_SPEED)) for cells in (32, 128))
    check_warm_counts(coarse)
    assert np.median(fine) <= 1.5 * np.median(coarse)
    assert max(fine) <= min(25, 1.5 * max(coarse))


@pytest.mark.parametrize("cells", [32, 256])
@pytest.mark.parametrize("name", PACKAGES)
def test_pack_from_nothing(name: str, cells: int) -> None:
    with running() as run:
        assert at_rest(build_problem(bearing(name, cells))) is not None
    assert run.pack.factorizations <= 20


@pytest.mark.parametrize("packs", [4, pytest.param(100, marks=pytest.mark.slow)])
def test_random_packs(packs: int) -> None:
    """Cold with the pack at zero speed, and three displacements grown by 2 % each; medians 14 and 1 of 200 packs."""
    rng, from_nothing, followed = np.random.default_rng(1), [], []
    for _ in range(packs):
        problem = build_problem(random_case(rng))
        with running() as run:
            found = solve_cold(problem)
        from_nothing.append(run.film.factorizations + run.pack.factorizations)
        for grown in (1.02, 1.04, 1.06):
            with running() as run:
                found, _ = advance(found, problem.at(displacement=grown * problem.displacement))
            followed.append(run.film.factorizations + run.pack.factorizations)
    assert np.median(from_nothing) <= 20
    assert np.median(followed) <= 3
    assert max(followed) <= 8  # 5


def test_other_equilibria_are_looked_for_along_one_path_of_the_pack() -> None:
    """Of all three attempts 40 when this was written, 47 with a path of the pack for each."""
    with running() as run:
        assert probe(build_problem(coarse(random_case(np.random.default_rng(1))))) == 1
    assert run.probes.factorizations <= 42


@pytest.mark.slow
def test_a_cold_start_with_all_that_is_asked_about_it() -> None:
    """Film, pack, growth rate and other equilibria of random packs; medians with contacts at nodes."""
    rng, counts = np.random.default_rng(2024), []
    for _ in range(40):
        s = solve.record(random_case(rng, **{"model.contacts": "nodes"})).scalars
        counts.append(sum(int(s[key]) for key in COSTS))  # type: ignore[call-overload]
    assert np.median(counts) <= 20


@pytest.mark.slow
@pytest.mark.parametrize("name", list(TEN))
def test_answers_with_contact_points_cost_the_same_on_fine_grids(name: str) -> None:
    """Pack, film, contact points, growth rate and other equilibria, on 32 cells 14 to 21 when this was written.

    On finer grids two or three, and 12 to 18 under the coarse film.
    """
    for cells in (32, 64, 512):
        s = solve.record(TEN[name].replace(**{"model.cells_per_pitch": cells})).scalars
        own = sum(int(s[key]) for key in COSTS)  # type: ignore[call-overload]
        assert s["contact_model"] == AT_POINTS
        assert own <= (21 if cells == 32 else 3)
        assert own + int(s["coarse_factorizations"]) <= (21 if cells == 32 else 20)  # type: ignore[call-overload]


@pytest.mark.slow
def test_a_threshold_speed_is_followed() -> None:
    """Ten speeds up to 16 times the case's; 43 factorisations when this was written, 194 with each balance anew."""
    found = stability.record(bearing("paper_n8", 32), load=(0.0, -20.0), mass=40.0)
    assert "end of the search" in str(found.scalars["status"])
    assert int(found.scalars["factorizations"]) <= 60  # type: ignore[call-overload]


@pytest.mark.slow
def test_contact_lines_lead_along_a_curve_in_3d() -> None:
    """Median 1 and at most 2 when this was written; 2 and 4 with a tangent a set, 6 and 16 from contacts at nodes."""
    bearing = case("paper_n8_spatial", **{"model.cells_per_pitch": 24, "model.axial_cells": 16})
    records = list(curve.records(bearing, np.linspace(0.0, 280e-6, 15)))
    assert all(record.converged for record in records)
    counts = [int(record.scalars["factorizations"]) for record in records[1:]]
    assert np.median(counts) <= 1.5
    assert max(counts) <= 5


@pytest.mark.slow
@pytest.mark.parametrize("down", [0.0, 200e-6])
def test_a_position_in_3d_from_nothing(down: float) -> None:
    """On the default grid 2 and 3 when this was written; 3 and 6 with a tangent for each set, 22 before that."""
    told = solve.record(case("paper_n8_spatial", **{"operation.eccentricity": (0.0, -down)})).scalars
    assert told["converged"]
    assert told["pack_iterations"] == 0
    assert int(told["factorizations"]) <= 5  # type: ignore[call-overload]
    assert 0 < int(told["coarse_factorizations"]) <= 40  # type: ignore[call-overload]
