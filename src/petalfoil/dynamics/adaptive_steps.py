"""Steps through time that adapt to an error, from a start to an end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import AcceptedStep, RotorBearing, take_step
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.tangent import BorderedTangent


@dataclass(frozen=True)
class MarchOptions:
    """Numbers of the adaptive steps."""

    tolerance: float = 1e-3
    """Local error of a step [reference films, ambient pressures]."""
    first: float = 1e-2
    """First step [units of time]."""
    longest: float = 0.25
    """Longest step: no less than 25 to a turn [units of time]."""
    shortest: float = 1e-9
    """Shortest step that is tried [units of time]."""
    fixed: bool = False
    """All steps as long as the first, whatever their error."""


@dataclass(frozen=True)
class NextStep:
    """The next step, the tangent that serves it, and how many steps before had a small error."""

    step: float
    tangent: BorderedTangent | None = None
    calm: int = 0


SAFETY = 0.85
LARGER, LARGEST = 1.3, 3.0
"""A step grows only if the first factor is allowed, for a longer step needs a new tangent; at most by the second."""
CALM = 3
"""Steps with a small error before the step may grow."""
SAME_STEP = 1e-9
"""Relative change of the step up to which its tangent still serves."""


def march(bearing: RotorBearing, start: Instant, end: float, options: MarchOptions) -> Iterator[AcceptedStep]:
    """Yield accepted steps from `start` to time `end` [units of time].

    Raises
    ------
    ConvergenceError
        No step, however short, has a solution.
    """
    path, ahead = [start], NextStep(min(options.first, options.longest))
    stage_options = StageOptions(accuracy=1e-2 * options.tolerance)
    while path[-1].tau < end * (1.0 - 1e-12):
        left = end - path[-1].tau
        step = ahead.step if ahead.step < left * (1.0 - 1e-9) else left
        tangent = ahead.tangent if abs(step / ahead.step - 1.0) < SAME_STEP else None
        stepped = take_step(bearing, path, step, tangent, stage_options)
        if stepped is None or (stepped.error > 1.5 * options.tolerance and not options.fixed):
            ahead = refused(ahead, step, stepped, options)
            why = "no answer" if stepped is None else "error"
            current_run().note("motion", time=path[-1].tau, step=step, outcome=why)
            if ahead.step < options.shortest:
                raise stuck(bearing, path[-1])
            continue
        path = [*path[-2:], stepped.inner, stepped.end][-3:]
        yield stepped
        ahead = accepted(ahead, step, stepped, options)


def refused(ahead: NextStep, step: float, stepped: AcceptedStep | None, options: MarchOptions) -> NextStep:
    """A shorter step: by its error, or a quarter where a stage had no solution."""
    if stepped is None:
        return NextStep(0.25 * step)
    return NextStep(step * max(0.2, SAFETY * (options.tolerance / stepped.error) ** (1.0 / 3.0)))


def accepted(ahead: NextStep, step: float, stepped: AcceptedStep, options: MarchOptions) -> NextStep:
    """The next step: the same as long as that is about right, so that the tangent still serves."""
    if options.fixed:
        return replace(ahead, tangent=stepped.tangent)
    right = SAFETY * (options.tolerance / max(stepped.error, 1e-300)) ** (1.0 / 3.0)
    if right < 1.0 / SAFETY * 0.8:
        return NextStep(step * max(0.3, right))
    calm = ahead.calm + 1 if right > LARGER else 0
    if calm >= CALM and step < options.longest:
        return NextStep(min(step * min(right, LARGEST), options.longest))
    return NextStep(step, stepped.tangent, calm)


def stuck(bearing: RotorBearing, instant: Instant) -> ConvergenceError:
    """The error of a motion that no step continues."""
    milliseconds = 1e3 * instant.tau / bearing.rotor.clock.rate
    x, y = 1e6 * instant.e[:2] * bearing.problem.layout.scales.length
    return ConvergenceError(
        f"no time step, however short, has a solution after {milliseconds:.6g} ms, with the journal at "
        f"({x:.4g} µm, {y:.4g} µm)",
        history=list(current_run().history),
        advice="refine the grid, lower the load or the unbalance, or ask for a smaller tolerance",
    )
