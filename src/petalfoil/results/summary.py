"""A record for people and for programs: the object of ``--json`` and the rows of the printed table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from decimal import Decimal
from typing import NamedTuple

from petalfoil.results.record import Record, Scalar
from petalfoil.results.schema import SCALARS, DataType


class Row(NamedTuple):
    """One line of the printed table: what, how much, in which unit."""

    label: str
    value: str
    unit: str


class _Show(NamedTuple):
    label: str
    unit: str = ""
    factor: float = 1.0


ABSENT = "-"
FINEST_SHARE = 1e-7
"""Share of a value below which its error bar adds no digits."""
_DEG = 180.0 / math.pi
_RPM = 30.0 / math.pi

_SHOWN: dict[str, _Show] = {
    "status": _Show("status"),
    "carried_by": _Show("carried by"),
    "speed": _Show("speed", "rpm", _RPM),
    "load_x": _Show("load x", "N"),
    "load_y": _Show("load y", "N"),
    "whirl_amplitude": _Show("amplitude of the whirl", "µm", 1e6),
    "share": _Show("floats below", "%", 100.0),
    "liftoff_speed": _Show("lift-off speed", "rpm", _RPM),
    "touchdown_speed": _Show("touch-down speed", "rpm", _RPM),
    "liftoff_by_contact_film_thickness": _Show("d ln lift-off / d ln floor"),
    "liftoff_by_contact_fraction": _Show("d ln lift-off / d ln share"),
    "critical_mass": _Show("critical mass", "kg"),
    "whirl_ratio": _Show("whirl ratio"),
    "rotor_mass": _Show("mass of the rotor", "kg"),
    "threshold_speed": _Show("threshold speed", "rpm", _RPM),
    "eccentricity_x": _Show("displacement x", "µm", 1e6),
    "eccentricity_y": _Show("displacement y", "µm", 1e6),
    "bearing_force": _Show("bearing force", "N"),
    "force_x": _Show("force x", "N"),
    "force_y": _Show("force y", "N"),
    "attitude_angle": _Show("attitude angle", "deg", _DEG),
    "contact_normal_force": _Show("contact normal force", "N"),
    "contact_fraction": _Show("contact share", "%", 100.0),
    "min_film_thickness": _Show("minimum film thickness", "µm", 1e6),
    "min_film_thickness_angle": _Show("  at angle", "deg", _DEG),
    "min_film_thickness_z": _Show("  at z", "mm", 1e3),
    "knudsen_number": _Show("Knudsen number", "%", 100.0),
    "peak_pressure": _Show("peak pressure", "kPa", 1e-3),
    "peak_pressure_angle": _Show("  at angle", "deg", _DEG),
    "friction_torque": _Show("friction torque", "mN·m", 1e3),
    "starting_torque": _Show("starting torque", "mN·m", 1e3),
    "power_loss": _Show("power loss", "W"),
    "side_leakage": _Show("side leakage", "mg/s", 1e6),
    "max_bending_stress": _Show("maximum bending stress", "MPa", 1e-6),
    "overlap": _Show("overlap"),
    "layers": _Show("layers"),
    "petal_angle": _Show("petal angle", "deg", _DEG),
    "pitch": _Show("pitch", "deg", _DEG),
    "covered_angle": _Show("covered angle", "deg", _DEG),
    "metric_radius": _Show("metric radius", "mm", 1e3),
    "radial_clearance": _Show("radial room", "µm", 1e6),
    "pack_clearance": _Show("room left", "µm", 1e6),
    "root_tilt": _Show("root tilt", "deg", _DEG),
    "free_petal_height": _Show("free petal height", "µm", 1e6),
    "first_contact_angle": _Show("first contact at", "deg", _DEG),
    "bending_stiffness": _Show("bending stiffness", "N·mm", 1e3),
    "compressibility_number": _Show("compressibility number"),
    "viscosity": _Show("viscosity", "µPa·s", 1e6),
    "mean_free_path": _Show("mean free path", "nm", 1e9),
    "stable": _Show("stable"),
    "growth_rate": _Show("growth rate", "1/s"),
    "growth_frequency": _Show("growth frequency", "Hz", 0.5 / math.pi),
    "solution_path": _Show("solution_path"),
    "known_equilibria": _Show("branches known"),
    "jump": _Show("jump"),
    "cells_per_pitch": _Show("cells a pitch"),
    "axial_cells": _Show("cells along the axis"),
    "residual": _Show("residual"),
    "force_residual": _Show("force residual"),
    "iterations": _Show("iterations"),
    "factorizations": _Show("factorisations"),
    "wall_time": _Show("time", "s"),
}


def as_json(record: Record) -> dict[str, float | int | bool | str | None]:
    """Scalars as the object that ``--json`` prints.

    Parameters
    ----------
    record : Record
        One answer.

    Returns
    -------
    dict
        SI numbers, texts and flags in the schema's order; null for a figure that is not there.
    """
    reported = record.reported()
    return {name: _or_null(reported[name]) for name in SCALARS if name in reported}


def rows(record: Record) -> list[Row]:
    """Lines of the printed table, in the units an engineer reads.

    Parameters
    ----------
    record : Record
        One answer.

    Returns
    -------
    list of Row
        Label, value and unit.
    """
    reported = record.reported()
    return [cell(name, reported[name]) for name in _SHOWN if name in reported]


def cell(name: str, value: Scalar) -> Row:
    """Show one scalar, e.g. as a cell of a curve's table.

    Parameters
    ----------
    name : str
        Name in the schema.
    value : float, int, bool or str
        Value, SI.

    Returns
    -------
    Row
        Label, value and unit.
    """
    shown = _SHOWN.get(name, _Show(name.replace("_", " "), SCALARS[name].units.removeprefix("1")))
    if isinstance(value, bool):
        return Row(shown.label, "yes" if value else "no", shown.unit)
    if isinstance(value, str) or SCALARS[name].kind is DataType.INT:
        return Row(shown.label, str(value), shown.unit)
    return Row(shown.label, number(value * shown.factor), shown.unit)


def in_order(names: Iterable[str]) -> list[str]:
    """Those of the names that the printed table shows, in its order."""
    known = set(names)
    return [name for name in _SHOWN if name in known]


def with_bar(name: str, values: Sequence[float], error: float) -> tuple[list[str], str]:
    """Show values of one scalar to the digits that its error bar leaves, and the bar.

    Parameters
    ----------
    name : str
        Name in the schema.
    values : sequence of float
        Values, SI.
    error : float
        Error bar, SI.

    Returns
    -------
    tuple of (list of str, str)
        Values and bar, in the unit of `cell`.
    """
    factor = _SHOWN[name].factor if name in _SHOWN else 1.0
    bar, size = abs(error * factor), max((abs(v * factor) for v in values if math.isfinite(v)), default=0.0)
    if bar == 0.0 or not math.isfinite(bar) or bar < size * FINEST_SHARE:
        return [cell(name, value).value for value in values], number(bar)
    if size >= 1e7 or bar < 1e-6:
        return [ABSENT if math.isnan(v) else f"{v * factor:.2e}" for v in values], f"{bar:.0e}"
    decimals = max(0, 1 - math.floor(math.log10(bar)))  # two digits of the bar
    texts = [ABSENT if math.isnan(v) else f"{v * factor:.{decimals}f}" for v in values]
    return texts, f"{bar:.{decimals}f}"


def number(value: float) -> str:
    """Write a number with four significant digits, plainly where that is readable, else with an exponent."""
    if math.isnan(value):
        return ABSENT
    size = abs(value)
    if size == 0.0 or math.isinf(size):
        return f"{value + 0.0:g}"  # adding 0.0 turns -0.0 into 0.0
    if 1e3 <= size < 1e7:
        return f"{value:.0f}"
    if 1e-3 <= size < 1e3:
        return f"{Decimal(f'{value:.3e}'):f}"  # four digits, trailing zeros kept
    return f"{value:.2e}"


def _or_null(value: Scalar) -> Scalar | None:
    return None if isinstance(value, float) and not math.isfinite(value) else value
