"""Every verb on every wall, and on one that petalfoil does not have: an answer, or what the wall lacks."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import petalfoil
from petalfoil import plot
from petalfoil.analysis import known_verbs
from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.walls import Capability, wall_kind, wall_kinds
from petalfoil.walls.registry import required
from tests.cases import case

PETALS = case("paper_n6", **{"model.cells_per_pitch": 8})
PLAIN = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})
BUMPS = case("bump_foil", **{"model.cells_per_pitch": 16, "model.axial_cells": 4})
SPATIAL = {"model.kind": "3d", "model.cells_per_pitch": 16, "model.axial_cells": 4}

WALLS = ("petal", "rigid", "bump foil", "elastic foundation")

VERBS: dict[str, Callable[[Case], xr.Dataset]] = {
    "solve": petalfoil.solve,
    "converge": lambda of: petalfoil.converge(of, levels=2, coarsest=16),
    "curve": lambda of: petalfoil.curve(of, "0 um : 10 um : 2"),
    "static": petalfoil.static,
    "balance": lambda of: petalfoil.balance(of, "30 N"),
    "capacity": lambda of: petalfoil.capacity(of, contact_fraction=0.2),
    "liftoff": lambda of: petalfoil.liftoff(of, "30 N"),
    "runup": lambda of: petalfoil.runup(of, "30 N", to="20000 rpm", points=3),
    "coefficients": lambda of: petalfoil.coefficients(of, load="30 N"),
    "stability": lambda of: petalfoil.stability(of, load="30 N", mass="1 kg"),
    "orbit": lambda of: petalfoil.orbit(
        of.replace(rotor={"mass": "1 kg"}), revolutions=0.02, load="30 N", tolerance=1e-7
    ),  # a motion is solved to a share of its tolerance in time
    "sensitivity": lambda of: petalfoil.sensitivity(of, "operation.speed, bearing.length", load="30 N"),
    "check": petalfoil.check,
}

NEEDS = {"static": Capability.PACK, "runup": Capability.LIFT_OFF, "liftoff": Capability.LIFT_OFF}
"""What a verb needs beyond a wall that bounds a film."""


@pytest.fixture(scope="module")
def bearings(foundation: Case) -> dict[str, Case]:
    """A small bearing on each kind of wall, by its name."""
    return {wall_kind(of).name: of for of in (PETALS, PLAIN, BUMPS, foundation.replace(**SPATIAL))}


def test_no_wall_and_no_verb_is_left_out(bearings: dict[str, Case]) -> None:
    assert set(bearings) == {kind.name for kind in wall_kinds()} == set(WALLS)
    assert set(VERBS) == set(known_verbs.summaries())


def test_nothing_above_the_walls_asks_for_petals() -> None:
    below = {"case", "walls"}
    source = Path(petalfoil.__file__).parent
    asking = [
        str(path.relative_to(source))
        for path in source.rglob("*.py")
        if path.relative_to(source).parts[0] not in below and re.search(r"\bcase\.petals\b", path.read_text("utf-8"))
    ]
    assert asking == []


LONG = {
    ("stability", "petal"),
    ("liftoff", "petal"),
    ("liftoff", "bump foil"),
    ("coefficients", "petal"),
    ("capacity", "petal"),
    ("runup", "petal"),
}
"""Pairs that take more than a second."""

STAGES = 1e-6
"""Largest residual of a motion: its stages end by the correction that is left, a hundredth of the tolerance (O2)."""

PAIRS = [
    pytest.param(verb, wall, marks=pytest.mark.slow if (verb, wall) in LONG else ()) for verb in VERBS for wall in WALLS
]


@pytest.mark.parametrize(("verb", "wall"), PAIRS)
def test_a_verb_answers_or_says_what_the_wall_lacks(verb: str, wall: str, bearings: dict[str, Case]) -> None:
    bearing, need = bearings[wall], NEEDS.get(verb)
    if need is not None and not wall_kind(bearing).can(need):
        with pytest.raises(UsageError, match=f"needs a wall that {need.value}: the {wall} wall") as refusal:
            VERBS[verb](bearing)
        assert "[petals]" in str(refusal.value)
        return
    result = VERBS[verb](bearing)
    if verb != "check":
        assert np.all(result["converged"])
    if verb not in ("check", "liftoff"):  # a search of speeds has no state of its own
        assert float(np.max(result["residual"])) <= (STAGES if verb == "orbit" else 1e-8)


@pytest.mark.parametrize("verb", ["solve", "check"])
def test_a_wall_without_a_figure_of_its_own_gets_the_general_one(verb: str, foundation: Case) -> None:
    assert plot.summary(VERBS[verb](foundation)).axes


def test_the_capabilities_of_the_walls_are_not_all_alike(bearings: dict[str, Case]) -> None:
    assert all(wall_kind(PETALS).can(capability) for capability in Capability)
    assert not any(wall_kind(PLAIN).can(capability) for capability in Capability)


def test_rubbing_is_refused_by_what_the_wall_lacks(foundation: Case) -> None:
    rough = foundation.replace(**{"surface.petal_friction": 0.2})
    with pytest.raises(UsageError, match="an amplitude needs a wall that has petals that rub"):
        petalfoil.coefficients(rough, amplitude="1 um")
    assert required(PETALS, Capability.RUBBING, "an amplitude") is wall_kind(PETALS)


def test_results_hold_what_the_wall_declares_and_nothing_else(bearings: dict[str, Case]) -> None:
    petal, rigid, bumps, foundation = (petalfoil.solve(bearings[wall]) for wall in WALLS)
    assert {"deflection", "radius", "bending_stress", "max_bending_stress", "petal_thickness"} <= set(petal.variables)
    assert not {"deflection", "max_bending_stress", "petal_thickness"} & set(rigid.variables)
    for springs in (bumps, foundation):
        assert "deflection" in springs
        assert not {"radius", "max_bending_stress", "petal_thickness"} & set(springs.variables)
