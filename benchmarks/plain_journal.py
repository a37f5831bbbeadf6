"""The plain gas journal bearing: time against a short SciPy program, errors against an exact table."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yardstick
from measure import Row, Value, at_most, in_turn

from petalfoil.analysis.session import one_thread
from petalfoil.analysis.solve import solve
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.physics.forces import film_force
from petalfoil.system.build import build_problem

ROOT = Path(__file__).parents[1]
TABLE = ROOT / "tests" / "verification" / "reference" / "a2_journal_finite_LD1.csv"
TIMED = (("2", "0.6"), ("10", "0.6"))
"""Bearing number and relative eccentricity of the timed bearings; errors are those of the whole table."""

Grid = tuple[int, int]
GRIDS: tuple[Grid, ...] = ((120, 40), (240, 80))
"""Cells round the circle and over the whole length; both programs solve half of it."""


@dataclass(frozen=True)
class Exact:
    """One line of the table: bearing number, relative eccentricity, load along and across over `p_a L D`."""

    Lam: float
    eps: float
    along: float
    across: float

    def error(self, along: float, across: float) -> float:
        """Magnitude of the error of a load over the magnitude of the load."""
        return math.hypot(along - self.along, across - self.across) / math.hypot(self.along, self.across)

    def case(self, grid: Grid) -> Case:
        """The bearing, displaced along `-y`."""
        plain = Case.load(ROOT / "examples" / "plain_journal.toml")
        clearance, radius = plain.bearing.clearance, plain.bearing.journal_radius
        scale = plain.gas.ambient_pressure * clearance**2 / (6.0 * plain.gas.viscosity * radius**2)
        return plain.replace(
            **{
                "operation.speed": self.Lam * scale,
                "operation.eccentricity": (0.0, -self.eps * clearance),
                "model.cells_per_pitch": grid[0],
                "model.axial_cells": grid[1],
            }
        )


def table() -> list[Exact]:
    """The exact table."""
    with TABLE.open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    return [Exact(*(float(line[name]) for name in ("Lam", "eps", "Wr", "Wt"))) for line in lines]


def rows(grids: tuple[Grid, ...], repeats: int) -> list[Row]:
    """Time and error on each grid."""
    return [row for grid in grids for row in on(grid, repeats)]


def on(grid: Grid, repeats: int) -> list[Row]:
    """Time and error on one grid."""
    name, shown = f"{grid[0]}x{grid[1]}", f"{grid[0]}×{grid[1]}"
    best = {"yardstick": 0.0, "petalfoil": 0.0, "solution": 0.0}
    for exact in (line for line in table() if (f"{line.Lam:g}", f"{line.eps:g}") in TIMED):
        for key, seconds in timed(exact, grid, repeats).items():
            best[key] += seconds
    ours = [exact.error(*solution(exact, grid)) for exact in table()]
    theirs = [exact.error(*by_yardstick(exact, grid)) for exact in table()]
    details: dict[str, Value] = {f"seconds_{key}": value / len(TIMED) for key, value in best.items()}
    details |= {"error_worst": max(ours), "error_median": float(np.median(ours))}
    details |= {"yardstick_error_worst": max(theirs), "yardstick_error_median": float(np.median(theirs))}
    about = f"plain journal {shown}:"
    whole, bare = best["petalfoil"] / best["yardstick"], best["solution"] / best["yardstick"]
    said = f"median {np.median(ours):.2%}, yardstick {np.median(theirs):.2%} (worst {max(theirs):.2%})"
    return [
        Row(f"journal_{name}_solve", f"{about} `solve` with stability and all results, over the yardstick", whole),
        at_most(f"journal_{name}", f"{about} the solution alone, over the yardstick", bare, 1.0, details=details),
        at_most(
            f"journal_{name}_error", f"{about} worst error of the load, twelve bearings", max(ours), 1e-3, remark=said
        ),
    ]


def timed(exact: Exact, grid: Grid, repeats: int) -> dict[str, float]:
    """Smallest time of the yardstick, of a whole run and of the solution with its mesh [s]."""
    case = exact.case(grid)
    calls = {
        "yardstick": lambda: by_yardstick(exact, grid),
        "petalfoil": lambda: solve.record(case),
        "solution": lambda: solve_cold(build_problem(case)),
    }
    with one_thread():
        return in_turn(calls, repeats)


def solution(exact: Exact, grid: Grid) -> tuple[float, float]:
    """Load along and across the displacement over `p_a L D`, by petalfoil."""
    case = exact.case(grid)
    problem = build_problem(case)
    with one_thread():
        found = solve_cold(problem)
    bearing, p_a = case.bearing, case.gas.ambient_pressure
    force = film_force(problem.layout.wall.film, bearing.journal_radius, (problem.pressure(found.x) - 1.0) * p_a)
    x, y = force / (p_a * bearing.length * 2.0 * bearing.journal_radius)
    return float(y), float(abs(x))


def by_yardstick(exact: Exact, grid: Grid) -> tuple[float, float]:
    """Load along and across the line of centres over `p_a L D`, by the yardstick."""
    film = yardstick.solve(*grid, 2.0, exact.Lam, exact.eps)
    if film.residual > yardstick.TOLERANCE:
        raise RuntimeError(f"the yardstick stopped at a residual of {film.residual:g}")
    return film.along, film.across
