"""A record for people and for programs: the object of ``--json`` and the rows of the printed table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from decimal import Decimal
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from petalfoil.results.record import Record, Scalar
from petalfoil.results.schema import SCALARS, DataType, Shown

if TYPE_CHECKING:
    import xarray as xr


class Row(NamedTuple):
    """One line of the printed table: what, how much, in which unit."""

    label: str
    value: str
    unit: str


ABSENT = "-"
FINEST_SHARE = 1e-7
"""Share of a value below which its error bar adds no digits."""
ROUNDING = 1e-10
"""Part of a vector, of ambient pressure on the bearing for a force, of the journal's radius for a displacement, below
which a component is rounding: thousands of pressures are added, of equations that are solved to 1e-8."""
_VECTORS = (
    (("force_x", "force_y"), "N"),
    (("load_x", "load_y"), "N"),
    (("bearing_force",), "N"),
    (("eccentricity_x", "eccentricity_y"), "m"),
)
"""Components of vectors that tables show, with their unit."""
_DEG = 180.0 / math.pi
_RPM = 30.0 / math.pi

_SHOWN: dict[str, Shown] = {
    "status": Shown("status"),
    "carried_by": Shown("carried by"),
    "speed": Shown("speed", "rpm", _RPM),
    "load_x": Shown("load x", "N"),
    "load_y": Shown("load y", "N"),
    "load_moment_x": Shown("moment of the load x", "mN·m", 1e3),
    "load_moment_y": Shown("moment of the load y", "mN·m", 1e3),
    "whirl_amplitude": Shown("whirl amplitude", "µm", 1e6),
    "contact_fraction_limit": Shown("contact fraction limit", "%", 100.0),
    "liftoff_speed": Shown("lift-off speed", "rpm", _RPM),
    "touchdown_speed": Shown("touchdown speed", "rpm", _RPM),
    "liftoff_by_contact_film_thickness": Shown("d ln lift-off / d ln contact film"),
    "liftoff_by_contact_fraction": Shown("d ln lift-off / d ln limit"),
    "critical_mass": Shown("critical mass", "kg"),
    "whirl_ratio": Shown("whirl ratio"),
    "rotor_mass": Shown("rotor mass", "kg"),
    "threshold_speed": Shown("threshold speed", "rpm", _RPM),
    "eccentricity_x": Shown("displacement x", "µm", 1e6),
    "eccentricity_y": Shown("displacement y", "µm", 1e6),
    "tilt_x": Shown("tilt x", "µrad", 1e6),
    "tilt_y": Shown("tilt y", "µrad", 1e6),
    "shaft_growth": Shown("growth of the shaft", "µm", 1e6),
    "bushing_growth": Shown("growth of the bushing", "µm", 1e6),
    "bearing_force": Shown("bearing force", "N"),
    "force_x": Shown("force x", "N"),
    "force_y": Shown("force y", "N"),
    "moment_x": Shown("moment x", "mN·m", 1e3),
    "moment_y": Shown("moment y", "mN·m", 1e3),
    "attitude_angle": Shown("attitude angle", "deg", _DEG),
    "contact_normal_force": Shown("contact normal force", "N"),
    "contact_fraction": Shown("contact fraction", "%", 100.0),
    "min_film_thickness": Shown("minimum film thickness", "µm", 1e6),
    "min_film_thickness_angle": Shown("  at angle", "deg", _DEG),
    "min_film_thickness_z": Shown("  at z", "mm", 1e3),
    "knudsen_number": Shown("Knudsen number", "%", 100.0),
    "peak_pressure": Shown("peak pressure", "kPa", 1e-3),
    "peak_pressure_angle": Shown("  at angle", "deg", _DEG),
    "friction_torque": Shown("friction torque", "mN·m", 1e3),
    "starting_torque": Shown("starting torque", "mN·m", 1e3),
    "power_loss": Shown("power loss", "W"),
    "film_temperature": Shown("film temperature", "K"),
    "shaft_temperature": Shown("shaft temperature", "K"),
    "pack_temperature": Shown("pack temperature", "K"),
    "bushing_temperature": Shown("bushing temperature", "K"),
    "heat_to_shaft": Shown("heat to shaft", "W"),
    "heat_to_pack": Shown("heat to pack", "W"),
    "heat_to_gas": Shown("heat to side leakage", "W"),
    "side_leakage": Shown("side leakage", "mg/s", 1e6),
    "max_backing_deflection": Shown("maximum backing deflection", "µm", 1e6),
    "max_deflection": Shown("maximum deflection", "µm", 1e6),
    "max_bending_stress": Shown("maximum bending stress", "MPa", 1e-6),
    "max_membrane_stress": Shown("maximum membrane stress", "MPa", 1e-6),
    "shaft_slope_x": Shown("slope of the shaft x", "µrad", 1e6),
    "shaft_slope_y": Shown("slope of the shaft y", "µrad", 1e6),
    "other_eccentricity_x": Shown("other bearing: displacement x", "µm", 1e6),
    "other_eccentricity_y": Shown("  displacement y", "µm", 1e6),
    "other_force_x": Shown("  force x", "N"),
    "other_force_y": Shown("  force y", "N"),
    "other_contact_fraction": Shown("  contact fraction", "%", 100.0),
    "other_min_film_thickness": Shown("  minimum film thickness", "µm", 1e6),
    "other_peak_pressure": Shown("  peak pressure", "kPa", 1e-3),
    "other_power_loss": Shown("  power loss", "W"),
    "other_film_temperature": Shown("  film temperature", "K"),
    "other_bushing_temperature": Shown("  bushing temperature", "K"),
    "other_shaft_temperature": Shown("  shaft temperature", "K"),
    "other_pack_temperature": Shown("  pack temperature", "K"),
    "overlap": Shown("overlap"),
    "layers": Shown("layers"),
    "petal_angle": Shown("petal angle", "deg", _DEG),
    "pitch": Shown("pitch", "deg", _DEG),
    "covered_angle": Shown("covered angle", "deg", _DEG),
    "metric_radius": Shown("metric radius", "mm", 1e3),
    "radial_clearance": Shown("least radial clearance", "µm", 1e6),
    "pack_clearance": Shown("clearance above solid pack", "µm", 1e6),
    "root_tilt": Shown("root tilt", "deg", _DEG),
    "free_petal_height": Shown("free petal height", "µm", 1e6),
    "first_contact_angle": Shown("first contact at", "deg", _DEG),
    "foundation_stiffness": Shown("foundation stiffness", "GPa/m", 1e-9),
    "bending_stiffness": Shown("bending stiffness", "N·mm", 1e3),
    "compressibility_number": Shown("compressibility number on radial clearance"),
    "viscosity": Shown("viscosity", "µPa·s", 1e6),
    "mean_free_path": Shown("mean free path", "nm", 1e9),
    "stable": Shown("stable"),
    "growth_rate": Shown("growth rate", "1/s"),
    "growth_frequency": Shown("growth frequency", "Hz", 0.5 / math.pi),
    "solution_path": Shown("solution path"),
    "friction_path": Shown("petal friction"),
    "contact_model": Shown("contacts"),
    "nodal_force_difference": Shown("force from that at nodes", "%", 100.0),
    "known_equilibria": Shown("known equilibria"),
    "jump": Shown("jump"),
    "cells_per_pitch": Shown("cells per pitch"),
    "axial_cells": Shown("axial cells"),
    "residual": Shown("residual"),
    "force_residual": Shown("force residual"),
    "iterations": Shown("iterations"),
    "factorizations": Shown("factorisations"),
    "wall_time": Shown("time", "s"),
}


_IN_CONTACT = {
    "min_film_thickness_angle": "  along contact, such as at",
    "min_film_thickness_z": "  and at z",
}
"""Labels of the place of the minimum film thickness where contact holds the film at it."""


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
    reported = without_rounding(record)
    return [row(name, reported) for name in in_order(reported)]


def row(name: str, reported: Mapping[str, Scalar]) -> Row:
    """Line of one scalar of a record; where the journal is in contact, the minimum film thickness has many places.

    Parameters
    ----------
    name : str
        Name in the schema.
    reported : mapping
        Scalars of the record, SI.

    Returns
    -------
    Row
        Label, value and unit.
    """
    line, touching = cell(name, reported[name]), float(reported.get("contact_fraction", 0.0)) > 0.0
    return line._replace(label=_IN_CONTACT[name]) if touching and name in _IN_CONTACT else line


def without_rounding(record: Record) -> dict[str, Scalar]:
    """Reported scalars as tables show them: 0 for what is nothing but rounding.

    Parameters
    ----------
    record : Record
        One answer.

    Returns
    -------
    dict
        Scalars by name, SI.
    """
    reported = record.reported()
    sizes = [float(reported.get(name, 0.0)) for name in ("ambient_pressure", "journal_radius", "length")]
    pressed = math.prod(sizes)  # ambient pressure on the bearing [N]
    scales = {"N": pressed, "m": sizes[1]}
    for names, scale in ((names, scales[kind]) for names, kind in _VECTORS):
        here = [float(reported[name]) for name in names if name in reported]
        least = ROUNDING * max(scale, math.hypot(*here))
        reported |= {name: 0.0 for name in names if name in reported and abs(float(reported[name])) < least}
    return reported


def values_without_rounding(ds: xr.Dataset, name: str) -> NDArray[np.float64]:
    """Values of one result of many cases as tables and figures show them: 0 for what is nothing but rounding.

    Parameters
    ----------
    ds : xarray.Dataset
        Results of many cases.
    name : str
        One of them.

    Returns
    -------
    (...) array
        Its values [SI].
    """
    values = np.asarray(ds[name].values, dtype=np.float64)
    kinds = [kind for names, kind in _VECTORS if name in names]
    if not kinds:
        return values
    sizes = [_largest(ds, size) for size in ("ambient_pressure", "journal_radius", "length")]
    scale = math.prod(sizes) if kinds[0] == "N" else sizes[1]
    return np.where(np.abs(values) < ROUNDING * scale, 0.0, values)


def _largest(ds: xr.Dataset, name: str) -> float:
    """Largest value of a size over all cases; 0 where the dataset does not hold it."""
    if name not in ds:
        return 0.0
    values = np.asarray(ds[name].values, dtype=np.float64)
    return float(np.max(values[np.isfinite(values)], initial=0.0))


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
    shown = shown_as(name)
    if isinstance(value, bool):
        return Row(shown.label, "yes" if value else "no", shown.unit)
    if isinstance(value, str) or SCALARS[name].kind is DataType.INT:
        return Row(shown.label, str(value), shown.unit)
    return Row(shown.label, number(value * shown.factor), shown.unit)


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


def shown_as(name: str) -> Shown:
    """How a scalar is shown: as the table says, as its analysis declares, or plainly in SI units."""
    plain = Shown(name.replace("_", " "), SCALARS[name].units.removeprefix("1"))
    return _SHOWN.get(name) or SCALARS[name].shown or plain


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
