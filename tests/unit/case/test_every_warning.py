"""Every warning that there is: a state that triggers it, and one close by that does not."""

from __future__ import annotations

import ast
import inspect
import math
from collections.abc import Callable
from typing import Any

import pytest

from petalfoil.analysis.friction_told import ASSEMBLED
from petalfoil.case import implausible_answers, plausibility, warnings_of, warnings_of_errors
from petalfoil.case.plausibility import CLEARANCE_RATIO, SLENDERNESS, USUAL
from tests.cases import case
from tests.unit.case.test_plausibility import bumps, measured, rows_of

PETALS, PLAIN = "paper_n8", "plain_journal"
STILL = {"operation.speed": "110 rpm", "operation.eccentricity": (0, 0), "surface.contact_film_thickness": "0.1 um"}
PATH_AT_NODES = {"contact_model": "contacts at nodes", "friction_path": ASSEMBLED, "point_share": 0.0}
Told = list[str]


def of(name: str = PETALS, scalars: dict[str, Any] | None = None, **changes: object) -> Told:
    """Warnings of an example with an answer."""
    return warnings_of(case(name, **changes), scalars or {})


def usual(key: str, value: object) -> Told:
    """Warnings of a slow bearing with one unusual key."""
    return of(PETALS if key.startswith("petals") else PLAIN, **{**STILL, key: value})


def strip(height: float) -> dict[str, Any]:
    """Backing springs of a known height [m]."""
    half = 1.5e-3
    return {"foundation_stiffness": None, "bump_pitch": "4 mm", "bump_half_length": half,
            "bump_half_angle": 2.0 * math.atan(height / half), "thickness": "60 um", "material": "x-750"}  # fmt: skip


def cold_metal(temperature: str, gas: str = "20 degC") -> Told:
    """Warnings of petals of a named metal at a temperature, in a gas of another."""
    named = {"petals.material": "x-750", "petals.metal_temperature": temperature}
    petals = case(PETALS).petals
    assert petals is not None
    table = {name: value for name, value in petals.entries().items() if name not in ("youngs_modulus", "poisson_ratio")}
    made = table | {key.partition(".")[2]: value for key, value in named.items()}
    return warnings_of(case(PETALS, petals=made, **{"gas.temperature": gas}), {})


def named_gas(name: str, pressure: str, **scalars: float) -> Told:
    """Warnings of a plain bearing in a named gas, for an answer."""
    slow = {"operation.speed": "110 rpm"}
    return warnings_of(case(PLAIN, gas={"name": name, "ambient_pressure": pressure}, **slow), scalars)


def metal_pack(temperature: float) -> Told:
    """Warnings of petals of Inconel X-750 in a pack that has warmed up to a temperature [K]."""
    return warnings_of(case("backed_petals", **{"petals.material": "x-750"}), {"pack_temperature": temperature})


