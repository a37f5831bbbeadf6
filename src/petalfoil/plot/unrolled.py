"""Maps of pressure and film over the unrolled bearing."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from petalfoil.errors import UsageError
from petalfoil.plot import style
from petalfoil.plot.reading import Floats, array, is_spatial, number, one_point, strip_edges, strips, touching

_RASTER = 3.0
"""Points a degree of the raster that shades the maps."""
_STATIONS = 120
"""Points of that raster along the axis."""


def maps(ds: xr.Dataset) -> Figure:
    """Draw pressure and film thickness over bushing angle and length, with the contact of the journal outlined.

    Parameters
    ----------
    ds : xarray.Dataset
        One converged state of the spatial model.

    Returns
    -------
    matplotlib.figure.Figure
        Pressure above, film below.

    Raises
    ------
    ConvergenceError
        The state did not converge.
    UsageError
        The result is of the flat model, or holds several points.
    """
    ds = one_point(ds)
    fig = style.figure(8.0, 5.6)
    above, below = fig.subplots(2, 1, sharex=True)
    draw_pressure_map(above, ds)
    draw_film_map(below, ds)
    above.set_xlabel("")
    style.set_title(fig, ds, *style.state_facts(ds))
    return fig


def draw_pressure_map(ax: Axes, ds: xr.Dataset) -> None:
    """Draw p/p_a over bushing angle and length."""
    ratio = array(ds, "pressure") / number(ds, "ambient_pressure")
    _draw(ax, ds, ratio, Normalize(ratio.min(), max(ratio.max(), ratio.min() + 1e-3)), style.PRESSURE_MAP)
    ax.figure.colorbar(ax.collections[0], ax=ax, pad=0.01, aspect=14).set_label("p / p$_a$", fontsize=style.LABEL)
    if "journal_contact_pressure" in ds and touching(ds, "journal_contact_pressure").any():
        ax.plot([], [], color=style.CONTACT, linewidth=1.4, label="journal touches")
        style.legend(ax, loc="upper right")


def draw_film_map(ax: Axes, ds: xr.Dataset) -> None:
    """Draw the film thickness over bushing angle and length."""
    film = array(ds, "film_thickness") * 1e6
    _draw(ax, ds, film, LogNorm(film.min(), max(film.max(), 1.01 * film.min())), style.FILM_MAP)
    bar = ax.figure.colorbar(ax.collections[0], ax=ax, pad=0.01, aspect=14)
    bar.set_label("film  h [µm]", fontsize=style.LABEL)
    style.logarithmic(bar.ax.yaxis)


def _draw(ax: Axes, ds: xr.Dataset, values: Floats, norm: Normalize, colours: str) -> None:
    if not is_spatial(ds):
        raise UsageError(
            "maps need a result of the spatial model; the flat one has a single station: use pressure_and_film"
        )
    z = array(ds, "z") * 1e3
    for strip in strips(ds):
        degrees, stations, shade = refined(strip.degrees, z, values[strip.petal])
        ax.pcolormesh(degrees, stations, shade.T, norm=norm, cmap=colours, shading="nearest", rasterized=True)
    outline_contact(ax, ds, z)
    for edge in strip_edges(ds):
        ax.axvline(edge, color=style.WHITE, linewidth=0.8, linestyle=":")
    style.dress(ax, "bushing angle  θ [deg]", "z [mm]")
    style.full_circle(ax)
    ax.grid(False)
    ax.set_ylim(z[0], z[-1])


def refined(x: Floats, y: Floats, values: Floats) -> tuple[Floats, Floats, Floats]:
    """Interpolate nodal values bilinearly to a raster fine enough to look smooth."""
    fine_x = np.linspace(x[0], x[-1], 2 + math.ceil(_RASTER * (x[-1] - x[0])))
    fine_y = np.linspace(y[0], y[-1], _STATIONS)
    along_x = np.stack([np.interp(fine_x, x, column) for column in values.T], axis=1)
    both: Floats = np.stack([np.interp(fine_y, y, row) for row in along_x])
    return fine_x, fine_y, both


def outline_contact(ax: Axes, ds: xr.Dataset, z: Floats) -> None:
    """Draw a line around every area where the journal touches."""
    if "journal_contact_pressure" not in ds:
        return
    contact = touching(ds, "journal_contact_pressure").astype(np.float64)
    for strip in strips(ds):
        if contact[strip.petal].any():
            ax.contour(strip.degrees, z, contact[strip.petal].T, levels=[0.5], colors=[style.CONTACT], linewidths=1.4)
