"""A record for people and for programs: the object of ``--json`` and the rows of the printed table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from typing import NamedTuple

from petalfoil.results.places import label_of_several
from petalfoil.results.record import Record, Scalar
from petalfoil.results.rounding import without_rounding
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, TableLabel


class TableRow(NamedTuple):
    """One line of the printed table: what, how much, in which unit."""

    label: str
    value: str
    unit: str


ABSENT = "-"
FINEST_SHARE = 1e-7
"""Share of a value below which its error bar adds no digits."""
_DEG = 180.0 / math.pi
_RPM = 30.0 / math.pi

_SHOWN: dict[str, TableLabel] = {
    "verdict": TableLabel("stability"),
    "status": TableLabel("status"),
    "carried_by": TableLabel("carried by"),
    "speed": TableLabel("speed", "rpm", _RPM),
    "load_x": TableLabel("load x", "N"),
    "load_y": TableLabel("load y", "N"),
    "load_moment_x": TableLabel("moment of the load x", "mN·m", 1e3),
    "load_moment_y": TableLabel("moment of the load y", "mN·m", 1e3),
    "whirl_amplitude": TableLabel("whirl amplitude", "µm", 1e6),
    "contact_fraction_limit": TableLabel("contact fraction limit", "%", 100.0),
    "liftoff_speed": TableLabel("lift-off speed", "rpm", _RPM),
    "touchdown_speed": TableLabel("touchdown speed", "rpm", _RPM),
    "liftoff_by_contact_film_thickness": TableLabel("d ln lift-off / d ln contact film"),
    "liftoff_by_contact_fraction": TableLabel("d ln lift-off / d ln limit"),
    "critical_mass": TableLabel("critical mass", "kg"),
    "whirl_ratio": TableLabel("whirl ratio"),
    "rotor_mass": TableLabel("rotor mass", "kg"),
    "threshold_speed": TableLabel("threshold speed", "rpm", _RPM),
    "eccentricity_x": TableLabel("displacement x", "µm", 1e6),
    "eccentricity_y": TableLabel("displacement y", "µm", 1e6),
    "tilt_x": TableLabel("tilt x", "µrad", 1e6),
    "tilt_y": TableLabel("tilt y", "µrad", 1e6),
    "shaft_growth": TableLabel("growth of the shaft", "µm", 1e6),
    "bushing_growth": TableLabel("growth of the bushing", "µm", 1e6),
    "bearing_force": TableLabel("bearing force", "N"),
    "force_x": TableLabel("force x", "N"),
    "force_y": TableLabel("force y", "N"),
    "moment_x": TableLabel("moment x", "mN·m", 1e3),
    "moment_y": TableLabel("moment y", "mN·m", 1e3),
    "attitude_angle": TableLabel("attitude angle", "deg", _DEG),
    "contact_normal_force": TableLabel("contact normal force", "N"),
    "contact_fraction": TableLabel("contact fraction", "%", 100.0),
    "min_film_thickness": TableLabel("minimum film thickness", "µm", 1e6),
    "min_film_thickness_angle": TableLabel("  at angle", "deg", _DEG),
    "min_film_thickness_z": TableLabel("  at z", "mm", 1e3),
    "knudsen_number": TableLabel("Knudsen number on minimum film", "%", 100.0),
    "peak_pressure": TableLabel("peak pressure", "kPa", 1e-3),
    "peak_pressure_angle": TableLabel("  at angle", "deg", _DEG),
    "friction_torque": TableLabel("friction torque", "mN·m", 1e3),
    "starting_torque": TableLabel("starting torque", "mN·m", 1e3),
    "power_loss": TableLabel("power loss", "W"),
    "film_temperature": TableLabel("film temperature", "K"),
    "shaft_temperature": TableLabel("shaft temperature", "K"),
    "pack_temperature": TableLabel("pack temperature", "K"),
    "bushing_temperature": TableLabel("bushing temperature", "K"),
    "heat_to_shaft": TableLabel("heat to shaft", "W"),
    "heat_to_pack": TableLabel("heat to pack", "W"),
    "heat_to_gas": TableLabel("heat to side leakage", "W"),
    "side_leakage": TableLabel("side leakage", "mg/s", 1e6),
    "max_backing_deflection": TableLabel("maximum backing deflection", "µm", 1e6),
    "max_deflection": TableLabel("maximum deflection", "µm", 1e6),
    "max_bending_stress": TableLabel("maximum bending stress", "MPa", 1e-6),
    "max_membrane_stress": TableLabel("maximum membrane stress", "MPa", 1e-6),
    "shaft_slope_x": TableLabel("slope of the shaft x", "µrad", 1e6),
    "shaft_slope_y": TableLabel("slope of the shaft y", "µrad", 1e6),
    "other_eccentricity_x": TableLabel("other bearing: displacement x", "µm", 1e6),
    "other_eccentricity_y": TableLabel("  displacement y", "µm", 1e6),
    "other_force_x": TableLabel("  force x", "N"),
    "other_force_y": TableLabel("  force y", "N"),
    "other_contact_fraction": TableLabel("  contact fraction", "%", 100.0),
    "other_min_film_thickness": TableLabel("  minimum film thickness", "µm", 1e6),
    "other_peak_pressure": TableLabel("  peak pressure", "kPa", 1e-3),
    "other_power_loss": TableLabel("  power loss", "W"),
    "other_film_temperature": TableLabel("  film temperature", "K"),
    "other_bushing_temperature": TableLabel("  bushing temperature", "K"),
    "other_shaft_temperature": TableLabel("  shaft temperature", "K"),
    "other_pack_temperature": TableLabel("  pack temperature", "K"),
    "overlap": TableLabel("overlap"),
    "layers": TableLabel("layers"),
    "petal_angle": TableLabel("petal angle", "deg", _DEG),
    "pitch": TableLabel("pitch", "deg", _DEG),
    "covered_angle": TableLabel("covered angle", "deg", _DEG),
    "metric_radius": TableLabel("metric radius", "mm", 1e3),
    "radial_clearance": TableLabel("least radial clearance", "µm", 1e6),
    "pack_clearance": TableLabel("clearance above solid pack", "µm", 1e6),
    "root_tilt": TableLabel("root tilt", "deg", _DEG),
    "free_petal_height": TableLabel("free petal height", "µm", 1e6),
    "first_contact_angle": TableLabel("free petal meets journal at", "deg", _DEG),
    "foundation_stiffness": TableLabel("foundation stiffness", "GPa/m", 1e-9),
    "bending_stiffness": TableLabel("bending stiffness", "N·mm", 1e3),
    "compressibility_number": TableLabel("compressibility number on radial clearance"),
    "viscosity": TableLabel("viscosity", "µPa·s", 1e6),
    "mean_free_path": TableLabel("mean free path", "nm", 1e9),
    "contact_knudsen_number": TableLabel("Knudsen number on contact film", "%", 100.0),
    "clearance_knudsen_number": TableLabel("Knudsen number on radial clearance", "%", 100.0),
    "stable": TableLabel("stable, journal held"),
    "growth_rate": TableLabel("growth rate", "1/s"),
    "growth_frequency": TableLabel("growth frequency", "Hz", 0.5 / math.pi),
    "solution_path": TableLabel("solution path"),
    "friction_path": TableLabel("petal friction"),
    "contact_model": TableLabel("contacts"),
    "friction_harmonics": TableLabel("harmonics of slips"),
    "friction_harmonics_change": TableLabel("change by half as many", "%", 100.0),
    "nodal_force_difference": TableLabel("difference to contacts at nodes", "%", 100.0),
    "known_equilibria": TableLabel("equilibria known here"),
    "jump": TableLabel("jump"),
    "cells_per_pitch": TableLabel("cells per pitch"),
    "axial_cells": TableLabel("axial cells"),
    "residual": TableLabel("residual"),
    "force_residual": TableLabel("force residual"),
    "iterations": TableLabel("iterations"),
    "factorizations": TableLabel("factorisations"),
    "coarse_factorizations": TableLabel("factorisations on coarser grids"),
    "wall_time": TableLabel("time", "s"),
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


def rows(record: Record) -> list[TableRow]:
    """Lines of the printed table, in the units an engineer reads.

    Parameters
    ----------
    record : Record
        One answer.

    Returns
    -------
    list of TableRow
        Label, value and unit.
    """
    reported = without_rounding(record)
    return [row(name, reported, record) for name in in_order(reported)]


def row(name: str, reported: Mapping[str, Scalar], record: Record) -> TableRow:
    """Line of one scalar of a record; a place that is one of several alike is said to be that.

    Parameters
    ----------
    name : str
        Name in the schema.
    reported : mapping
        Scalars of the record as tables show them, SI.
    record : Record
        The record itself.

    Returns
    -------
    TableRow
        Label, value and unit.
    """
    line = cell(name, reported[name])
    return line._replace(label=label_of_several(name, record) or line.label)


def cell(name: str, value: Scalar) -> TableRow:
    """Show one scalar, e.g. as a cell of a curve's table.

    Parameters
    ----------
    name : str
        Name in the schema.
    value : float, int, bool or str
        Value, SI.

    Returns
    -------
    TableRow
        Label, value and unit.
    """
    shown = shown_as(name)
    if isinstance(value, bool):
        return TableRow(shown.label, "yes" if value else "no", shown.unit)
    if isinstance(value, str) or SCALARS[name].kind is DataType.INT:
        return TableRow(shown.label, str(value), shown.unit)
    if math.isinf(value):
        return TableRow(shown.label, shown.infinite, "")
    return TableRow(shown.label, number(value * shown.factor), shown.unit)


def in_order(names: Iterable[str]) -> list[str]:
    """Those of the names that the printed table shows, in its order."""
    known = set(names)
    own = (name for name, variable in SCALARS.items() if variable.shown is not None)
    return [name for name in (*_SHOWN, *own) if name in known]


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
    factor = shown_as(name).factor
    bar, size = abs(error * factor), max((abs(v * factor) for v in values if math.isfinite(v)), default=0.0)
    if bar == 0.0 or not math.isfinite(bar) or bar < size * FINEST_SHARE:
        return [cell(name, value).value for value in values], number(bar)
    if size >= 1e7 or bar < 1e-6:
        return [_beside(bar, v * factor) for v in values], f"{bar:.0e}"
    decimals = max(0, 1 - math.floor(math.log10(bar)))  # two digits of the bar
    texts = [ABSENT if math.isnan(v) else f"{v * factor:.{decimals}f}" for v in values]
    return texts, f"{bar:.{decimals}f}"


def _beside(bar: float, value: float) -> str:
    """A value with an exponent; 0 where two digits of its error bar leave no digit of it."""
    if math.isnan(value):
        return ABSENT
    return "0" if abs(value) < 0.05 * bar else f"{value:.2e}"


def shown_as(name: str) -> TableLabel:
    """How a scalar is shown: as the table says, as its analysis declares, or plainly in SI units."""
    unit, infinite = SCALARS[name].units.removeprefix("1"), "unlimited" if name == "mass_margin" else "none"
    plain = TableLabel(name.replace("_", " "), unit, infinite=infinite)
    return _SHOWN.get(name) or SCALARS[name].shown or plain


def label_alone(name: str) -> str:
    """Label of a scalar away from the table of a point, where the line above tells what "at angle" is of."""
    own, above = shown_as(name).label, in_order(SCALARS)
    if not own.startswith(" "):
        return own
    heads = (shown_as(other).label for other in reversed(above[: above.index(name)]))
    group, colon, _ = next(head for head in heads if not head.startswith(" ")).partition(":")
    return f"{group}{colon or ','} {own.strip()}"


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


def barred(value: float, bar: float) -> float | str:
    """A number of a table of arrays, with its error bar where it has one."""
    return value if math.isnan(bar) else f"{number(value)} ± {number(bar)}"


def _or_null(value: Scalar) -> Scalar | None:
    return None if isinstance(value, float) and not math.isfinite(value) else value
