"""Stiffness and damping as bearing elements of ROSS (https://github.com/petrobras/ross).

ROSS from version 3.0 on interpolates tables over rotor speed and whirl frequency; ROSS 2 knows one value a speed, and
takes the whirl to be synchronous. ``BearingElement.load`` reads both files. Axes are x and y of the bushing, and the
rotor turns from x to y.

A rotor in a gas film becomes unstable in a whirl at about half the speed. The coefficients of a gas film change quickly
there, so the table must be dense near it, relative to each of its speeds.
"""

from __future__ import annotations

import json
import math
import re
import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from petalfoil.errors import StoreError, UsageError
from petalfoil.results.export import AXIS, ENTRIES, converged_points, write_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray as xr

Array = NDArray[np.float64]

LEAST_POINTS = 5
"""Points of an axis below which ROSS warns that its interpolation is poor."""

HALF_SPEED = (0.4, 0.6)
"""Whirl frequencies over speed between which rotors in gas films become unstable."""

DENSE = 0.02
"""Relative step of whirl frequencies near half speed. A plain bearing of 40 mm grows by 3.2 1/s at 1.03 times its
threshold speed: steps of 5 % give 3.1, of 24 % 2.4, of 40 % -0.9, which is stable."""

COARSE = 0.1
"""Relative step near half speed above which a table is warned of: the growth rate above is then wrong by 5 %."""

CURVED = 0.02
"""Error of coefficients between two speeds above which a table is warned of: with 7 % between 400 and 1030 rad/s ROSS
has the threshold speed of a rotor 8 % too high (941 for 872 rad/s), with 0.2 % within 1 rad/s."""

SPARSE = 0.2
"""Relative step of whirl frequencies elsewhere."""

REACH = (0.1, 2.0)
"""Whirl frequencies over lowest and highest speed up to which a table reaches: ROSS extrapolates beyond."""


def ross_frequencies(speeds: Sequence[float]) -> list[float]:
    """Whirl frequencies of a table for ROSS, dense around half of every speed, the speeds themselves among them.

    Parameters
    ----------
    speeds : sequence of float
        Speeds of the table [rad/s].

    Returns
    -------
    list of float
        Frequencies [rad/s], ascending.
    """
    low, high = HALF_SPEED[0] * min(speeds), HALF_SPEED[1] * max(speeds)
    below = _steps(REACH[0] * min(speeds), low, SPARSE)
    above = _steps(high, REACH[1] * max(speeds), SPARSE)
    axis = np.unique(np.concatenate([below, _steps(low, high, DENSE), above]))
    near = np.abs(axis[:, None] / np.array(speeds) - 1.0).min(axis=1)
    return sorted({*axis[near > 0.5 * DENSE].tolist(), *map(float, speeds)})


def write_ross(ds: xr.Dataset, path: str | Path, node: int = 0, tag: str | None = None) -> None:
    """Write coefficients over speed and whirl frequency as a bearing element of ROSS 3.

    A `UserWarning` is given where whirl frequencies near half a speed are far apart, or coefficients change so unevenly
    with speed that a straight line between two speeds is wrong.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``coefficients`` at several speeds; both axes need `LEAST_POINTS` points.
    path : str or Path
        Where to: ``.toml`` or ``.json``.
    node : int
        Node of the rotor that carries the bearing.
    tag : str, optional
        Name of the element, different for each in a rotor; by default that of the file.

    Raises
    ------
    UsageError
        An axis is too short, or has a value twice.
    StoreError
        A speed has no coefficients, or the file cannot be written.
    """
    points = _points(ds, path)
    speeds = [float(point["speed"]) for point in points]
    order = np.argsort(ds["whirl_frequency"].values, kind="stable")
    frequencies = ds["whirl_frequency"].values[order]
    check_axes(speeds, frequencies.tolist())
    for speed in speeds:
        _warn_if_coarse(speed, frequencies)
    tables = {
        letter: np.stack([point[name].values for point in points])[:, order]
        for name, letter in (("stiffness", "k"), ("damping", "c"))
    }
    _warn_if_curved(np.array(speeds), frequencies, tables["k"] + 1j * frequencies[:, None, None] * tables["c"])
    _write_element(path, (node, tag), {"speed": speeds, "frequency": frequencies.tolist()}, tables)


def write_ross_synchronous(ds: xr.Dataset, path: str | Path, node: int = 0, tag: str | None = None) -> None:
    """Write coefficients at whirl frequencies equal to the speed as a bearing element of ROSS 2.

    They tell the response to unbalance. They do not tell stability: a rotor whirls at about half speed there.

    Parameters
    ----------
    ds, path, node, tag
        As for `write_ross`; every speed must be among the whirl frequencies.

    Raises
    ------
    UsageError
        A speed is not among the whirl frequencies, or there are too few speeds.
    StoreError
        A speed has no coefficients, or the file cannot be written.
    """
    points = _points(ds, path)
    speeds, frequencies = [float(point["speed"]) for point in points], ds["whirl_frequency"].values
    check_axes(speeds, frequencies.tolist(), synchronous=True)
    own = [int(np.flatnonzero(frequencies == speed)[0]) for speed in speeds]
    tables = {
        letter: np.stack([point[name].values[index] for point, index in zip(points, own, strict=True)])
        for name, letter in (("stiffness", "k"), ("damping", "c"))
    }
    _write_element(path, (node, tag), {"frequency": speeds}, tables)


