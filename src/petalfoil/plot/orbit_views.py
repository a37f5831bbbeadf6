"""What figures take from a motion: its path, the axis it is drawn over, the clearance circle, facts for a title."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from petalfoil.case import Case
from petalfoil.errors import DefinitionError, UsageError
from petalfoil.plot import labels
from petalfoil.plot.labels import MICRO, RPM
from petalfoil.plot.views import Floats, array, needs_result_of, number
from petalfoil.results.motion import TURN, Path


def path_of(ds: xr.Dataset) -> Path:
    """The path of a motion.

    Raises
    ------
    UsageError
        The dataset holds no motion, or only its start.
    """
    if "x" not in ds or ds["x"].dims != ("time",):
        raise needs_result_of("orbit", ds)
    if ds.sizes["time"] < 2:
        raise UsageError("this motion has no step yet, so there is nothing to draw")
    names = ("x", "y", "velocity_x", "velocity_y", "shaft_angle", "shaft_speed")
    return Path.of(array(ds, "time"), {name: array(ds, name) for name in names})


def elapsed(path: Path) -> tuple[Floats, str]:
    """What histories are drawn over, and its label: revolutions at one speed, else milliseconds."""
    if path.is_steady:
        return path.angle / TURN, "revolutions of the shaft"
    return path.time * 1e3, "time  t [ms]"


def clearance_circle(ds: xr.Dataset) -> tuple[float, str] | None:
    """Radius of the circle in which the journal's centre can move [m], and what bounds it; none if the case is lost.

    A plain journal is in contact where its film has the contact film thickness. In a foil pack it can move until the
    petals are bottomed out on the bore, and is in contact with them long before that.
    """
    try:
        case = Case.from_toml(str(ds.attrs.get("case", "")))
    except DefinitionError:
        return None
    if (solid := case.solid_height) is None:
        return None
    if not solid:
        radius = case.bearing.clearance - case.surface.contact_film_thickness
        return radius, f"contact with the bore, {radius * MICRO:.4g} µm"
    radius = case.bearing.clearance - solid
    return radius, f"foil pack bottomed out, {radius * MICRO:.4g} µm"


def motion_facts(ds: xr.Dataset, path: Path) -> tuple[str, ...]:
    """Speed, rotor, revolutions and grid, as a title tells them."""
    first, last = float(path.speed[0]), float(path.speed[-1])
    ramp = f"{labels.grouped(first * RPM)} to {labels.grouped(last * RPM)} rpm"
    speed = labels.speed_fact(first) if path.is_steady else ramp
    mass = number(ds, "rotor_mass")
    rotor = "" if math.isnan(mass) else f"rotor {mass:.4g} kg"
    return speed, rotor, f"{path.turns:.4g} revolutions", labels.grid_fact(ds)


def padded(low: float, high: float, share: float = 0.08) -> tuple[float, float]:
    """Limits of an axis around values."""
    spread = max(high - low, 1e-9 * max(abs(low), abs(high)), 1e-30)
    return low - share * spread, high + share * spread


def settled(path: Path) -> tuple[Floats, Floats]:
    """A smooth line through the settled part: x and y [m]."""
    _, z = path.evenly(path.settled_since())
    return np.asarray(z.real, dtype=np.float64), np.asarray(z.imag, dtype=np.float64)