# what yields it: (what the line begins with, a case that triggers it, one close by that does not)
EVERY: dict[str, tuple[str, Callable[[], Told], Callable[[], Told]]] = {
    **{
        f"usual {one.key}": (
            one.key,
            lambda one=one: usual(one.key, 0.99 * one.low),
            lambda one=one: usual(one.key, 1.01 * one.low),
        )
        for one in USUAL
    },
    "usual bearing.bushing_radius": (
        "bearing.bushing_radius",
        lambda: usual("bearing.bushing_radius", "28.8 mm"),
        lambda: usual("bearing.bushing_radius", "28.7 mm"),
    ),
    "usual bearing.length": (
        "bearing.length",
        lambda: usual("bearing.length", "501 mm"),
        lambda: usual("bearing.length", "499 mm"),
    ),
    "_surface_speed": (
        "operation.speed",
        lambda: of(**{"operation.speed": 9700.0}),
        lambda: of(**{"operation.speed": 9500.0}),
    ),
    "_turbulence": (
        "operation.speed",
        lambda: of(PLAIN, **{"gas.ambient_pressure": "16 bar"}),
        lambda: of(PLAIN, **{"gas.ambient_pressure": "15 bar"}),
    ),
    "_unbalance": (
        "rotor.unbalance",
        lambda: of("orbit_n8", **{"rotor.unbalance": "0.51 mm"}),
        lambda: of("orbit_n8", **{"rotor.unbalance": "0.49 mm"}),
    ),
    "_petal_theory surface.petal_friction": (
        "surface.petal_friction",
        lambda: of(**{"surface.petal_friction": 0.2, "petals.theory": "inextensible"}),
        lambda: of(**{"surface.petal_friction": 0.0}),
    ),
    "_petal_theory backing": (
        "backing",
        lambda: of("backed_petals", **{"model.kind": "3d"}),
        lambda: of("backed_petals", **{"model.kind": "3d", "petals.theory": "inextensible"}),
    ),
    "_of_inputs rotor.transverse_inertia": (
        "rotor.transverse_inertia",
        lambda: of(rotor={"mass": 3.0, "span": 0.2}),
        lambda: of(rotor={"mass": 3.0, "span": 0.2, "transverse_inertia": 0.01, "polar_inertia": 0.001}),
    ),
    "_measured_shape rows": (
        "petals.free_shape",
        lambda: warnings_of(measured(rows_of(5)), {}),
        lambda: warnings_of(measured(rows_of(12)), {}),
    ),
    "_measured_shape error": (
        "petals.free_shape",
        lambda: warnings_of(measured(rows_of(8)), {}),
        lambda: warnings_of(measured(rows_of(12)), {}),
    ),
    "_metal": ("petals.metal_temperature", lambda: cold_metal("545 degC"), lambda: cold_metal("530 degC")),
    "_metal gas": (
        "petals.metal_temperature",
        lambda: cold_metal("20 degC", "540 degC"),
        lambda: cold_metal("20 degC", "535 degC"),
    ),
    "_stress": (
        "max_bending_stress",
        lambda: of(scalars={"max_bending_stress": 2.01e9}),
        lambda: of(scalars={"max_bending_stress": 1.99e9}),
    ),
    "rarefaction": (
        "knudsen_number",
        lambda: of(PLAIN, {"knudsen_number": 0.101}),
        lambda: of(PLAIN, {"knudsen_number": 0.099}),
    ),
    "_real_gas": (
        "peak_pressure",
        lambda: named_gas("R134a", "0.5 bar", peak_pressure=1.2e5),
        lambda: named_gas("R134a", "0.5 bar", peak_pressure=0.6e5),
    ),
    "_warm_parts film": (
        "film_temperature",
        lambda: named_gas("R134a", "0.5 bar", film_temperature=460.0),
        lambda: named_gas("R134a", "0.5 bar", film_temperature=450.0),
    ),
    "_warm_parts pack": ("pack_temperature", lambda: metal_pack(815.0), lambda: metal_pack(805.0)),
    "_contact": (
        "contact_fraction",
        lambda: of(scalars={"contact_fraction": 2e-3}),
        lambda: of(scalars={"contact_fraction": 5e-4}),
    ),
    "_mixed_lubrication": (
        "min_film_thickness",
        lambda: of(scalars={"min_film_thickness": 2.99e-6}),
        lambda: of(scalars={"min_film_thickness": 3.01e-6}),
    ),
    "_pressed_bumps": (
        "max_deflection",
        lambda: warnings_of(bumps(), {"max_deflection": 201e-6}),
        lambda: warnings_of(bumps(), {"max_deflection": 199e-6}),
    ),
    "of_answer bottomed_out": (
        "bottomed_out",
        lambda: of(scalars={"bottomed_out": True}),
        lambda: of(scalars={"bottomed_out": False, "solution_path": "interior point"}),
    ),
    "of_answer contact_model": (
        "contact_model",
        lambda: of(scalars={"contact_model": "contacts at nodes"}),
        lambda: of(scalars={"contact_model": "contact points on petals with continuous slopes"}),
    ),
    "of_answer friction_harmonics": (
        "friction_harmonics",
        lambda: of(scalars={"friction_harmonics": 1}),
        lambda: of(scalars={"friction_harmonics": 4}),
    ),
    "_dragged_at_nodes contact_model": (
        "contact_model",
        lambda: of(
            scalars={"contact_model": "contacts at nodes", "contact_normal_force": 1.0},
            **{"model.kind": "3d", "surface.journal_rubbing": "force"},
        ),
        lambda: of(
            scalars={"contact_model": "contacts at nodes", "contact_normal_force": 0.0},
            **{"model.kind": "3d", "surface.journal_rubbing": "force"},
        ),
    ),
    "_path_at_nodes contact_model": (
        "contact_model",
        lambda: of("rig", PATH_AT_NODES, **{"model.kind": "3d", "surface.petal_friction": 0.1}),
        lambda: of(
            "rig", PATH_AT_NODES, **{"model.kind": "3d", "surface.petal_friction": 0.1, "model.contacts": "nodes"}
        ),
    ),
    "_short_lines model.cells_per_pitch": (
        "model.cells_per_pitch",
        lambda: of("rig", {"friction_harmonics": 4}, **{"model.kind": "3d", "model.cells_per_pitch": 26}),
        lambda: of("rig", {"friction_harmonics": 4}, **{"model.kind": "3d", "model.cells_per_pitch": 29}),
    ),
    "of_answer nodal_force_difference": (
        "nodal_force_difference",
        lambda: of(scalars={"nodal_force_difference": 0.11}),
        lambda: of(scalars={"nodal_force_difference": 0.09}),
    ),
    "neutral verdict": (
        "verdict",
        lambda: of(scalars={"verdict": "rotor of 4 kg: neutral, growth rate 0.65 1/s at 9550 Hz"}),
        lambda: of(scalars={"verdict": "rotor of 4 kg: stable (no mass is critical)"}),
    ),
    "warnings_of_errors": (
        "min_film_thickness",
        lambda: warnings_of_errors({"min_film_thickness": 4e-6}, {"min_film_thickness": 0.41e-6}),
        lambda: warnings_of_errors({"min_film_thickness": 4e-6}, {"min_film_thickness": 0.39e-6}),
    ),
}


