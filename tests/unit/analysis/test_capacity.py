"""The largest load within limits: the limit holds there and fails beyond, warm speeds are cheap, refusals."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import petalfoil
from petalfoil import plot
from petalfoil.analysis.capacity import FOLLOWED_ON, SOUGHT_ANEW, TABLE
from petalfoil.analysis.load_limit import ENDS_IN_A_SNAP, NONE_KEPT
from petalfoil.case import Case
from petalfoil.equilibrium import at_limit as at_limit_module
from petalfoil.equilibrium.at_limit import LoadedState, LoadLimit
from petalfoil.equilibrium.element_tangent import NoPointsError
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.results.summary import ABSENT, number
from petalfoil.solvers.near_factor import FactorAtHand
from tests.cases import case
from tests.random_packs import random_case

PLAIN = case("plain_journal", **{"model.cells_per_pitch": 24, "model.axial_cells": 6})
BUMPS = case("bump_foil", **{"model.cells_per_pitch": 24, "model.axial_cells": 6})
PETALS = case("paper_n8", **{"model.cells_per_pitch": 16})

WITHOUT = (0, 10, 11, 14, 28, 46, 70)
"""Random bearings none of whose loads keeps a film of 1.5 um."""

LIMITS = {
    "film of a plain bore": (PLAIN, {"min_film_thickness": 5e-6}, "min_film_thickness", 5e-6),
    "film over bumps": (BUMPS, {"min_film_thickness": 5e-6}, "min_film_thickness", 5e-6),
    "film under petals": (PETALS, {"min_film_thickness": 4e-6}, "min_film_thickness", 4e-6),
    "contact on bumps": (BUMPS, {"contact_fraction": 0.02}, "contact_fraction", 0.02),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if "petals" in name else ()) for name in LIMITS]
)
def test_the_limit_holds_at_the_answer_and_fails_beyond(name: str) -> None:
    bearing, limit, result, allowed = LIMITS[name]
    found = petalfoil.capacity(bearing, **limit)
    assert str(found["limited_by"].item()) == result
    assert float(found[result]) == pytest.approx(allowed, rel=1.1e-6)
    assert float(found["residual"]) <= 1e-8
    load = float(found["load_capacity"])
    at, beyond = (petalfoil.balance(bearing, factor * load) for factor in (1.0, 1.01))
    assert float(at[result]) == pytest.approx(allowed, rel=2e-6)
    worse = 1.0 if result == "contact_fraction" else -1.0
    assert worse * (float(beyond[result]) - allowed) > 1e-4 * allowed


@pytest.mark.slow
def test_the_first_limit_counts() -> None:
    stress = float(petalfoil.balance(PETALS, "20 N")["max_bending_stress"])
    both = petalfoil.capacity(PETALS, min_film_thickness=4e-6, max_stress=stress)
    assert float(both["max_bending_stress"]) == pytest.approx(stress, rel=1.1e-6)
    assert float(both["load_capacity"]) == pytest.approx(20.0, rel=1e-3)  # the stress is that of assembly, mostly
    assert str(both["limited_by"].item()) == "max_bending_stress"
    film = petalfoil.capacity(PETALS, min_film_thickness=4e-6, max_stress=2.0 * stress)
    assert str(film["limited_by"].item()) == "min_film_thickness"
    assert float(film["load_capacity"]) > 21.0


@pytest.mark.parametrize(
    "bearing",
    [
        pytest.param(PLAIN, id="plain"),
        pytest.param(BUMPS, id="bumps"),
        pytest.param(PETALS, id="petals", marks=pytest.mark.slow),
    ],
)
def test_warm_speeds_take_few_factorisations(bearing: Case) -> None:
    speed = bearing.operation.speed
    found = petalfoil.capacity(bearing, min_film_thickness=4e-6, speeds=list(speed * np.linspace(0.9, 1.0, 5)))
    assert np.all(np.diff(found["load_capacity"]) > 0.0)
    assert int(found["factorizations"][1:].max()) <= 6
    assert plot.capacity(found).axes
    assert set(str(name) for name in found["limited_by"].to_numpy()) == {"min_film_thickness"}


@pytest.mark.slow
@pytest.mark.parametrize("bearing", [PLAIN, BUMPS], ids=["plain", "bumps"])
def test_speeds_a_tenth_apart_take_six_factorisations_at_most(bearing: Case) -> None:
    speeds = list(bearing.operation.speed * np.linspace(0.6, 1.0, 5))
    found = petalfoil.capacity(bearing, min_film_thickness=4e-6, speeds=speeds)
    assert np.all(np.diff(found["load_capacity"]) > 0.0)
    assert int(found["factorizations"][1:].max()) <= 6
    for k in (1, 4):
        cold = petalfoil.capacity(bearing, min_film_thickness=4e-6, speed=speeds[k])
        assert float(cold["load_capacity"]) == pytest.approx(float(found["load_capacity"][k]), rel=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cells", "parts"),
    [
        pytest.param(32, np.linspace(0.6, 1.0, 5), id="tenths"),
        pytest.param(64, np.array([0.95, 0.975, 1.0]), id="petals come to lie on each other"),
    ],
)
def test_contact_points_are_followed_over_speeds(cells: int, parts: np.ndarray) -> None:
    """Contacts that appear ask for no factorisation: none or one a speed, where it was up to eight and thirty."""
    petals = case("paper_n8", **{"model.cells_per_pitch": cells})
    speeds = list(petals.operation.speed * parts)
    found = petalfoil.capacity(petals, min_film_thickness=4e-6, speeds=speeds)
    assert np.all(found["factorizations"].to_numpy()[1:] <= 2)
    assert np.all(found["probe_factorizations"].to_numpy()[1:] == 0)
    assert float(found["residual"].max()) <= 1e-8
    cold = petalfoil.capacity(petals, min_film_thickness=4e-6, speed=speeds[-1])
    assert float(cold["load_capacity"]) == pytest.approx(float(found["load_capacity"][-1]), rel=1e-6)


@pytest.mark.slow
def test_a_load_that_cannot_be_followed_is_sought_anew_and_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    speeds = list(PETALS.operation.speed * np.array([0.95, 1.0]))
    followed = petalfoil.capacity(PETALS, min_film_thickness=4e-6, speeds=speeds)
    assert not followed["jump"].any()
    assert SOUGHT_ANEW not in followed["solution_path"].to_numpy()
    tried: list[float] = []

    def at_limit(start: LoadedState, limit: LoadLimit, hand: FactorAtHand) -> LoadedState:
        tried.append(start.equations.problem.bearing_number)
        if len(set(tried)) > 1:
            raise NoPointsError("lost")
        return honest(start, limit, hand)

    honest = at_limit_module.at_limit
    monkeypatch.setattr(at_limit_module, "at_limit", at_limit)
    anew = petalfoil.capacity(PETALS, min_film_thickness=4e-6, speeds=speeds)
    assert anew["jump"].to_numpy().tolist() == [False, True]
    assert str(anew["solution_path"].to_numpy()[1]) == SOUGHT_ANEW
    first = tried[0]
    parts = [round(math.log(number / first) / math.log(max(tried) / first), 9) for number in dict.fromkeys(tried)]
    assert parts == [0.0, 1.0, 0.5, 0.25, 0.125]  # the whole way, its half, ... before it is given up
    assert float(anew["load_capacity"][1]) == pytest.approx(float(followed["load_capacity"][1]), rel=1e-5)


@pytest.mark.slow
def test_asperities_are_followed_too() -> None:
    stiff = case("paper_n10", **{"model.cells_per_pitch": 32})
    speeds = list(stiff.operation.speed * np.array([0.9, 0.925]))
    found = petalfoil.capacity(stiff, min_film_thickness=3e-6, speeds=speeds)
    assert np.all(found["factorizations"][1:] <= 6)
    assert found["min_film_thickness"].to_numpy() == pytest.approx(3e-6, rel=1e-6)


def test_the_load_coefficient_is_the_load_over_projected_area_and_surface_speed() -> None:
    found = petalfoil.capacity(BUMPS, min_film_thickness=5e-6)
    volume, speed = 50e-3 * 50e-3**2, BUMPS.operation.speed
    assert float(found["load_coefficient"]) == pytest.approx(float(found["load_capacity"]) / (volume * speed))
    pounds, krpm = float(found["load_capacity"]) / 4.4482216, speed * 30.0 / math.pi / 1e3
    expected = pounds / (volume / 0.0254**3) / krpm
    assert float(found["load_coefficient_imperial"]) == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_turning_the_load_is_turning_the_petals_back() -> None:
    turned = petalfoil.capacity(PETALS, min_film_thickness=4e-6, orientations=3)
    angles = turned["load_orientation"].to_numpy()
    assert angles == pytest.approx(-math.pi / 2.0 + math.pi / 12.0 * np.arange(3))
    over = turned["capacity_over_direction"].to_numpy()
    assert float(turned["load_capacity"]) == over[0]
    assert float(turned["least_load_capacity"]) == over.min() < over.max()
    assert float(turned["least_capacity_direction"]) == angles[over.argmin()]
    back = petalfoil.capacity(PETALS.replace(**{"petals.first_root": -math.pi / 12.0}), min_film_thickness=4e-6)
    assert float(back["load_capacity"]) == pytest.approx(over[1], rel=1e-5)
    assert plot.capacity(turned).axes


def test_error_bars_contain_the_capacity_of_a_fine_grid() -> None:
    """Of load, position under it and all else but the film, which is the limit that was given."""
    of = PLAIN.replace(**{"model.kind": "2d", "model.cells_per_pitch": 64})
    asked = {"min_film_thickness": 5e-6}
    found = petalfoil.capacity.record(of, **asked, error=True)
    fine = petalfoil.capacity.record(of.replace(**{"model.cells_per_pitch": 512}), **asked)
    assert found.errors is not None
    told = {"load_capacity", "load_coefficient", "eccentricity_y", "peak_pressure", "friction_torque"}
    assert told <= {*found.errors}
    assert not {"min_film_thickness", "knudsen_number"} & {*found.errors}
    for name, bar in found.errors.items():
        assert abs(float(fine.scalars[name]) - float(found.scalars[name])) <= bar
    load, bar = float(found.scalars["load_capacity"]), found.errors["load_capacity"]
    assert 0.0 < bar < 0.01 * load
    assert found.fields["capacity_over_direction_error"] == pytest.approx([bar])
    (_, shown, *_) = TABLE.columns.values()
    assert shown(found, 0) == f"{number(load)} ± {number(bar)}"


def test_a_bearing_that_keeps_to_no_limit_says_so() -> None:
    with pytest.raises(ConvergenceError, match="limits: min_film_thickness at the smallest load: 25 µm < 26 µm"):
        petalfoil.capacity(PLAIN, min_film_thickness=26e-6)
    series = petalfoil.capacity(PLAIN, min_film_thickness=26e-6, speeds=[1e3, 2e3])
    assert not series["converged"].any()
    assert np.all(np.isnan(series["capacity_over_direction"]))
    assert series["film_under_smallest_load"].values[0, 0] == pytest.approx(25e-6, rel=1e-3)


def test_directions_without_any_load_are_told_with_their_films() -> None:
    """A result with the films in place of an error; no pack is said to be bottomed out."""
    none = petalfoil.capacity(case(**{"model.cells_per_pitch": 12}), min_film_thickness="90 um", orientations=2)
    assert not none["converged"]
    assert "min_film_thickness at the smallest load" in none["status"].item()
    assert none["film_under_smallest_load"].shape == (2,)
    assert np.all(none["film_under_smallest_load"] < 90e-6)


def test_the_table_over_directions_has_no_column_without_an_entry() -> None:
    directions = {"load_orientation": np.array([0.0, 0.1])}
    none = np.full(2, math.nan)
    shown = [
        [line[1:] for line in TABLE.lines(Record(analysis="capacity", scalars={}, fields=fields, coords=directions))]
        for fields in (
            {"capacity_over_direction": np.array([1.0, 2.0]), "film_under_smallest_load": none},
            {"capacity_over_direction": none, "film_under_smallest_load": np.array([math.nan, 1.2e-6])},
        )
    ]
    assert shown == [[[1.0, ABSENT], [2.0, ABSENT]], [[ABSENT, ABSENT], [ABSENT, pytest.approx(1.2)]]]


@pytest.mark.slow
def test_a_limit_that_is_not_reached_bounds_the_load_from_below() -> None:
    endless = petalfoil.capacity(PETALS, max_stress="90 GPa")
    assert "beyond it" in str(endless["status"].item()) or "no limit is reached" in str(endless["status"].item())
    assert str(endless["limited_by"].item()) == ""
    assert float(endless["max_bending_stress"]) < 90e9


@pytest.mark.parametrize(
    ("bearing", "arguments", "words"),
    [
        (PLAIN, {}, "needs a limit: give --min-film, --contact-fraction or --max-stress"),
        (PLAIN, {"min_film_thickness": "0.5 um"}, "surfaces touch at surface.contact_film_thickness, 1 um"),
        (PLAIN, {"max_stress": "1 GPa"}, "the rigid wall of this case reports none"),
        (PLAIN, {"min_film_thickness": "5 um", "orientations": 4}, "is the same in all directions"),
        (PLAIN, {"min_film_thickness": "5 um", "speed": 0.0}, "needs a turning shaft"),
    ],
)
def test_what_says_nothing_is_refused(bearing: Case, arguments: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError, match=words):
        petalfoil.capacity(bearing, **arguments)


@pytest.mark.slow
def test_petals_that_stretch_have_a_capacity_too() -> None:
    """Friction brings displacements along the petals among the unknowns, on which the film does not act."""
    stretching = PETALS.replace(**{"petals.theory": "shell", "surface.petal_friction": 0.1})
    found, bending = (petalfoil.capacity(one, min_film_thickness=3e-6) for one in (stretching, PETALS))
    assert float(found["load_capacity"]) == pytest.approx(float(bending["load_capacity"]), rel=1e-6)
    assert float(found["min_film_thickness"]) == pytest.approx(3e-6, rel=1.1e-6)


@pytest.mark.slow
def test_a_heated_bearing_tells_its_temperatures_at_the_capacity() -> None:
    hot = case("rig_hot", **{"model.cells_per_pitch": 24})
    found = petalfoil.capacity(hot, contact_fraction=0.01)
    at = petalfoil.balance(hot, float(found["load_capacity"]))
    for result in ("contact_fraction", "film_temperature", "bushing_temperature"):
        assert float(found[result]) == pytest.approx(float(at[result]), rel=1e-5)


CONTINUOUS = (9, 20, 26)
"""Random bearings whose load changes continuously with the speed, three of ten between numbers 0 and 27."""


@pytest.mark.slow
@pytest.mark.parametrize("seed", CONTINUOUS)
def test_random_bearings_are_followed_over_speeds(seed: int) -> None:
    bearing = random_case(np.random.default_rng(seed), **{"model.cells_per_pitch": 16})
    speeds = list(bearing.operation.speed * np.array([0.9, 0.95, 1.0]))
    found = petalfoil.capacity(bearing, min_film_thickness=1.5e-6, speeds=speeds)
    assert not found["jump"].any()
    assert int(found["factorizations"][1:].max()) <= 2
    assert found["min_film_thickness"].to_numpy() == pytest.approx(1.5e-6, rel=1.1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 14])
def test_bearings_without_a_capacity_are_looked_at_again_where_it_was_nearest(seed: int) -> None:
    """Both touch the journal under hardly any load, 14 between nodes that have films of 2.5 um."""
    bearing = random_case(np.random.default_rng(seed), **{"model.cells_per_pitch": 16})
    speeds = list(bearing.operation.speed * np.array([0.9, 0.95, 1.0]))
    none = petalfoil.capacity(bearing, min_film_thickness=1.5e-6, speeds=speeds)
    assert not none["converged"].any()
    assert int(none["factorizations"][1:].max()) <= 2
    assert all(NONE_KEPT in str(status) for status in none["status"].to_numpy()[1:])
    assert np.all(none["film_under_smallest_load"] < 1.5e-6)  # at later speeds too


@pytest.mark.slow
def test_a_capacity_that_appears_is_found() -> None:
    """At 0.95 of its speed the film is below 1.5 um under hardly any load, at its speed above."""
    bearing = random_case(np.random.default_rng(6), **{"model.cells_per_pitch": 16})
    speeds = [0.95 * bearing.operation.speed, bearing.operation.speed]
    both = petalfoil.capacity(bearing, min_film_thickness=1.5e-6, speeds=speeds)
    assert both["converged"].to_numpy().tolist() == [False, True]
    alone = petalfoil.capacity(bearing, min_film_thickness=1.5e-6)
    assert float(both["load_capacity"][1]) == pytest.approx(float(alone["load_capacity"]), rel=1e-4)
    assert float(both["min_film_thickness"][1]) == pytest.approx(1.5e-6, rel=1.1e-6)
    assert int(both["factorizations"][1]) <= 6


@pytest.mark.slow
def test_a_load_at_which_the_bearing_snaps_is_the_largest_of_its_branch() -> None:
    """At 2.096 N the branch of bearing 23 turns back with a film of 2.7 um; under 0.1 % more it touches the journal."""
    bearing = random_case(np.random.default_rng(23), **{"model.cells_per_pitch": 16})
    speeds = list(bearing.operation.speed * np.array([0.95, 1.0]))
    found = petalfoil.capacity(bearing, min_film_thickness=1.5e-6, speeds=speeds)
    assert found["load_capacity"].to_numpy() == pytest.approx([2.2058, 2.0961], rel=1e-4)
    assert [str(status) for status in found["status"].to_numpy()] == [ENDS_IN_A_SNAP] * 2
    assert found["limited_by"].to_numpy().tolist() == ["", ""]
    assert int(found["factorizations"][1]) <= 6
    assert str(found["solution_path"].to_numpy()[1]) == FOLLOWED_ON
    beyond = petalfoil.balance(bearing, 1.001 * float(found["load_capacity"][1]))
    assert float(beyond["min_film_thickness"]) < 1.5e-6


@pytest.mark.slow
def test_contacts_at_nodes_do_not_bound_a_load() -> None:
    """Under 96.9 N contacts of bearing 9 at nodes leave 1.1 um, points 2.5: its capacity was told 96.8 N, in a jump."""
    bearing = random_case(np.random.default_rng(9), **{"model.cells_per_pitch": 16})
    found = petalfoil.capacity(bearing, min_film_thickness=1.5e-6)
    assert str(found["status"].item()) == "converged"
    assert float(found["min_film_thickness"]) == pytest.approx(1.5e-6, rel=1.1e-6)
    assert float(found["load_capacity"]) > 100.0


def found_or_bounded(seed: int, least: float = 1.5e-6) -> str:
    """How the search on a random bearing ended; the state that it gives keeps to the limit."""
    bearing = random_case(np.random.default_rng(seed), **{"model.cells_per_pitch": 16})
    (record,) = petalfoil.capacity.records(bearing, min_film_thickness=least, speeds=[bearing.operation.speed])
    if not record.converged:
        assert re.search("no load keeps to the limits|undecided", str(record.scalars["status"]))
        return "none" if "no load keeps" in str(record.scalars["status"]) else "undecided"
    film = float(record.scalars["min_film_thickness"])
    assert film >= least * (1.0 - 1.1e-6)
    assert float(record.scalars["residual"]) <= 1e-8
    if str(record.scalars["limited_by"]):
        assert film == pytest.approx(least, rel=1.1e-6)
        return "found"
    return str(record.scalars["status"])


@pytest.mark.long
def test_random_bearings_are_found_or_bounded() -> None:
    """Of a hundred, how many: recorded in docs/how-to/load-capacity.md."""
    ended = [found_or_bounded(seed) for seed in range(100)]
    assert ended.count("found") >= 40
    assert ended.count("undecided") == 0


@pytest.mark.long
@pytest.mark.parametrize("seed", WITHOUT)
def test_where_no_load_keeps_the_film_none_of_a_scan_does(seed: int) -> None:
    """Balances from nothing, one by one: no search, no neighbour."""
    bearing = random_case(np.random.default_rng(seed), **{"model.cells_per_pitch": 16})
    assert found_or_bounded(seed) == "none"
    unit = bearing.gas.ambient_pressure * 2.0 * bearing.bearing.journal_radius * bearing.bearing.length
    for part in np.geomspace(1e-5, 0.3, 9):
        at = petalfoil.balance(bearing, part * unit)
        assert float(at["min_film_thickness"]) < 1.5e-6
