"""Arrays that the browser draws, taken from the records of an answer: few, small, and in SI units.

Of one state they are the fields at the mid-plane, and over the whole length for the 3-D view; of a series its
results over its points; of a motion its path and its histories.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from petalfoil.results.answer import Answer
from petalfoil.results.record import Record
from petalfoil.results.schema import FIELDS, SCALARS
from petalfoil.results.variable import DataType, Role
from petalfoil.studio.protocol import Arrays

CONTACTS = ("journal_contact_pressure", "petal_contact_pressure", "bushing_contact_pressure")
SECTION = ("pressure", "film_thickness", "radius", *CONTACTS)
"""Fields of a state that a cross-section shows."""
MOST_ANGLES, MOST_STATIONS = 48, 25
"""Nodes along a strip and over the length in the 3-D view: beyond, a browser without a graphics card stalls."""
MOST_INSTANTS = 4000
"""Instants of a motion that are drawn: more than a screen has pixels."""

Floats = npt.NDArray[np.float64]


def arrays_of(answer: Answer) -> Arrays:
    """The arrays of an answer by name."""
    last = answer.records[-1]
    if answer.layout.dimension:
        return series(answer.records)
    if "time" in last.coords:
        return motion(last)
    if not last.converged:
        return {}
    return {**section(last), **space(last), **small(last)}


def section(record: Record) -> Arrays:
    """Fields of a state at the mid-plane, (petal, angle); empty for a record without fields."""
    if "radius" not in record.fields and "pressure" not in record.fields:
        return {}
    found = {name: record.coords[name] for name in ("root_angle", "phi_exposed", "phi") if name in record.coords}
    return found | {name: at_mid_plane(record, name) for name in SECTION if name in record.fields}


def at_mid_plane(record: Record, name: str) -> Floats:
    """A field at the station nearest to the middle of the length."""
    values, dims = np.asarray(record.fields[name], dtype=np.float64), FIELDS[name].dims
    if "z" not in dims:
        return values
    plane: Floats = np.take(values, middle(record), axis=dims.index("z"))
    return plane


def middle(record: Record) -> int:
    """Number of the station nearest to the middle of the length."""
    z = np.asarray(record.coords["z"], dtype=np.float64)
    return int(np.abs(z - 0.5 * (z[0] + z[-1])).argmin())


def space(record: Record) -> Arrays:
    """Pressure and film thickness of a 3-D state over the length, (petal, angle, station), thinned out."""
    if len(record.coords.get("z", ())) < 2 or "pressure" not in record.fields:
        return {}
    angles = thinned(len(record.coords["phi_exposed"]), MOST_ANGLES)
    stations = thinned(len(record.coords["z"]), MOST_STATIONS)
    fields = {
        name: np.asarray(record.fields[name])[:, angles][:, :, stations] for name in ("pressure", "film_thickness")
    }
    return {
        "z": np.asarray(record.coords["z"])[stations],
        "space_phi": np.asarray(record.coords["phi_exposed"])[angles],
        **{f"space_{name}": values.astype(np.float32) for name, values in fields.items()},
    }


def thinned(count: int, most: int) -> npt.NDArray[np.int64]:
    """Numbers of at most `most` nodes out of `count`, both ends among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def small(record: Record) -> Arrays:
    """Arrays of a point that are no fields of film or petals, such as coefficients over frequency, with coordinates."""
    of_film = {"petal", "phi", "phi_exposed", "z"}
    names = [name for name in record.fields if not of_film & set(FIELDS[name].dims)]
    dims = {dim for name in names for dim in FIELDS[name].dims}
    coords = {dim: record.coords[dim] for dim in dims if dim in record.coords}
    return coords | {name: np.asarray(record.fields[name]) for name in names}


def series(records: tuple[Record, ...]) -> Arrays:
    """Results of a series over its points: numbers that are not the same at all points; NaN where one has none."""
    points = [record.reported() for record in records]
    found: Arrays = {}
    for name, variable in SCALARS.items():
        is_number = variable.kind in (DataType.FLOAT, DataType.INT) and variable.role in (Role.GIVEN, Role.ANSWER)
        if not is_number or not any(name in point for point in points):
            continue
        values = np.array([float(point.get(name, np.nan)) for point in points])
        if np.unique(values[np.isfinite(values)]).size > 1:
            found[name] = values
    legs = [str(point.get("leg", "")) for point in points]
    return found | ({"leg": np.array(legs)} if any(legs) else {})


def motion(record: Record) -> Arrays:
    """Histories of a motion, thinned out, by name over `time`; pictures of the section along `frame`."""
    kept = thinned(len(record.coords["time"]), MOST_INSTANTS)
    names = [name for name in record.fields if FIELDS[name].dims == ("time",)]
    found = {"time": record.coords["time"][kept]} | {name: record.fields[name][kept] for name in names}
    return found | pictures(record)


def pictures(record: Record) -> Arrays:
    """The section of the last turns along `frame`, at the mid-plane, its angles thinned out; empty where there is none.

    Numbers are single: a picture has fewer digits.
    """
    if "frame_pressure" not in record.fields or "root_angle" not in record.coords:
        return {}
    found: Arrays = {name: record.coords[name] for name in ("frame", "root_angle")}
    nodes = {dim: thinned(len(record.coords[dim]), MOST_ANGLES) for dim in record.coords if dim.startswith("phi")}
    found |= {dim: np.asarray(record.coords[dim])[kept] for dim, kept in nodes.items()}
    for name in ("frame_pressure", "frame_film_thickness", "frame_radius"):
        if name in record.fields:
            values = at_mid_plane(record, name)
            found[name] = np.take(values, nodes[FIELDS[name].dims[2]], axis=2).astype(np.float32)
    return found | {name: record.fields[name] for name in ("frame_x", "frame_y")}
