"""Questions under a given load on the journal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from petalfoil.api.arguments import Number, Progress, checked, load_of, speed_of, values_of
from petalfoil.case import Case
from petalfoil.units import parse_quantity

if TYPE_CHECKING:
    import xarray as xr


def balance(
    case: Case,
    load: Sequence[Number] | Number | None = None,
    *,
    speed: Number | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find the position of the journal under a load.

    Parameters
    ----------
    case : Case
        The bearing.
    load : float or str, or pair of them, optional
        Load on the journal instead of the case's [N]; a single value acts along -y.
    speed : float or str, optional
        Angular speed instead of the case's [rad/s].
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        Fields and figures as of `solve`, at the position found; `carried_by` tells whether contacts bear a share.

    Raises
    ------
    ConvergenceError
        No position was found.
    UsageError
        No load is given, or it is zero.
    """
    from petalfoil.analysis import balance as analysis
    from petalfoil.results.dataset import to_dataset

    return to_dataset(analysis.run(checked(case), load_of(load), speed=speed_of(speed), progress=progress))


def liftoff(
    case: Case, loads: Sequence[Number] | Number, *, share: Number = 0.01, progress: Progress | None = None
) -> xr.Dataset:
    """Find the speeds of lift-off and touch-down for each load.

    Parameters
    ----------
    case : Case
        The bearing; it must have petals.
    loads : sequence of float or str, or one of them
        Loads along -y [N]; as a text also a list or a range, ``"10 N : 100 N : 10"``.
    share : float or str
        Contact share below which the journal floats [1].
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        Speeds along the dimension `point`, in order of the loads: inf where the journal does not lift off, 0 where it
        always floats; and their logarithmic derivatives by film floor and share.
    """
    from petalfoil.analysis import liftoff as analysis
    from petalfoil.results.dataset import curve_dataset

    wanted = values_of("loads", loads, "N")
    least = parse_quantity(share, "1")
    records = analysis.iterate(checked(case), wanted, share=least, progress=progress)
    return curve_dataset(list(records), analysis="liftoff")


def runup(
    case: Case,
    load: Sequence[Number] | Number | None = None,
    *,
    to: Number,
    points: int = 25,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Follow torque, contact, film and position from rest to a speed and back.

    Parameters
    ----------
    case : Case
        The bearing; it must have petals.
    load : float or str, or pair of them, optional
        Load on the journal instead of the case's [N]; a single value acts along -y.
    to : float or str
        Speed to run up to [rad/s].
    points : int
        Speeds on the way up, rest included.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        The answers along the dimension `point` in the order they were followed; `leg` is "up" or "down".
    """
    from petalfoil.analysis import runup as analysis
    from petalfoil.results.dataset import curve_dataset

    top = parse_quantity(to, "rad/s")
    records = analysis.iterate(checked(case), load_of(load), top, points=points, progress=progress)
    return curve_dataset([record for _, record in records], analysis="runup")
