"""Pressure and film over the exposed part of one petal, for a family of bearings: the figures 6 and 7 of the paper."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.around import plane_fact
from petalfoil.plot.reading import array, mid_plane, number, one_point


def petal_profiles(family: Sequence[tuple[str, xr.Dataset]], *, petal: int = 0) -> Figure:
    """Draw pressure and film over the exposed part of one petal against the angle from its root.

    Spatial results are shown at their mid-plane.

    Parameters
    ----------
    family : sequence of (str, xarray.Dataset)
        Label and converged state.
    petal : int
        Number of the petal; with the journal central all are alike.

    Returns
    -------
    matplotlib.figure.Figure
        Pressure above, film below, one line for each state.

    Raises
    ------
    ConvergenceError
        A state did not converge.
    UsageError
        No state is given, one is a curve of several points, or has no such petal.
    """
    if not family:
        raise UsageError("profiles need at least one state")
    states = [(label, _checked(ds, petal)) for label, ds in family]
    fig = style.figure(8.0, 6.4)
    above, below = fig.subplots(2, 1, sharex=True)
    for place, (label, ds) in enumerate(states):
        plane = mid_plane(ds)
        degrees = np.degrees(array(ds, "phi_exposed"))
        look: style.Look = {"color": style.FAMILY[place % len(style.FAMILY)], "linewidth": 1.8}
        above.plot(degrees, array(plane, "pressure")[petal] / number(ds, "ambient_pressure"), label=label, **look)
        below.plot(degrees, array(plane, "film_thickness")[petal] * 1e6, **look)
    above.axhline(1.0, color=style.GREY, linewidth=0.8)
    below.set_yscale("log")
    style.logarithmic(below.yaxis)
    style.dress(above, "", "pressure  p / p$_a$")
    style.dress(below, "angle from the petal's root  φ [deg]", "film thickness  h [µm]")
    style.legend(above, loc="upper left")
    style.set_title(fig, _titled(states), *_facts(states))
    return fig


def _checked(ds: xr.Dataset, petal: int) -> xr.Dataset:
    ds = one_point(ds)
    if not 0 <= petal < ds.sizes["petal"]:
        raise UsageError(f"there is no petal {petal}: petals are numbered 0 to {ds.sizes['petal'] - 1}")
    return ds


def _titled(states: Sequence[tuple[str, xr.Dataset]]) -> xr.Dataset:
    titles = list(dict.fromkeys(str(ds.attrs.get("title", "")) for _, ds in states))
    return xr.Dataset(attrs={"title": titles[0] if len(titles) == 1 else "One petal, from its neighbour to its edge"})


def _facts(states: Sequence[tuple[str, xr.Dataset]]) -> list[str]:
    """What the states share; what differs is the business of their labels."""
    facts = [
        (
            style.speed_fact(number(ds, "speed")),
            style.displacement_fact(ds),
            style.grid_fact(ds, len(states) == 1),
            plane_fact(ds),
        )
        for _, ds in states
    ]
    return [values[0] for values in zip(*facts, strict=True) if len(set(values)) == 1]
