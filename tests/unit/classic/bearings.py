"""Small bearings of every kind that the classic method can solve."""

from petalfoil.system.build import build_problem
from petalfoil.system.coupled import CoupledProblem
from tests.cases import case

KINDS: dict[str, tuple[str, dict[str, object]]] = {
    "2d": ("paper_n8", {"model.cells_per_pitch": 8}),
    "2d, slip": ("paper_n8", {"model.cells_per_pitch": 8, "model.slip": True}),
    "2d, continuous": ("paper_n8", {"model.cells_per_pitch": 8, "model.edges": "continuous"}),
    "half": ("paper_n8_spatial", {"model.cells_per_pitch": 6, "model.axial_cells": 6}),
    "whole, continuous": (
        "paper_n8_spatial",
        {
            "model.cells_per_pitch": 6,
            "model.axial_cells": 4,
            "model.symmetry": False,
            "model.edges": "continuous",
            "model.slip": True,
        },
    ),
    "plain": ("plain_journal", {"model.cells_per_pitch": 24, "model.axial_cells": 6}),
    "plain, 2d": (
        "plain_journal",
        {"model.kind": "2d", "model.cells_per_pitch": 24, "model.axial_cells": None},
    ),
}


def bearing(kind: str, **changes: object) -> CoupledProblem:
    """The bearing of a kind, with changes by dotted path."""
    name, grid = KINDS[kind]
    return build_problem(case(name, **{**grid, **changes}))


def pack(cells: int, e: float = 0.0, **changes: object) -> CoupledProblem:
    """The paper's 8 petals in 2-D, displaced downward by `e` [m]."""
    grid = {"model.cells_per_pitch": cells, "operation.eccentricity": (0.0, -e)}
    return build_problem(case("paper_n8", **{**grid, **changes}))
