"""Campbell diagram: natural frequencies and damping of a rotor over its speed, and where the unbalance meets them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from petalfoil.case import NEUTRAL_DAMPING
from petalfoil.plot import labels, style
from petalfoil.plot.labels import HERTZ, QUANTITIES, RPM
from petalfoil.plot.views import Floats, array, needs_result_of, unconverged

CONICAL = 0.5
"""Part of the tilt in a motion from which a mode is called conical."""
ROUND = 0.5
"""Whirl direction from which an orbit is called forward or backward rather than elliptical."""
HEADROOM = 1.15
"""Space above the highest mode."""


def campbell(ds: xr.Dataset) -> Figure:
    """Draw natural frequencies and damping ratios over speed; crossings with the speed (1×) are marked.

    Parameters
    ----------
    ds : xarray.Dataset
        Result of ``stability`` with speeds and a mass.

    Returns
    -------
    matplotlib.figure.Figure
        Frequencies in Hz (left) and rpm (right) above, damping ratios below. Modes that grow are ringed.

    Raises
    ------
    ConvergenceError
        No operating point was found.
    UsageError
        The dataset holds no modes over speed.
    """
    if "natural_frequency" not in ds or "point" not in ds.dims:
        raise needs_result_of("stability", ds, " with several speeds and a mass")
    if not np.isfinite(array(ds, "natural_frequency")).any():
        raise unconverged(str(np.ravel(ds["status"].values)[-1]))
    fig = style.figure(8.6, 8.2)
    above, below = fig.subplots(2, 1, sharex=True, height_ratios=[1.7, 1.0])
    _draw_branches(above, below, ds)
    _draw_speed_lines(above, ds)
    _mark_crossings(above, ds)
    style.dress(above, "", "damped natural frequency [Hz]")
    style.dress(below, QUANTITIES["speed"].axis, "damping ratio")
    _set_limits(above, below, ds)
    style.legend_below(above, 3)
    mass = f"rotor {float(np.ravel(array(ds, 'rotor_mass'))[0]):.4g} kg"
    style.set_title(fig, ds, mass, labels.load_fact(ds.isel(point=0)) if "load_x" in ds else "")
    return fig


def _kind(ds: xr.Dataset, branch: int) -> tuple[str, style.Look]:
    """What a branch is called, and its look: colour and width by direction, line and marker by form.

    Forward branches are wide and backward ones thin with open markers, so that both are seen where they coincide.
    """
    direction = _direction(ds, branch)
    tilt = _middle(ds, "mode_tilt", branch) if "mode_tilt" in ds else 0.0
    way, look = "elliptical", {"color": style.PURPLE, "linewidth": 1.8, "markersize": 5.0}
    if direction > ROUND:
        way, look = "forward", {"color": style.BLUE, "linewidth": 2.4, "markersize": 6.0}
    if direction < -ROUND:
        open_marker = {"markerfacecolor": style.WHITE, "markersize": 4.0}
        way, look = "backward", {"color": style.ORANGE, "linewidth": 1.2, "zorder": 3.0} | open_marker
    form, marker = ("conical", "^") if tilt > CONICAL else ("cylindrical", "o")
    return f"{form}, {way}", look | {"marker": marker, "linestyle": "--" if tilt > CONICAL else "-"}


def _direction(ds: xr.Dataset, branch: int) -> float:
    """Whirl direction of a branch: 1 forward, -1 backward."""
    return _middle(ds, "whirl_direction", branch)


def _middle(ds: xr.Dataset, name: str, branch: int) -> float:
    """Median of a quantity of a branch over the speeds that have it."""
    shown = np.isfinite(array(ds, "natural_frequency")[:, branch])
    return float(np.median(array(ds, name)[shown, branch]))


def _draw_branches(above: Axes, below: Axes, ds: xr.Dataset) -> None:
    rpm, order = _speeds(ds)
    hertz, ratio = array(ds, "natural_frequency")[order] * HERTZ, array(ds, "damping_ratio")[order]
    named: set[str] = set()
    for branch in np.flatnonzero(np.isfinite(hertz).any(axis=0)):
        name, look = _kind(ds, int(branch))
        label = "_" if name in named else name
        named.add(name)
        above.plot(rpm, hertz[:, branch], label=label, **look)
        below.plot(rpm, ratio[:, branch], **look)
    _ring_those(above, (rpm, hertz), ratio <= -NEUTRAL_DAMPING, ("growing", "grows: unstable", style.VERMILLION))
    _ring_those(
        above, (rpm, hertz), np.abs(ratio) < NEUTRAL_DAMPING, ("neutral", "neither grows nor decays", style.GREY)
    )


def _ring_those(ax: Axes, at: tuple[Floats, Floats], chosen: NDArray[np.bool_], named: tuple[str, str, str]) -> None:
    """Ring chosen points of branches, (speed, branch), at speeds and frequencies; `named` by gid, label and colour."""
    (rpm, hertz), (gid, label, colour) = at, named
    ring: style.Look = {"markersize": 10, "markeredgecolor": colour, "markerfacecolor": "none", "markeredgewidth": 1.6}
    for branch in np.flatnonzero(chosen.any(axis=0)):
        ax.plot(rpm[chosen[:, branch]], hertz[chosen[:, branch], branch], "o", gid=gid, **ring)
    if chosen.any():
        ax.plot([], [], "o", label=label, **ring)


def _draw_speed_lines(ax: Axes, ds: xr.Dataset) -> None:
    """The frequency of the unbalance, and half of it."""
    ends = np.array([0.0, float(array(ds, "speed").max())])
    for order, line, name in ((1.0, "-", "1× speed"), (0.5, ":", "½× speed")):
        ax.plot(ends * RPM, order * ends * HERTZ, line, color=style.GREY, linewidth=1.2, label=name)


BESIDE = (((8.0, -14.0), "left"), ((-8.0, 9.0), "right"))
"""Where labels of critical speeds stand in turn [points]."""
SAME = 0.005
"""Relative distance of two critical speeds that share a label."""


def _mark_crossings(ax: Axes, ds: xr.Dataset) -> None:
    """Mark where a branch has the frequency of the speed; the unbalance, which whirls forward, drives forward ones."""
    critical = array(ds, "critical_speed")
    found = sorted(
        (float(speed), _direction(ds, branch) < -ROUND)
        for branch in range(critical.shape[1])
        for speed in critical[np.isfinite(critical[:, branch]), branch]
    )
    kinds: dict[bool, tuple[str, str, style.Look]] = {
        False: ("critical speed", "x", {"color": style.INK, "markersize": 9.0, "markeredgewidth": 2.0}),
        True: ("backward mode at 1×", "+", {"color": style.GREY, "markersize": 11.0, "markeredgewidth": 1.6}),
    }
    for backward, (label, marker, look) in kinds.items():
        speeds = np.array([speed for speed, is_backward in found if is_backward == backward])
        if speeds.size:
            gid = "backward crossing" if backward else "critical"
            ax.plot(speeds * RPM, speeds * HERTZ, marker, gid=gid, label=label, linestyle="", zorder=5, **look)
    _label_speeds(ax, [speed for speed, _ in found], near_end=0.85 * float(array(ds, "speed").max()))


def _label_speeds(ax: Axes, found: list[float], near_end: float) -> None:
    """Write speeds beside their marks, those at one place once; past `near_end` a label to the right would be cut."""
    apart = [speed for place, speed in enumerate(found) if not place or speed > (1.0 + SAME) * found[place - 1]]
    for place, speed in enumerate(apart):
        place_at, side = ((34.0, -22.0), "right") if speed > near_end else BESIDE[place % 2]
        ax.annotate(
            f"{labels.grouped(speed * RPM)} rpm",
            (speed * RPM, speed * HERTZ),
            xytext=place_at,
            textcoords="offset points",
            ha=side,
            fontsize=style.TICK,
            color=style.INK,
            bbox={"facecolor": style.WHITE, "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
        )


def _set_limits(above: Axes, below: Axes, ds: xr.Dataset) -> None:
    top = float(array(ds, "speed").max())
    highest = HEADROOM * max(float(np.nanmax(array(ds, "natural_frequency"))), top) * HERTZ
    above.set_ylim(0.0, highest)
    above.set_xlim(0.0, 1.03 * top * RPM)
    rpm = above.secondary_yaxis("right", functions=(_to_rpm, _to_hertz))
    rpm.set_ylabel("[rpm]", fontsize=style.LABEL)
    rpm.tick_params(labelsize=style.TICK, color=style.GREY)
    low = min(float(np.nanmin(array(ds, "damping_ratio"))), 0.0)
    bottom, ceiling = below.get_ylim()
    below.set_ylim(min(bottom, 1.2 * low, -0.02), ceiling)
    below.axhspan(below.get_ylim()[0], 0.0, color=style.VERMILLION, alpha=0.1, linewidth=0)
    below.axhline(0.0, color=style.GREY, linewidth=0.8)
    place: style.Look = {"transform": below.transAxes, "va": "bottom", "fontsize": style.TICK}
    below.text(0.01, 0.02, "unstable", color=style.GREY, **place)


def _to_rpm(hertz: Any) -> Any:
    return hertz * RPM / HERTZ


def _to_hertz(rpm: Any) -> Any:
    return rpm * HERTZ / RPM


def _speeds(ds: xr.Dataset) -> tuple[Floats, NDArray[np.intp]]:
    """Speeds in ascending order [rpm], and that order."""
    order = np.argsort(array(ds, "speed"))
    return array(ds, "speed")[order] * RPM, order