@pytest.mark.parametrize("name", EVERY)
def test_it_is_told_and_close_by_it_is_not(name: str) -> None:
    key, triggering, close = EVERY[name]
    (told,) = triggering()
    assert told.startswith(f"{key}: ")
    assert ";" in told
    assert "\n" not in told
    assert close() == []


def test_backing_springs_pressed_down_to_their_feet_are_told() -> None:
    springs = {name: value for name, value in strip(200e-6).items() if value is not None}
    backed = case("backed_petals", backing=springs)
    (told,) = warnings_of(backed, {"max_backing_deflection": 201e-6})
    assert told.startswith("max_backing_deflection: ")
    assert warnings_of(backed, {"max_backing_deflection": 199e-6}) == []


def test_none_is_missing_here() -> None:
    """Functions that make a warning's line themselves, as the source has them; each of several lines counts."""
    made: list[str] = []
    for module in (plausibility, implausible_answers):
        for function in ast.walk(ast.parse(inspect.getsource(module))):
            if isinstance(function, ast.FunctionDef):
                lines = [node for node in ast.walk(function) if is_line(node)]
                made += [function.name] * len(lines)
    tested = [name.partition(" ")[0] for name in EVERY]
    usual_keys = {*(one.key for one in USUAL), CLEARANCE_RATIO.key, SLENDERNESS.key}
    assert {name.partition(" ")[2] for name in EVERY if name.startswith("usual ")} == usual_keys
    assert sorted(made) == sorted(["warning", *(name for name in tested if name != "usual")])


def is_line(node: ast.AST) -> bool:
    """Whether a node makes a warning: a text that is yielded, or a list of one that is returned."""
    if isinstance(node, ast.Yield):
        return isinstance(node.value, ast.JoinedStr | ast.Constant)
    returned = node.value if isinstance(node, ast.Return) else None
    return isinstance(returned, ast.List) and any(isinstance(entry, ast.JoinedStr) for entry in returned.elts)
