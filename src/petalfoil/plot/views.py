"""What figures take from a dataset: one converged point, values along the exposed strips, places of contact."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
import xarray as xr

from petalfoil.errors import ConvergenceError, UsageError

Floats: TypeAlias = npt.NDArray[np.float64]
Flags: TypeAlias = npt.NDArray[np.bool_]

_ROUNDING = 1e-6
"""Contact pressure over ambient pressure below which a reaction is rounding and not a contact."""


def one_point(ds: xr.Dataset) -> xr.Dataset:
    """The only point of a dataset, refused when it did not converge.

    Parameters
    ----------
    ds : xarray.Dataset
        A point, or a curve of one point.

    Returns
    -------
    xarray.Dataset
        Without the dimension ``point``.

    Raises
    ------
    UsageError
        The dataset is a curve of several points.
    ConvergenceError
        The state did not converge, or does not say that it did.
    """
    if "point" in ds.dims:
        if ds.sizes["point"] != 1:
            raise UsageError(
                f"this figure shows one point of the {ds.sizes['point']}: choose it with ds.isel(point=...)"
            )
        ds = ds.isel(point=0)
    if not bool(ds["converged"]) if "converged" in ds else ds.attrs.get("analysis") != "check":
        raise unconverged(str(ds["status"].item()) if "status" in ds else "nothing says that it did")
    return ds


def needs_result_of(verb: str, ds: xr.Dataset, what: str = "") -> UsageError:
    """The refusal to draw the result of another analysis, which is named."""
    return UsageError(f"this figure needs the result of `{verb}`{what}, this is one of `{ds.attrs.get('analysis')}`")


def unconverged(status: str) -> ConvergenceError:
    """The refusal to draw, with the status of the run."""
    return ConvergenceError(
        f"nothing is drawn from a state that did not converge ({status})",
        advice="solve the case again with what the status advises, then draw",
    )


def number(ds: xr.Dataset, name: str) -> float:
    """A scalar of the dataset; NaN where it has none."""
    return float(ds[name]) if name in ds else math.nan


def is_3d(ds: xr.Dataset) -> bool:
    """Whether the fields vary along the axis; the 2-D model has one station."""
    return ds.sizes.get("z", 1) > 1


def mid_plane(ds: xr.Dataset) -> xr.Dataset:
    """The fields at the station nearest to the middle of the bearing."""
    if "z" not in ds.dims:
        return ds
    return ds.isel(z=int(np.abs(ds["z"].values - number(ds, "length") / 2).argmin()))


def array(ds: xr.Dataset, name: str) -> Floats:
    """Values of a variable as plain floats."""
    return np.asarray(ds[name].values, dtype=np.float64)


def touching(ds: xr.Dataset, name: str) -> Flags:
    """Where a contact pressure is more than rounding."""
    return np.asarray(array(ds, name) > _ROUNDING * number(ds, "ambient_pressure"), dtype=np.bool_)


def contact_places(ds: xr.Dataset, facing: int) -> tuple[Floats, Floats]:
    """Contacts between nodes with the journal (0), the bushing (1) or the petal behind (2), that carry load.

    Returns
    -------
    angles, radii : (k,) arrays
        Bushing angles [rad], and radii of the outer face of the petals there [m].
    """
    force = array(ds, "contact_force")
    least = _ROUNDING * number(ds, "ambient_pressure") * number(ds, "journal_radius") * number(ds, "length")
    mine = (array(ds, "contact_facing") == facing) & (force > least)
    petal, phi = array(ds, "contact_petal")[mine].astype(np.intp), array(ds, "contact_angle")[mine]
    radius, nodes = array(ds, "radius"), array(ds, "phi")
    mid = [float(np.interp(at, nodes, np.ravel(radius[one]))) for one, at in zip(petal, phi, strict=True)]
    return array(ds, "root_angle")[petal] + phi, np.array(mid) + number(ds, "petal_thickness") / 2


ON_JOURNAL = 0
"""Contacts with the journal among those between nodes."""


@dataclass(frozen=True)
class Strip:
    """The exposed strip of one petal as it appears on the unrolled circle.

    Parameters
    ----------
    petal : int
        Number of the petal.
    degrees : ndarray
        Bushing angle of the nodes, shifted by whole turns to show in 0 to 360 [deg].
    """

    petal: int
    degrees: Floats


def strips(ds: xr.Dataset) -> Iterator[Strip]:
    """Exposed strips over the circle; one that crosses 360 degrees comes twice, a turn apart: a figure clips both."""
    exposed = array(ds, "phi_exposed")
    for petal, root in enumerate(array(ds, "root_angle")):
        degrees = np.degrees(root + exposed)
        for turn in _turns(float(degrees[0]), float(degrees[-1])):
            yield Strip(petal, degrees - turn)


def strip_edges(ds: xr.Dataset) -> Floats:
    """Bushing angles at which the petals' free edges end the strips [deg]; none for a plain bearing."""
    if ds.sizes["petal"] == 1:
        return np.empty(0)
    edges: Floats = np.sort(np.degrees(array(ds, "root_angle") + array(ds, "phi_exposed")[-1]) % 360.0)
    return edges


def strip_middles(ds: xr.Dataset) -> Floats:
    """Bushing angle of the middle of each petal's strip [deg]."""
    exposed = array(ds, "phi_exposed")
    middles: Floats = np.degrees(array(ds, "root_angle") + (exposed[0] + exposed[-1]) / 2) % 360.0
    return middles


def _turns(start: float, end: float) -> list[float]:
    slack = 1e-9 * (end - start)
    first, last = math.floor((start + slack) / 360.0), math.ceil((end - slack) / 360.0)
    return [360.0 * turn for turn in range(first, last)]


def displacement(ds: xr.Dataset) -> tuple[float, float]:
    """Displacement of the journal's centre [m]."""
    return number(ds, "eccentricity_x"), number(ds, "eccentricity_y")


def journal_surface(ds: xr.Dataset, theta: Floats) -> Floats:
    """Radius of the displaced journal about the bushing's axis, as the film and the contacts see it [m]."""
    e_x, e_y = displacement(ds)
    surface: Floats = grown_radius(ds) + e_x * np.cos(theta) + e_y * np.sin(theta)
    return surface


def grown_radius(ds: xr.Dataset) -> float:
    """Radius of the journal as the film sees it: what shaft and bushing have grown closes the clearance [m]."""
    shaft, bushing = (number(ds, name) if name in ds else 0.0 for name in ("shaft_growth", "bushing_growth"))
    return number(ds, "journal_radius") + shaft - bushing
