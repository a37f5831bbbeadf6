"""The verbs as functions: a case in, labelled data out.

Each is the same analysis as the verb of the command line. Speeds, displacements and angles are SI numbers or texts
with a unit, as in a case.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.units import parse_pair, parse_quantity, parse_range
from petalfoil.units.reading import shown

if TYPE_CHECKING:
    import xarray as xr

Progress = Callable[[float, str], None]
Number = float | str  # a float in SI units, or a text such as "25 um"

DOWNWARD = -math.pi / 2.0  # the weight of the rotor displaces the journal along −y [rad]


def solve(
    case: Case,
    *,
    speed: Number | None = None,
    eccentricity: Sequence[Number] | str | None = None,
    error: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve film, petals and contact at one position of the journal.

    Parameters
    ----------
    case : Case
        The bearing.
    speed : float or str, optional
        Angular speed instead of the case's [rad/s].
    eccentricity : pair of float or str, optional
        Displacement (x, y) instead of the case's [m].
    error : bool
        Add error bars from a study on the case's grid and two more, as the attribute ``grid_error`` of each figure,
        in the figure's unit.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        Fields and figures of the answer; its attributes hold the case.

    Raises
    ------
    ConvergenceError
        No converged answer; the error says why and what to try.
    PackageError
        The displaced journal leaves the package no room.
    """
    from petalfoil.analysis import equilibrium, grid_study
    from petalfoil.results.dataset import to_dataset

    record = equilibrium.run(
        _checked(case), speed=_speed(speed), eccentricity=_position(eccentricity), progress=progress
    )
    if not error:
        return to_dataset(record)
    from petalfoil.results.study import with_error_bars

    return with_error_bars(to_dataset(record), grid_study.error_bars(record, progress))


def converge(
    case: Case,
    *,
    speed: Number | None = None,
    eccentricity: Sequence[Number] | str | None = None,
    levels: int = 3,
    coarsest: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve one position of the journal on nested grids: order, limit and error bar of every figure.

    Parameters
    ----------
    case : Case
        The bearing.
    speed : float or str, optional
        Angular speed instead of the case's [rad/s].
    eccentricity : pair of float or str, optional
        Displacement (x, y) instead of the case's [m].
    levels : int
        Number of grids, each twice as fine as the one before.
    coarsest : int, optional
        Cells along a pitch of the coarsest grid, 16 at least. By default the case's own grid is the finest, as long as
        the coarser ones are fine enough to tell anything.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        Figures along the dimension `grid`; for each figure ``f`` also ``f_limit``, ``f_error``, ``f_order`` (nan
        where none could be observed) and ``f_trusted``.

    Raises
    ------
    ConvergenceError
        Fewer than two grids have an answer.
    UsageError
        These grids cannot be made.
    PackageError
        The displaced journal leaves the package no room.
    """
    from petalfoil.analysis import grid_study
    from petalfoil.results.study import study_dataset

    records = grid_study.run(
        _checked(case),
        speed=_speed(speed),
        eccentricity=_position(eccentricity),
        levels=levels,
        coarsest=coarsest,
        progress=progress,
    )
    return study_dataset(records, grid_study.table(records))


def curve(
    case: Case,
    eccentricities: Sequence[Number] | str,
    *,
    direction: Number = DOWNWARD,
    speed: Number | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Follow the load over the displacement of the journal, at one speed.

    Parameters
    ----------
    case : Case
        The bearing.
    eccentricities : sequence of float or str, or str
        Displacements along `direction` [m]; as a text also a range, ``"0 um : 280 um : 15"``.
    direction : float or str
        Direction of the displacements, from x toward y [rad].
    speed : float or str, optional
        Angular speed instead of the case's [rad/s].
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        The answers along the dimension `point`, in order; `converged` is false, and the figures are nan, where a
        point found no answer.
    """
    from petalfoil.analysis import load_curve
    from petalfoil.results.dataset import curve_dataset

    distances, angle = _distances(eccentricities), parse_quantity(direction, "rad")
    records = load_curve.iterate(_checked(case), distances, direction=angle, speed=_speed(speed), progress=progress)
    return curve_dataset(list(records), analysis="curve")


def static(
    case: Case,
    eccentricities: Sequence[Number] | str = (0.0,),
    *,
    direction: Number = DOWNWARD,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve the package at rest: preload, static load characteristic, starting torque.

    Parameters
    ----------
    case : Case
        The bearing; it must have petals.
    eccentricities : sequence of float or str, or str
        Displacements along `direction` [m]; as a text also a range, ``"0 um : 280 um : 15"``.
    direction : float or str
        Direction of the displacements, from x toward y [rad].
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        The answers along the dimension `point`, in order.
    """
    from petalfoil.analysis import static as analysis
    from petalfoil.results.dataset import curve_dataset

    distances, angle = _distances(eccentricities), parse_quantity(direction, "rad")
    records = analysis.iterate(_checked(case), distances, direction=angle, progress=progress)
    return curve_dataset(list(records), analysis="static")


def check(case: Case) -> xr.Dataset:
    """Derive what follows from a case without a run: overlap, layers, room, Λ, and the cross-section at rest."""
    from petalfoil.analysis import check as analysis
    from petalfoil.results.dataset import to_dataset

    return to_dataset(analysis.run(_checked(case)))


# ---------------------------------------------------------------------------------------------- arguments


def _checked(case: Any) -> Case:
    if isinstance(case, Case):
        return case
    raise UsageError(f"{shown(case)} is not a Case; Case.load(path) reads one from a file")


def _speed(speed: Number | None) -> float | None:
    return None if speed is None else parse_quantity(speed, "rad/s")


def _position(position: Sequence[Number] | str | None) -> tuple[float, float] | None:
    if position is None:
        return None
    if isinstance(position, str):
        return parse_pair(position, "m")
    if not _is_sequence(position) or len(position) != 2:
        raise UsageError(f"eccentricity: {shown(position)} is not a pair (x, y)")
    return parse_quantity(position[0], "m"), parse_quantity(position[1], "m")


def _distances(distances: Sequence[Number] | str) -> list[float]:
    if isinstance(distances, str):
        return parse_range(distances, "m")
    if not _is_sequence(distances):
        raise UsageError(f"eccentricities: {shown(distances)} is not a list of displacements")
    if len(distances) == 0:
        raise UsageError("eccentricities: give at least one displacement")
    return [parse_quantity(distance, "m") for distance in distances]


def _is_sequence(value: object) -> bool:
    """Whether `value` has entries in order; NumPy arrays do although they are no `Sequence`."""
    return isinstance(value, Sequence) or (hasattr(value, "__len__") and hasattr(value, "__getitem__"))
