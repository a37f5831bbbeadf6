"""Questions at a given position of the journal."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from petalfoil.api.arguments import Number, Progress, checked, distances_of, position_of, speed_of
from petalfoil.case import Case
from petalfoil.units import parse_quantity

if TYPE_CHECKING:
    import xarray as xr

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
        checked(case), speed=speed_of(speed), eccentricity=position_of(eccentricity), progress=progress
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
        checked(case),
        speed=speed_of(speed),
        eccentricity=position_of(eccentricity),
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

    distances, angle = distances_of(eccentricities), parse_quantity(direction, "rad")
    records = load_curve.iterate(checked(case), distances, direction=angle, speed=speed_of(speed), progress=progress)
    return curve_dataset(list(records), analysis="curve")


def static(
    case: Case,
    eccentricities: Sequence[Number] | str = (0.0,),
    *,
    direction: Number = DOWNWARD,
    loop: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Solve the package at rest: preload, static load characteristic, starting torque, hysteresis.

    Parameters
    ----------
    case : Case
        The bearing; it must have petals.
    eccentricities : sequence of float or str, or str
        Displacements along `direction` [m]; as a text also a range, ``"0 um : 280 um : 15"``.
    direction : float or str
        Direction of the displacements, from x toward y [rad].
    loop : bool
        With friction between the petals: there, back and there again; `petal_friction_work` grows by the energy lost.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        The answers along the dimension `point`, in order.
    """
    from petalfoil.analysis import static as analysis
    from petalfoil.results.dataset import curve_dataset

    distances, angle = distances_of(eccentricities), parse_quantity(direction, "rad")
    records = analysis.iterate(checked(case), distances, direction=angle, loop=loop, progress=progress)
    return curve_dataset(list(records), analysis="static")


def check(case: Case) -> xr.Dataset:
    """Derive what follows from a case without a run: overlap, layers, room, Λ, and the cross-section at rest."""
    from petalfoil.analysis import check as analysis
    from petalfoil.results.dataset import to_dataset

    return to_dataset(analysis.run(checked(case)))
