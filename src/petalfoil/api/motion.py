"""The journal through time."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.api.arguments import Number, Progress, checked, load_of, position_of, speeds_of
from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.units import parse_quantity

if TYPE_CHECKING:
    import xarray as xr


def orbit(  # noqa: PLR0913 - the options of the verb
    case: Case,
    *,
    revolutions: float | None = None,
    duration: Number | None = None,
    initial: Sequence[Number] | str | None = None,
    speeds: Sequence[tuple[Number, Number]] | str | None = None,
    load: Sequence[Number] | Number | None = None,
    tolerance: Number = 1e-3,
    restart: xr.Dataset | str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Follow a rigid rotor through time: film, petals, contacts and journal move together.

    Parameters
    ----------
    case : Case
        The bearing, with its rotor.
    revolutions : float, optional
        Turns of the shaft to follow; by default to the end of `speeds`, else 20.
    duration : float or str, optional
        Time to follow instead [s].
    initial : pair of float or str, or "balance", optional
        Displacement (x, y) that the journal is let go from, at rest, instead of the case's eccentricity [m]; "balance"
        is where the constant load is balanced, the shaft turning about its mass centre.
    speeds : sequence of (time, speed), or str, optional
        Speed that changes [s, rad/s], straight lines between; as a text a ramp, ``"0 rpm : 60000 rpm : 2 s"``. Time
        counts from the start of the motion, also in a restart.
    load : float or str, or pair of them, optional
        Constant load on the journal instead of the case's [N], without one the weight; a single value acts along -y.
    tolerance : float
        Local error of a step in reference films and ambient pressures [1].
    restart : xarray.Dataset or path, optional
        Motion of the same bearing to go on from; the result holds what comes after it.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        Positions, velocities, film, contact, forces and energies along `time`; pictures of film and petals along
        `frame`; the state at the end, from which it can go on.

    Raises
    ------
    ConvergenceError
        No equilibrium to start from, or no step that leads on.
    UsageError
        The case has no rotor, the course is impossible, or the motion to go on from is that of another bearing.
    StoreError
        The file to go on from cannot be read.
    """
    from petalfoil.analysis import orbit as analysis
    from petalfoil.results.dataset import to_dataset

    if restart is not None and initial is not None:
        raise UsageError("initial says nothing beside restart, which goes on from where the motion ended")
    course = analysis.OrbitRequest(
        revolutions=revolutions,
        duration=None if duration is None else parse_quantity(duration, "s"),
        initial="balance" if initial == "balance" else position_of(initial, "initial"),
        speeds=speeds_of(speeds),
        load=load_of(load),
        tolerance=parse_quantity(tolerance, "1"),
    )
    return to_dataset(analysis.run(checked(case), course, _earlier(restart), progress))


def _earlier(restart: xr.Dataset | str | os.PathLike[str] | None) -> xr.Dataset | None:
    """The motion to go on from, read where it is a file."""
    if restart is None or not isinstance(restart, str | os.PathLike):
        return restart
    from petalfoil.results.store import load

    return load(Path(restart))
