"""Equal problems have equal answers: a pack turned by a pitch, all pressures tripled, all lengths doubled."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from petalfoil.analysis.curve import curve
from petalfoil.analysis.solve import point
from petalfoil.case import Case, Edges, Gas
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from tests.random_packs import wide_case

SEED = 31
EQUAL = 1e-8
"""Difference of forces over the normal forces on the journal that is rounding and the tolerance of the residual."""

LENGTHS = {
    "bearing": ("journal_radius", "bushing_radius", "length"),
    "petals": ("arc_length", "thickness", "coating", "bend_radius"),
    "surface": ("contact_film_thickness",),
}


def turned(case: Case) -> tuple[Case, float]:
    """The petals numbered from the next one on."""
    assert case.petals is not None
    return case.replace(**{"petals.first_root": case.petals.first_root + case.petals.pitch}), 1.0


def tripled(case: Case) -> tuple[Case, float]:
    """All pressures three times as high, speeds and lengths as they were; and the factor on forces."""
    assert case.petals is not None
    gas = gas_of(case, viscosity=3.0 * case.gas.viscosity, ambient_pressure=3.0 * case.gas.ambient_pressure)
    return case.replace(gas=gas, **{"petals.youngs_modulus": 3.0 * case.petals.youngs_modulus}), 3.0


def doubled(case: Case) -> tuple[Case, float]:
    """All lengths twice as large, mean free path included; and the factor on forces."""
    changes: dict[str, object] = {
        f"{section}.{name}": 2.0 * getattr(getattr(case, section), name)
        for section, names in LENGTHS.items()
        for name in names
    }
    changes["operation.eccentricity"] = tuple(2.0 * e for e in case.operation.eccentricity)
    return case.replace(gas=gas_of(case, gas_constant=4.0 * case.gas.gas_constant), **changes), 4.0


def gas_of(case: Case, **changes: float) -> Gas:
    """The gas of a case by its numbers, some of them changed."""
    names = ("viscosity", "ambient_pressure", "temperature", "gas_constant")
    return Gas(**{**{name: getattr(case.gas, name) for name in names}, **changes})


@cache
def drawn(number: int) -> tuple[Case, Record | None]:
    """A random bearing with ambient edges and its answer, contacts at nodes: asperities have a height of their own."""
    changes = {"model.edges": Edges.AMBIENT, "model.cells_per_pitch": 16, "model.contacts": "nodes"}
    case = wide_case(np.random.default_rng([number, SEED]), **changes)
    return case, solved(case)


def solved(case: Case) -> Record | None:
    try:
        return point(case)
    except ConvergenceError:
        return None


def difference(one: Record, other: Record, factor: float) -> float:
    """Largest difference of forces over the normal forces on the journal, those of `other` divided by `factor`."""
    a, b = ({k: float(r.scalars[k]) for k in ("force_x", "force_y", "contact_normal_force")} for r in (one, other))
    film = np.hypot(float(one.scalars["film_force_x"]), float(one.scalars["film_force_y"]))
    size = a["contact_normal_force"] + film + np.hypot(a["force_x"], a["force_y"])
    return max(abs(b[name] / factor - a[name]) for name in a) / float(size)


def names_branches(record: Record) -> bool:
    """The record says that it is one of several equilibria."""
    return int(record.scalars["known_equilibria"]) > 1


def compare(numbers: range, change: Callable[[Case], tuple[Case, float]]) -> list[int]:
    """Numbers of the bearings that have an answer which another statement of the same problem does not have."""
    apart = []
    for number in numbers:
        case, one = drawn(number)
        twin, factor = change(case)
        other = solved(twin)
        if one is None or other is None:
            if one is not other:
                apart.append(number)
        elif difference(one, other, factor) > EQUAL and not (names_branches(one) and names_branches(other)):
            apart.append(number)
    return apart


CHANGES = pytest.mark.parametrize("change", [turned, tripled, doubled])


@pytest.mark.slow
@pytest.mark.parametrize("change", [turned, tripled, doubled])
def test_two_bearings(change: Callable[[Case], tuple[Case, float]]) -> None:
    assert compare(range(2), change) == []


@pytest.mark.slow
@CHANGES
def test_forty_bearings(change: Callable[[Case], tuple[Case, float]]) -> None:
    assert compare(range(40), change) == []


@pytest.mark.slow
@CHANGES
def test_a_bearing_that_most_starts_do_not_answer(change: Callable[[Case], tuple[Case, float]]) -> None:
    """Of bearing 96 rounding decides which starts lead somewhere, and one leads to another equilibrium."""
    assert compare(range(96, 97), change) == []


@pytest.mark.slow
@pytest.mark.parametrize("contacts", ["nodes", "points"])
def test_a_bearing_that_takes_many_steps(contacts: str) -> None:
    """Of bearing 103 rounding decides whether the first start leads anywhere, after 75 steps; no other start does.

    Whether it does or not, the answer is the one to which the pack is followed from zero speed.
    """
    case = drawn(103)[0].replace(**{"model.contacts": contacts})
    records = [
        solved(case.replace(**{"petals.youngs_modulus": (1.0 + share) * case.petals.youngs_modulus}))
        for share in (0.0, 1e-13, -1e-13, 1e-12)
    ]
    first, *rest = [record for record in records if record is not None]
    assert len(rest) == 3
    assert all("followed from the assembled pack" in str(record.scalars["solution_path"]) for record in (first, *rest))
    assert [difference(first, record, 1.0) <= EQUAL for record in rest] == [True, True, True]


@pytest.mark.slow
def test_a_point_past_a_jump_says_that_there_are_several() -> None:
    """Bearing 38: the curve ends on another equilibrium than `solve` finds, which knows of one."""
    case, one = drawn(38)
    assert one is not None
    x, y = case.operation.eccentricity
    way = np.linspace(0.0, np.hypot(x, y), 5)
    points = list(curve.records(case, way, direction=float(np.arctan2(y, x))))
    assert [bool(record.scalars["jump"]) for record in points] == [False, False, False, True, False]
    assert difference(one, points[-1], 1.0) > EQUAL
    assert names_branches(points[-1])
    assert "past a jump" in str(points[-1].scalars["solution_path"])


@pytest.mark.long
@CHANGES
def test_two_hundred_bearings(change: Callable[[Case], tuple[Case, float]]) -> None:
    assert compare(range(200), change) == []
