"""Arguments of the functions to SI numbers; a refusal names the argument."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeGuard

from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.units import parse_pair, parse_quantity, parse_ramp, parse_range
from petalfoil.units.reading import shown

Progress = Callable[[float, str], None]
Number = float | str  # a float in SI units, or a text such as "25 um"


def checked(case: Any) -> Case:
    """`case`, if it is one."""
    if isinstance(case, Case):
        return case
    raise UsageError(f"{shown(case)} is not a Case; Case.load(path) reads one from a file")


def speed_of(speed: Number | None) -> float | None:
    """A speed [rad/s]."""
    return None if speed is None else parse_quantity(speed, "rad/s")


def position_of(position: Sequence[Number] | str | None, name: str = "eccentricity") -> tuple[float, float] | None:
    """A displacement (x, y) [m]."""
    if position is None:
        return None
    if isinstance(position, str):
        return parse_pair(position, "m")
    if not _is_sequence(position) or len(position) != 2:
        raise UsageError(f"{name}: {shown(position)} is not a pair (x, y)")
    return parse_quantity(position[0], "m"), parse_quantity(position[1], "m")


def distances_of(distances: Sequence[Number] | str) -> list[float]:
    """Displacements along a direction [m]."""
    if isinstance(distances, str):
        return parse_range(distances, "m")
    if not _is_sequence(distances):
        raise UsageError(f"eccentricities: {shown(distances)} is not a list of displacements")
    if len(distances) == 0:
        raise UsageError("eccentricities: give at least one displacement")
    return [parse_quantity(distance, "m") for distance in distances]


def load_of(load: Sequence[Number] | Number | None) -> tuple[float, float] | None:
    """A load (x, y) [N]; a single value acts along -y."""
    if load is None:
        return None
    if isinstance(load, str) and "," in load:
        return parse_pair(load, "N")
    if not _is_sequence(load):
        return 0.0, -parse_quantity(load, "N")
    if len(load) != 2:
        raise UsageError(f"load: {shown(load)} is neither a value nor a pair (x, y)")
    return parse_quantity(load[0], "N"), parse_quantity(load[1], "N")


def values_of(name: str, values: Sequence[Number] | Number, unit: str) -> list[float]:
    """A list, a range or a single value of what `name` names."""
    if isinstance(values, str):
        return parse_range(values, unit)
    found = [parse_quantity(value, unit) for value in (values if _is_sequence(values) else [values])]
    if not found:
        raise UsageError(f"{name}: give at least one value")
    return found


def speeds_of(speeds: Sequence[tuple[Number, Number]] | str | None) -> tuple[tuple[float, float], ...] | None:
    """Instants [s] and speeds [rad/s]; as a text a ramp."""
    if speeds is None:
        return None
    if isinstance(speeds, str):
        return tuple(parse_ramp(speeds))
    for point in speeds if _is_sequence(speeds) else [speeds]:
        if not _is_sequence(point) or len(point) != 2:
            raise UsageError(f"speeds: {shown(point)} is not a pair (time, speed)")
    return tuple((parse_quantity(time, "s"), parse_quantity(speed, "rad/s")) for time, speed in speeds)


def _is_sequence(value: object) -> TypeGuard[Sequence[Any]]:
    """Whether `value` has entries in order; a text is one value, NumPy arrays are sequences in all but name."""
    if isinstance(value, str):
        return False
    return isinstance(value, Sequence) or (hasattr(value, "__len__") and hasattr(value, "__getitem__"))
