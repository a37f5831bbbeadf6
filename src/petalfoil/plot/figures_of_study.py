"""The figures of a study, by their names: what its folder and its page show."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot.study_optimum import optimum
from petalfoil.plot.study_sobol import sobol
from petalfoil.plot.study_sweeps import parallel_coordinates, scatter_matrix, sweep
from petalfoil.plot.study_tolerance import tolerance
from petalfoil.plot.study_views import of_cases


def study(ds: xr.Dataset, names: tuple[str, ...] = ()) -> Figure:
    """Draw the main figure of a study.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a study.
    names : tuple of str
        Results to show; by default those that the study is about.

    Returns
    -------
    matplotlib.figure.Figure
        Lines, contours or parallel coordinates of a sweep; histograms of a tolerance study; the
        designs of an optimisation; Sobol' indices.
    """
    draw = {"tolerance": tolerance, "optimize": optimum, "sobol": sobol}.get(str(ds.attrs["analysis"]), sweep)
    return draw(ds, names)


def study_figures(ds: xr.Dataset) -> dict[str, Figure]:
    """Draw the pictures of a study.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of a sweep, a sensitivity or tolerance study, or an optimisation.

    Returns
    -------
    dict of matplotlib.figure.Figure
        Figures by name; none where no result varies.
    """
    drawn = {"sweep": _sweep, "tolerance": _tolerance, "optimize": _optimum, "sobol": _sobol}
    try:
        return drawn.get(str(ds.attrs["analysis"]), _sweep)(ds)
    except UsageError:  # no case has a result that varies: the page tells why each failed
        return {}


def _sobol(ds: xr.Dataset) -> dict[str, Figure]:
    return {"sobol": sobol(ds), "scatter_matrix": scatter_matrix(ds)}


def _optimum(ds: xr.Dataset) -> dict[str, Figure]:
    return {"optimum": optimum(ds), "scatter_matrix": scatter_matrix(ds)}


def _tolerance(ds: xr.Dataset) -> dict[str, Figure]:
    return {"tolerance": tolerance(ds), "scatter_matrix": scatter_matrix(ds)}


def _sweep(ds: xr.Dataset) -> dict[str, Figure]:
    ds = of_cases(ds)
    figures = {"results": sweep(ds)}
    if ds["converged"].dims == ("case",) or ds["converged"].ndim > 2:
        figures = {"parallel_coordinates": parallel_coordinates(ds), "scatter_matrix": scatter_matrix(ds)}
    return figures
