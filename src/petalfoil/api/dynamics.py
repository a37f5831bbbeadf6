"""Questions about small motions of the journal."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from petalfoil.api.arguments import Number, Progress, checked, load_of, speed_of, values_of
from petalfoil.case import Case
from petalfoil.units import parse_quantity

if TYPE_CHECKING:
    import xarray as xr


def coefficients(  # noqa: PLR0913 - the options of the verb
    case: Case,
    frequencies: Sequence[Number] | Number | None = None,
    *,
    load: Sequence[Number] | Number | None = None,
    speed: Number | None = None,
    speeds: Sequence[Number] | str | None = None,
    amplitude: Number | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find stiffness and damping at whirl frequencies, at the case's eccentricity or under a load.

    Parameters
    ----------
    case : Case
        The bearing.
    frequencies : sequence of float or str, or one of them, optional
        Whirl frequencies [rad/s]; by default the speed, or the speeds.
    load : float or str, or pair of them, optional
        Load on the journal instead of the case's [N]; a single value acts along -y.
    speed : float or str, optional
        Angular speed instead of the case's [rad/s].
    speeds : sequence of float or str, or str, optional
        Several speeds instead of one [rad/s]; as a text also a range.
    amplitude : float or str, optional
        Amplitude of the whirl [m] at which petals with friction rub: stiffness and damping of equal force and loss in a
        cycle, displaced along one axis at a time. Without it they stick, as in the smallest motions.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        `stiffness` and `damping` over `whirl_frequency`, `row` and `column`; with `speeds` along `point` as well.

    Raises
    ------
    UsageError
        An amplitude where no petals rub (`surface.petal_friction` is 0) or that is not positive, a negative frequency.
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    from petalfoil.analysis import coefficients as analysis
    from petalfoil.results.dataset import curve_dataset, to_dataset

    whirl = None if frequencies is None else values_of("frequencies", frequencies, "rad/s")
    force, omega = load_of(load), speed_of(speed)
    size = None if amplitude is None else parse_quantity(amplitude, "m")
    if speeds is None:
        return to_dataset(
            analysis.run(checked(case), whirl, load=force, speed=omega, amplitude=size, progress=progress)
        )
    turn = values_of("speeds", speeds, "rad/s")
    records = analysis.iterate(checked(case), turn, whirl, load=force, amplitude=size, progress=progress)
    return curve_dataset(list(records), analysis="coefficients")


def stability(  # noqa: PLR0913 - the options of the verb
    case: Case,
    *,
    load: Sequence[Number] | Number | None = None,
    mass: Number | None = None,
    speed: Number | None = None,
    speeds: Sequence[Number] | str | None = None,
    loads: Sequence[Number] | str | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find the smallest mass of a rigid rotor that whirls, its threshold speed and its damped natural frequencies.

    Petals with friction (`surface.petal_friction`) stick, as in the smallest motions.

    Parameters
    ----------
    case : Case
        The bearing.
    load : float or str, or pair of them, optional
        Load on the journal instead of the case's [N]; a single value acts along -y.
    mass : float or str, optional
        Mass of the rotor on this bearing [kg]; by default the case's, else the load over standard gravity.
    speed : float or str, optional
        Angular speed instead of the case's [rad/s].
    speeds, loads : sequence of float or str, or str, optional
        Several speeds [rad/s], several loads along -y [N]: the result is then a table over both.
    progress : callable, optional
        Called with the share done (0 to 1) and a text.

    Returns
    -------
    xarray.Dataset
        `critical_mass` (inf where no mass whirls), `whirl_ratio` and `threshold_speed` (nan where there is none, as
        `status` tells); along `mode` `natural_frequency`, `mode_growth_rate`, `damping_ratio`, `participation` and
        `whirl_direction` of the rotor's modes that resonate or grow, if its mass is known. A table along `load` and
        `speed` has the first two.

    Raises
    ------
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    from petalfoil.analysis import stability as analysis
    from petalfoil.results.chart import chart_dataset
    from petalfoil.results.dataset import to_dataset

    force, omega = load_of(load), speed_of(speed)
    rotor = None if mass is None else parse_quantity(mass, "kg")
    if speeds is None and loads is None:
        return to_dataset(analysis.run(checked(case), load=force, mass=rotor, speed=omega, progress=progress))
    turn = ([omega] if omega is not None else None) if speeds is None else values_of("speeds", speeds, "rad/s")
    sizes = None if loads is None else values_of("loads", loads, "N")
    return chart_dataset(list(analysis.iterate(checked(case), turn, sizes, load=force, progress=progress)))
