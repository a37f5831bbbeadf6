"""The figure of each analysis: what ``--plot`` writes. Names are resolved when a figure is drawn, and not before."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, TypeAlias, cast

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

Draw: TypeAlias = "Callable[[xr.Dataset], Figure]"

FIGURES: dict[str, Draw | str] = {
    "check": "assembly:pack",
    "solve": "characteristics:curve",
    "curve": "characteristics:curve",
    "balance": "characteristics:curve",
    "static": "characteristics:static",
    "converge": "grid_convergence:convergence",
    "runup": "speed_sweeps:runup",
    "capacity": "load_capacity:capacity",
    "liftoff": "speed_sweeps:liftoff",
    "coefficients": "dynamic_coefficients:coefficients",
    "stability": "stability_maps:stability",
    "orbit": "journal_orbit:orbit",
    "optimize": "study_optimum:optimum",
    "sobol": "study_sobol:sobol",
    "sweep": "study_sweeps:sweep",
    "tolerance": "study_tolerance:tolerance",
    "sensitivity": "parameter_effects:tornado",
}
"""Function that draws the result of an analysis, or where it stands: module of this package, colon, function."""


def register(analysis: str, draw: Draw) -> None:
    """Let a function draw the results of an analysis; it replaces a former one.

    Parameters
    ----------
    analysis : str
        Name of the analysis, as it stands in a result's attribute of that name.
    draw : callable
        From a dataset to a figure.
    """
    FIGURES[analysis] = draw


def summary(ds: xr.Dataset) -> Figure:
    """Draw the figure that suits the analysis a dataset comes from.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of any analysis. One without a figure of its own gets a generic one: a point its quantities, a series
        lines over what is varied, a grid contours.

    Returns
    -------
    matplotlib.figure.Figure
        A figure that a notebook shows by itself.

    Raises
    ------
    ConvergenceError
        There is no converged state to draw.
    UsageError
        The dataset holds nothing that can be drawn.
    """
    draw = FIGURES.get(str(ds.attrs.get("analysis")), "generic:quantities")
    if isinstance(draw, str):
        module, _, function = draw.partition(":")
        draw = cast("Draw", getattr(import_module(f"petalfoil.plot.{module}"), function))
    return draw(ds)
