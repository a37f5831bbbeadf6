"""Steps through time that adapt to an error, from a start to an end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.stage_tangent import Tangent
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import Stepped, System, take_step
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.errors import ConvergenceError


@dataclass(frozen=True)
class MarchOptions:
    """Numbers of the march."""

    tolerance: float = 1e-3
    """Local error of a step [reference films, ambient pressures]."""
    first: float = 1e-2
    """First step [units of time]."""
    longest: float = 0.25
    """Longest step: no less than 25 to a turn [units of time]."""
    shortest: float = 1e-9
    """A step below this leads nowhere [units of time]."""
    fixed: bool = False
    """All steps as long as the first, whatever their error."""


@dataclass(frozen=True)
class Pace:
    """The next step, and the tangent that serves it."""

    step: float
    tangent: Tangent | None = None
    calm: int = 0


SAFETY = 0.85
LARGER, LARGEST = 1.3, 3.0
"""A step grows if it may grow by the first factor, for a renewed tangent has its price; by the second at most."""
CALM = 3
"""Steps with a small error before the step may grow."""


def march(system: System, start: Instant, end: float, work: RunLog, options: MarchOptions) -> Iterator[Stepped]:
    """Yield accepted steps from `start` to time `end` [units of time].

    Raises
    ------
    ConvergenceError
        No step, however short, leads on.
    """
    path, pace = [start], Pace(min(options.first, options.longest))
    stage_options = StageOptions(accuracy=1e-2 * options.tolerance)
    while path[-1].tau < end * (1.0 - 1e-12):
        left = end - path[-1].tau
        step = pace.step if pace.step < left * (1.0 - 1e-9) else left
        stepped = take_step(system, path, step, pace.tangent, (work.film_solver, stage_options))
        if stepped is None or (stepped.error > 1.5 * options.tolerance and not options.fixed):
            pace = refused(pace, step, stepped, options)
            why = "no answer" if stepped is None else "error"
            work.note("motion", time=path[-1].tau, step=step, outcome=why)
            if pace.step < options.shortest:
                raise stuck(path[-1], work)
            continue
        path = [*path[-2:], stepped.inner, stepped.end][-3:]
        yield stepped
        pace = accepted(pace, step, stepped, options)


def refused(pace: Pace, step: float, stepped: Stepped | None, options: MarchOptions) -> Pace:
    """A shorter step: by its error, or a quarter where a stage had no answer."""
    if stepped is None:
        return Pace(0.25 * step)
    return Pace(step * max(0.2, SAFETY * (options.tolerance / stepped.error) ** (1.0 / 3.0)))


def accepted(pace: Pace, step: float, stepped: Stepped, options: MarchOptions) -> Pace:
    """The next step: the same while that is about right, so that the tangent goes on serving."""
    if options.fixed:
        return replace(pace, tangent=stepped.tangent)
    right = SAFETY * (options.tolerance / max(stepped.error, 1e-300)) ** (1.0 / 3.0)
    if right < 1.0 / SAFETY * 0.8:
        return Pace(step * max(0.3, right))
    calm = pace.calm + 1 if right > LARGER else 0
    if calm >= CALM and step < options.longest:
        return Pace(min(step * min(right, LARGEST), options.longest))
    return Pace(step, stepped.tangent, calm)


def stuck(instant: Instant, work: RunLog) -> ConvergenceError:
    """No step leads on."""
    where = f"({instant.e[0]:.4g}, {instant.e[1]:.4g}) reference films"
    return ConvergenceError(
        f"the motion found no step that leads on from time {instant.tau:.6g} (units of time) at {where}",
        history=list(work.history),
        advice="refine the grid, lower the load or the unbalance, or ask for a smaller tolerance",
    )
