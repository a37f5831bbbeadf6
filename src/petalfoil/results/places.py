"""Where the film is thinnest and its pressure highest: at one place, or at several that are alike."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.results.record import Record

MIN_FILM_PLACE = ("min_film_thickness_angle", "min_film_thickness_z")
"""Where the film is thinnest: no single place where contact holds it at its least thickness along a stretch."""

PEAK_PRESSURE_PLACE = "peak_pressure_angle"

EQUAL = 1e-6
"""Relative difference below which two peaks of the pressure are equal: pressures solve their equations to 1e-8."""

_FIELDS = {"min_film_thickness_angle": "film_thickness", PEAK_PRESSURE_PLACE: "pressure"}
_ALONG_CONTACT = dict(zip(MIN_FILM_PLACE, ("  along contact, such as at", "  and at z"), strict=True))


def films_at_peak(record: Record, bar: float = 0.0) -> int:
    """Number of petals under which the film reaches the peak pressure.

    Parameters
    ----------
    record : Record
        A point with its pressure.
    bar : float
        Uncertainty of the peak pressure [Pa].

    Returns
    -------
    int
        Petals whose own peak is the highest, within the uncertainty and `EQUAL`. A pressure that still rises at the
        edge of a petal has no peak there. 0 where the record has no pressures.
    """
    if "pressure" not in record.fields:
        return 0
    pressure: NDArray[np.float64] = np.asarray(record.fields["pressure"], dtype=np.float64)
    along = pressure.max(axis=2)
    inside = along[:, 1:-1].max(axis=1) > np.maximum(along[:, 0], along[:, -1])
    return int(np.count_nonzero(inside & (along.max(axis=1) >= along.max() - max(bar, EQUAL * along.max()))))


def is_uniform(record: Record, name: str) -> bool:
    """Whether a field of a record is the same everywhere, as film and pressure are round a centred plain journal."""
    if name not in record.fields:
        return False
    field: NDArray[np.float64] = np.asarray(record.fields[name], dtype=np.float64)
    return bool(np.ptp(field) <= EQUAL * field.max())


def label_of_several(name: str, record: Record) -> str:
    """Label of a place in a table where there are several alike; empty where there is one.

    Parameters
    ----------
    name : str
        Name of a result.
    record : Record
        The point that it belongs to.
    """
    if name in _FIELDS and is_uniform(record, _FIELDS[name]):
        return "  the same everywhere, such as at"
    if name in _ALONG_CONTACT and float(record.scalars.get("contact_fraction", 0.0)) > 0.0:
        return _ALONG_CONTACT[name]
    if name == PEAK_PRESSURE_PLACE:
        films = films_at_peak(record, (record.errors or {}).get("peak_pressure", 0.0))
        return f"  equal under {films} petals, such as at" if films > 1 else ""
    return ""