AXES = {"speeds": "speeds", "frequencies": "frequencies"}
"""What the axes of a table are called, unless an option is meant."""


def check_axes(
    speeds: Sequence[float],
    frequencies: Sequence[float],
    *,
    synchronous: bool = False,
    known_as: Mapping[str, str] = AXES,
) -> None:
    """Refuse axes that ROSS cannot use, by the names they are `known_as`; an analysis asks before it computes.

    Raises
    ------
    UsageError
        An axis is too short or has a value twice; for a synchronous table, a speed is not among the frequencies.
    """
    axes = {"speeds": speeds} if synchronous else {"speeds": speeds, "frequencies": frequencies}
    for name, axis in axes.items():
        if len(set(axis)) < max(len(axis), LEAST_POINTS):
            raise UsageError(
                f"a table for ROSS needs {LEAST_POINTS} different values of {known_as[name]} or more, "
                f"got {len(set(axis))}"
            )
    missing = [speed for speed in speeds if synchronous and speed not in set(frequencies)]
    if missing:
        raise UsageError(
            f"a synchronous table needs every speed among the frequencies, {missing[0]:g} rad/s is not: leave "
            f"{known_as['frequencies']} out"
        )


def _warn_if_coarse(speed: float, frequencies: Array) -> None:
    """Warn where steps between frequencies near half of `speed` are large, or none lies there."""
    low, high = (part * speed for part in HALF_SPEED)
    between = (frequencies[1:] > low) & (frequencies[:-1] < high)
    steps = np.diff(frequencies)[between] / np.maximum(frequencies[:-1][between], low)
    covered = frequencies[0] <= low and frequencies[-1] >= high
    if covered and np.max(steps, initial=0.0) <= COARSE:
        return
    reason = f"steps of {100.0 * np.max(steps, initial=0.0):.0f} %" if covered else "no frequencies on both sides"
    warnings.warn(
        f"the table for ROSS has {reason} near half of {speed:g} rad/s, where rotors become unstable: an unstable "
        f"rotor may look stable there; steps of {100.0 * COARSE:.0f} % or less are needed, as by default",
        stacklevel=3,
    )


def _warn_if_curved(speeds: Array, frequencies: Array, impedances: NDArray[np.complex128]) -> None:
    """Warn where `impedances` (speed, frequency, row, column) [N/m] between two speeds are far from a straight line.

    A line over two intervals misses the speed between them by four times what a line over each of them misses.
    """
    column = np.array([np.argmin(np.abs(frequencies - 0.5 * speed)) for speed in speeds])
    errors = np.zeros(len(speeds))
    for k in range(1, len(speeds) - 1):
        before, here, after = impedances[k - 1 : k + 2, column[k]]
        share = (speeds[k] - speeds[k - 1]) / (speeds[k + 1] - speeds[k - 1])
        errors[k] = 0.25 * np.max(np.abs(here - (1.0 - share) * before - share * after)) / np.max(np.abs(here))
    k = int(np.argmax(errors))
    if errors[k] > CURVED:
        warnings.warn(
            f"the table for ROSS is some {100.0 * errors[k]:.0f} % off between {speeds[k - 1]:g} and {speeds[k + 1]:g} "
            "rad/s, where stiffness and damping do not change evenly with speed: a threshold speed there is as far "
            "off; ask for more speeds",
            stacklevel=3,
        )


def _steps(start: float, stop: float, relative: float) -> Array:
    """Frequencies from `start` to `stop` in equal relative steps of `relative` or less."""
    count = max(1, math.ceil(math.log(stop / start) / math.log1p(relative)))
    return np.geomspace(start, stop, count + 1)


def _points(ds: xr.Dataset, path: str | Path) -> list[xr.Dataset]:
    """The points by speed.

    Raises
    ------
    StoreError
        One of them has no coefficients.
    """
    points = sorted(converged_points(ds), key=lambda point: float(point["speed"]))
    if len(points) < ds.sizes.get("point", 1):
        without = ds.sizes.get("point", 1) - len(points)
        raise StoreError(
            f"{path} is not written: ROSS needs coefficients at every speed, and some have none: leave these "
            f"{without} out"
        )
    return points


def _write_element(
    path: str | Path, place: tuple[int, str | None], axes: dict[str, list[float]], tables: dict[str, Array]
) -> None:
    """Write node and tag `place`, axes, and tables (..., row, column)."""
    node, name = place
    tag = Path(path).stem if name is None else name
    element: dict[str, object] = {"n": node, "tag": tag, **axes}
    for letter, table in tables.items():
        element |= {f"{letter}{AXIS[i]}{AXIS[j]}": table[..., i, j].tolist() for i, j in ENTRIES}
    section = f"BearingElement_{tag}"
    write_text(json.dumps({section: element}) if Path(path).suffix == ".json" else _toml(section, element), path)


def _toml(section: str, element: dict[str, object]) -> str:
    """One key a line: a text, a number, and a list of numbers or of such lists are written alike in TOML and JSON."""
    heading = section if re.fullmatch(r"[A-Za-z0-9_-]+", section) else json.dumps(section)
    return f"[{heading}]\n" + "".join(f"{key} = {json.dumps(value)}\n" for key, value in element.items())
