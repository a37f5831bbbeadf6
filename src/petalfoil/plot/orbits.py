"""A motion in one figure: path, spectrum, histories, energy."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from petalfoil.plot import style
from petalfoil.plot.histories import draw_contact, draw_displacement, draw_energy, draw_film_history
from petalfoil.plot.motion import motion_facts, path_of
from petalfoil.plot.paths import draw_close, draw_room
from petalfoil.plot.spectra import draw_frequencies


def orbit(ds: xr.Dataset) -> Figure:
    """Draw a motion: path in its room and close up, spectrum or waterfall, histories, audit of the energy.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``orbit``.

    Returns
    -------
    matplotlib.figure.Figure
        Six panels.

    Raises
    ------
    UsageError
        The dataset holds no motion.
    """
    path = path_of(ds)
    fig = style.figure(16.0, 9.4)
    axes = fig.subplot_mosaic(
        [["radial_clearance", "close", "spectrum"], ["move", "film", "energy"], ["move", "contact", "energy"]],
        width_ratios=[1.0, 1.0, 1.25],
        height_ratios=[2.5, 1.0, 0.8],
    )
    draw_room(axes["radial_clearance"], ds, path)
    draw_close(axes["close"], path)
    draw_frequencies(axes["spectrum"], path)
    draw_displacement(axes["move"], ds, path)
    draw_film_history(axes["film"], ds, path)
    draw_contact(axes["contact"], ds, path)
    draw_energy(axes["energy"], ds, path)
    axes["film"].sharex(axes["contact"])
    axes["film"].set_xlabel("")
    axes["film"].tick_params(labelbottom=False)
    style.set_title(fig, ds, *motion_facts(ds, path))
    return fig
