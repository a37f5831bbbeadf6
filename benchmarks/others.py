"""Other programs, each on a problem that it can solve, against petalfoil on the same number of nodes. All optional."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from types import ModuleType

import numpy as np
import yardstick
from measure import Row, in_turn
from plain_journal import Exact

from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.system.build import build_problem

GRID = (120, 40)
EPS = 0.6
STILL = 1e-3
"""Bearing number at which compressibility is negligible: the excess pressure is `Lam` times that of a liquid."""


def rows(repeats: int) -> list[Row]:
    """A row for each program, measured where it is installed."""
    return [
        row("openairbearing", "openairbearing", repeats, porous),
        row("ross-rotordynamics", "ross.bearings.fluid_flow", repeats, liquid),
    ]


def row(package: str, module: str, repeats: int, measure: Callable[[ModuleType, int], tuple[float, str]]) -> Row:
    """Measure a program if it can be imported."""
    description = f"{package}: one film on {GRID[0]}×{GRID[1]} cells, over petalfoil's"
    name = package.partition("-")[0]
    try:
        found = version(package)
        with contextlib.redirect_stdout(io.StringIO()):  # some of their dependencies print while they are imported
            loaded = import_module(module)
    except PackageNotFoundError:
        return Row(name, description, None, remark="not installed")
    except ImportError as failure:
        return Row(name, description, None, remark=f"version {version(package)} cannot be used: {failure}")
    ratio, remark = measure(loaded, repeats)
    return Row(name, description, ratio, remark=f"{found}: {remark}", details={"version": found})


def own(case: Case) -> Callable[[], object]:
    """The package's solution of a plain bearing, mesh included."""
    return lambda: solve_cold(build_problem(case))


def porous(ab: ModuleType, repeats: int) -> tuple[float, str]:
    """Time of an externally pressurised porous journal at rest, over a rotating one; error of its own seal."""
    bearing = ab.JournalBearing(nx=GRID[0], ny=GRID[1] + 1, nh=2)  # it needs two displacements for its slope
    calls = {
        "theirs": lambda: ab.solve_bearing(bearing, "numeric2d"),
        "ours": own(Exact(2.0, EPS, 0.0, 0.0).case(GRID)),
    }
    with one_thread():
        best = in_turn(calls, repeats)
    seal = ab.InfiniteLinearBearing(nx=GRID[1] + 1)
    exact, found = (np.asarray(ab.solve_bearing(seal, how).w) for how in ("analytic", "numeric"))
    error = float(np.max(np.abs(found / exact - 1.0)))
    remark = "a linear film at rest, fed through a porous wall; it has no rotation. "
    return 0.5 * best["theirs"] / best["ours"], remark + f"Its load of a long seal on {GRID[1]} cells: {error:.2%} off"


def liquid(fluid_flow: ModuleType, repeats: int) -> tuple[float, str]:
    """Time of a journal bearing with a liquid, over petalfoil with a gas at negligible compressibility."""
    case = Exact(STILL, EPS, 0.0, 0.0).case(GRID)
    bearing, gas, omega = case.bearing, case.gas, case.operation.speed
    sizes = (bearing.length, omega, 0.0, 0.0, bearing.journal_radius, bearing.bushing_radius, gas.viscosity, 1.2)
    displaced = {"attitude_angle": 0.0, "eccentricity": EPS * bearing.clearance}

    def theirs() -> object:
        return fluid_flow.FluidFlow(GRID[1] + 1, GRID[0] + 1, *sizes, **displaced)

    with one_thread():
        best = in_turn({"theirs": theirs, "ours": own(case)}, repeats)
        problem = build_problem(case)
        ours = float(np.max(problem.pressure(solve_cold(problem).x))) - 1.0
    exact = yardstick.solve(480, 160, 2.0, STILL, EPS).peak - 1.0
    found = float(np.max(theirs().p_mat_numerical)) / gas.ambient_pressure  # type: ignore[attr-defined]
    errors = f"peak pressure {abs(found / exact - 1.0):.2%} off, petalfoil's {abs(ours / exact - 1.0):.2%}"
    return best["theirs"] / best["ours"], f"an incompressible film: {errors}"
