"""Steps through time that adapt to an error, from a start to an end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from petalfoil.dynamics.compiled_stages import worth_compiling
from petalfoil.dynamics.point_path import KNOTS
from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import AcceptedStep, RotorBearing, Tangents, take_step
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError


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


LOOSEST = 1e-5
"""Largest correction that a stage may leave, however large an error of its step may be [reference films, ambient
pressures]: guesses amplify what earlier stages have left."""

HELD, SELDOM = 16, 128
"""Steps with contacts at nodes before points are looked for again; twice as many each time that they are lost. The
second is that of a motion that begins without points, five turns of the longest step."""


@dataclass(frozen=True)
class NextStep:
    """The next step.

    Attributes
    ----------
    step : float
        Its length [units of time].
    tangent : BorderedTangent, ElementTangent, LineTangent or None
        The tangent that serves it.
    calm : int
        Steps before it whose error was small.
    lost : int
        Attempts that found no contact points since steps last were calm.
    at_nodes : int
        Steps that still hold contacts at nodes.
    hold : int
        Steps that will hold them there when points are lost the next time.
    with_points : int
        Steps with contact points since they were lost.
    """

    step: float
    tangent: Tangents | None = None
    calm: int = 0
    lost: int = 0
    at_nodes: int = 0
    hold: int = HELD
    with_points: int = 0

    @classmethod
    def first(cls, bearing: RotorBearing, start: Instant, step: float) -> NextStep:
        """The first step: where the start has no contact points, there are none near by as a rule."""
        if not bearing.between_nodes or start.between_nodes:
            return cls(step)
        return cls(step, at_nodes=SELDOM, hold=2 * SELDOM)

    @property
    def attempts(self) -> int:
        """Attempts without contact points after which contacts are held at nodes: one where points are seldom found."""
        return LOST if self.hold == HELD else 1


SAFETY = 0.85
LARGER, LARGEST = 1.3, 3.0
"""A step grows only if the first factor is allowed, for a longer step needs a new tangent; at most by the second."""
CALM = 3
"""Steps with a small error before the step may grow."""
LOST = 3
"""Attempts without contact points, each a quarter as long, after which contacts are held at nodes."""
SAME_STEP = 1e-9
"""Relative change of the step up to which its tangent still serves."""


def march(bearing: RotorBearing, start: Instant, end: float, options: MarchOptions) -> Iterator[AcceptedStep]:
    """Yield accepted steps from `start` to time `end` [units of time].

    Raises
    ------
    ConvergenceError
        No step, however short, has a solution.
    """
    if worth_compiling(bearing, (end - start.tau) / options.longest):
        bearing = replace(bearing, compiled=True)
    path, ahead = [start], NextStep.first(bearing, start, min(options.first, options.longest))
    stage_options = StageOptions(accuracy=min(1e-2 * options.tolerance, LOOSEST))
    while path[-1].tau < end * (1.0 - 1e-12):
        left = end - path[-1].tau
        step = ahead.step if ahead.step < left * (1.0 - 1e-9) else left
        tangent = ahead.tangent if abs(step / ahead.step - 1.0) < SAME_STEP else None
        held = ahead.at_nodes > 0
        stepped = take_step(bearing.at_nodes if held else bearing, path, step, tangent, stage_options)
        if stepped is None or (stepped.error > 1.5 * options.tolerance and judged(path[-1], stepped, options)):
            why = "error" if stepped is not None else "no answer" if held or not bearing.between_nodes else "no points"
            ahead = refused(ahead, step, stepped, options) if why != "no points" else without_points(ahead, step)
            current_run().note("motion", time=path[-1].tau, step=step, outcome=why)
            if ahead.step < options.shortest:
                raise stuck(bearing, path[-1])
            continue
        turned = not judged(path[-1], stepped, options)
        path = [*path, stepped.inner, stepped.end][-KNOTS:]
        yield stepped
        ahead = accepted(ahead, step, stepped, options, turned=turned)


def judged(begin: Instant, stepped: AcceptedStep, options: MarchOptions) -> bool:
    """Whether a step may be refused for its error.

    Where contacts pass from points to nodes, or back, rates at its begin are those of the other contacts: the
    difference is that of the grid, and no shorter step lessens it.
    """
    return not options.fixed and begin.between_nodes is stepped.end.between_nodes


def refused(ahead: NextStep, step: float, stepped: AcceptedStep | None, options: MarchOptions) -> NextStep:
    """A shorter step: by its error, or a quarter where a stage had no solution."""
    part = 0.25 if stepped is None else max(0.2, SAFETY * (options.tolerance / stepped.error) ** (1.0 / 3.0))
    return replace(ahead, step=part * step, tangent=None, calm=0)


def without_points(ahead: NextStep, step: float) -> NextStep:
    """After an attempt that found no contact points: a shorter step; after some of them contacts at nodes.

    Each time that points are lost anew, nodes hold for twice as many steps: a search costs as much as tens of steps.
    """
    if ahead.lost + 1 < ahead.attempts:
        return replace(ahead, step=0.25 * step, tangent=None, calm=0, lost=ahead.lost + 1)
    return NextStep(step * 4.0**ahead.lost, at_nodes=ahead.hold, hold=2 * ahead.hold)


def accepted(ahead: NextStep, step: float, stepped: AcceptedStep, options: MarchOptions, *, turned: bool) -> NextStep:
    """The next step: the same as long as that is about right, so that the tangent still serves."""
    served = 0 if not stepped.end.between_nodes else ahead.with_points + 1
    hold = HELD if served >= ahead.hold else ahead.hold
    ahead = replace(ahead, at_nodes=max(ahead.at_nodes - 1, 0), with_points=served, hold=hold)
    if options.fixed:
        return replace(ahead, tangent=stepped.tangent)
    if turned:
        return replace(ahead, step=step, tangent=stepped.tangent, calm=0)
    right = SAFETY * (options.tolerance / max(stepped.error, 1e-300)) ** (1.0 / 3.0)
    if right < 1.0 / SAFETY * 0.8:
        return replace(ahead, step=step * max(0.3, right), tangent=None, calm=0)
    calm = ahead.calm + 1 if right > LARGER else 0
    if calm >= CALM and stepped.end.between_nodes:
        ahead = replace(ahead, lost=0)
    if calm >= CALM and step < options.longest:
        longer = min(step * min(right, LARGEST), options.longest)
        return replace(ahead, step=longer, tangent=None, calm=0)
    return replace(ahead, step=step, tangent=stepped.tangent, calm=calm)


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
