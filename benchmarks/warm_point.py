"""A warm point of a 3-D load characteristic: number of factorisations, and shares of the time."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from measure import Row, Value, at_least, at_most, in_turn
from watching import APART, Watch, watched

from petalfoil.analysis.curve import curve
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.continuation import advance
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem

EXAMPLES = Path(__file__).parents[1] / "examples"
FARTHEST = 200e-6  # [m]
STEP = FARTHEST / 9.0
"""Displacement from point to point [m]: ten points with the centred journal."""


@dataclass(frozen=True)
class Grid:
    """Cells per pitch and along the axis."""

    pitch: int = 24
    axial: int = 16

    def case(self, e: float = 0.0) -> Case:
        """The bearing of the paper with 8 petals in 3-D, displaced downward by `e` [m]."""
        changes = {"model.cells_per_pitch": self.pitch, "model.axial_cells": self.axial}
        return Case.load(EXAMPLES / "paper_n8_spatial.toml").replace(**changes, **{"operation.eccentricity": (0.0, -e)})


def rows(grid: Grid, points: int, repeats: int) -> list[Row]:
    """All rows about a warm point."""
    point, one = cost(grid, points), factorisation(grid, repeats)
    seconds, plain = point[0].details["seconds_per_point"], one[0].details["seconds_original"]
    assert isinstance(seconds, float)
    assert isinstance(plain, float)
    description = "warm 3-D point: its time over one factorisation by COLAMD of the original unknowns"
    remark = "6 factorisations, 1.25 times their time, each 3 times faster than COLAMD: 2.5"
    return [*point, *one, Row("warm_cost", description, seconds / plain, remark=remark)]


# ---------------------------------------------------------------------------------------------- cost of a point


def warm_points(grid: Grid, points: int) -> list[tuple[Watch, float]]:
    """Watched calls of each warm point of a curve, and its time [s]."""
    seen = []
    followed = curve.records(grid.case(), STEP * np.arange(points + 1))
    next(followed)  # the cold start
    for _ in range(points):
        with watched() as watch:
            record = next(followed)
            seconds = watch.seconds
        if not record.converged:
            raise RuntimeError(f"a point of the benchmark did not converge: {record.scalars['status']}")
        seen.append((watch, seconds))
    return seen


def cost(grid: Grid, points: int) -> list[Row]:
    """Rows of counts and shares of the time."""
    seen = warm_points(grid, points)
    total = sum(seconds for _, seconds in seen)
    share = {name: sum(watch.shares[name].seconds for watch, _ in seen) / total for name in seen[0][0].shares}
    counts = [watch.shares["factorisation"].calls for watch, _ in seen]
    solves = [watch.shares["solves"].calls for watch, _ in seen]
    details: dict[str, Value] = {
        "unknowns": build_problem(grid.case()).layout.n,
        "points": points,
        "seconds_per_point": total / points,
        "least": min(counts),
        "most": max(counts),
        "solves_median": float(statistics.median(solves)),
    }
    count, point = float(statistics.median(counts)), "warm 3-D point"
    rest = 1.0 - sum(share[name] for name in APART)
    return [
        at_most("warm_count", f"{point}: factorisations, median of a curve", count, 6, details=details),
        at_most("warm_total", f"{point}: time over that of its factorisations", 1.0 / share["factorisation"], 1.25),
        Row("warm_factorisation", f"{point}: part of the factorisations", share["factorisation"]),
        Row("warm_assembly", f"{point}: part of the assembly", share["assembly"]),
        Row("warm_solves", f"{point}: part of the solves with the factors", share["solves"]),
        Row("warm_rest", f"{point}: part of the rest", rest),
        Row("warm_stability", f"{point}: part of its stability, contained in the above", share["stability"]),
        Row("warm_search", f"{point}: part of the search for contacts, contained too", share["contact_search"]),
    ]


# ---------------------------------------------------------------------------------------------- one factorisation


def answer(grid: Grid) -> Solution:
    """A solution on the curve with active contacts."""
    problem = build_problem(grid.case(0.5 * FARTHEST))
    known = solve_cold(problem)
    found, _ = advance(known, problem.at(displacement=1.02 * problem.displacement))
    if found.contacts is None:
        raise RuntimeError("the point of the benchmark has no contact set")
    return found


def saddle(found: Solution) -> sp.csc_array:
    """Tangent of the original unknowns in natural order, bordered by the active contacts and their multipliers."""
    closed = found.active
    J, G = found.problem.linearize(found.x).matrix(np.zeros(len(closed))), found.problem.G[closed]
    bordered = sp.csc_array(sp.block_array([[J, -G.T], [G, None]], format="csc"))
    bordered.eliminate_zeros()  # places that petalfoil keeps for contacts and storage are no part of it
    return bordered


def factorisation(grid: Grid, repeats: int) -> list[Row]:
    """Rows of one factorisation of petalfoil against that of SciPy."""
    with one_thread():
        found = answer(grid)
        assert found.contacts is not None  # `answer` saw to it
        ties, bordered = found.contacts.constraints, saddle(found)
        tangent = found.problem.linearize(found.x).matrix(np.zeros(len(found.lam)))
        reduced = ties.reduce(tangent)
        order = ties.elimination_order(current_run().film_solver, found.problem.elimination_key)
        best = in_turn(
            {
                "own": lambda: LinearSolver().factor(reduced, order),
                "own_with_ties": lambda: LinearSolver().factor(ties.reduce(tangent), order),
                "original": lambda: spla.splu(bordered, permc_spec="COLAMD"),
                "reduced": lambda: spla.splu(reduced, permc_spec="COLAMD"),
                "anew": lambda: LinearSolver().factor(reduced),
            },
            repeats,
        )
    details: dict[str, Value] = {f"seconds_{name}": value for name, value in best.items()}
    details |= {"unknowns": reduced.shape[0], "unknowns_original": bordered.shape[0]}
    description = "factorisation: COLAMD on the {}, over petalfoil's"
    whole = best["original"] / best["own"]
    return [
        at_least(
            "factor_original", description.format("original unknowns with multipliers"), whole, 3.0, details=details
        ),
        Row(
            "factor_ties", "the same, with merging the tied unknowns counted", best["original"] / best["own_with_ties"]
        ),
        Row("factor_reduced", description.format("reduced matrix"), best["reduced"] / best["own"]),
        Row(
            "factor_anew",
            "factorisation: petalfoil's with a new elimination order, over that with a known one",
            best["anew"] / best["own"],
        ),
    ]
