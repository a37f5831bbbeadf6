"""The figure that suits a result: what ``--plot`` writes."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.around import draw_film, draw_pressure, plane_fact
from petalfoil.plot.assembly import package
from petalfoil.plot.curves import load_characteristic, static
from petalfoil.plot.impedance import coefficients
from petalfoil.plot.loops import hysteresis, is_loop
from petalfoil.plot.orbits import orbit
from petalfoil.plot.reading import is_spatial, one_point
from petalfoil.plot.refinement import convergence
from petalfoil.plot.section import cross_section, draw_section
from petalfoil.plot.speeds import liftoff, runup
from petalfoil.plot.unrolled import draw_film_map, draw_pressure_map
from petalfoil.plot.whirl import stability


def summary(ds: xr.Dataset) -> Figure:
    """Draw the figure that suits the analysis a dataset comes from.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of any verb.

    Returns
    -------
    matplotlib.figure.Figure
        A point: section, pressure and film. A curve: its characteristic. A check: the package. A grid study:
        figures against the grid. A run-up, lift-off, coefficients, stability: figures over speed, load or frequency.
        A motion: its path, spectrum and histories.

    Raises
    ------
    ConvergenceError
        There is no converged state to draw.
    UsageError
        No figure suits the analysis.
    """
    analysis = ds.attrs.get("analysis")
    single = ds.sizes.get("point", 1) == 1
    if analysis == "check":
        return package(ds)
    if analysis == "converge":
        return convergence(ds)
    if analysis == "static":
        return cross_section(ds) if single else hysteresis(ds) if is_loop(ds) else static(ds)
    if analysis in ("solve", "curve", "balance"):
        return _state(ds) if single else load_characteristic([("", ds)])
    if analysis in DYNAMIC:
        return DYNAMIC[analysis](ds)
    known = ", ".join(sorted(("check", "converge", "static", "solve", "curve", "balance", *DYNAMIC)))
    raise UsageError(f"no figure suits a result of {analysis!r}; known: {known}")


DYNAMIC = {
    "runup": runup,
    "liftoff": liftoff,
    "coefficients": coefficients,
    "stability": stability,
    "orbit": orbit,
}
"""Figures over speed, load, whirl frequency and time."""


def _state(ds: xr.Dataset) -> Figure:
    """Section on the left; pressure and film on the right, as lines (flat) or as maps (spatial)."""
    ds = one_point(ds)
    fig = style.figure(13.0, 6.4)
    axes = fig.subplot_mosaic([["section", "pressure"], ["section", "film"]], width_ratios=[1.0, 1.1])
    draw_section(axes["section"], ds)
    draw_p, draw_h = (draw_pressure_map, draw_film_map) if is_spatial(ds) else (draw_pressure, draw_film)
    draw_p(axes["pressure"], ds)
    draw_h(axes["film"], ds)
    axes["pressure"].set_xlabel("")
    style.set_title(fig, ds, *style.state_facts(ds), plane_fact(ds))
    return fig
