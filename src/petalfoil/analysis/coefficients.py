"""Stiffness and damping of the bearing over whirl frequency and speed at operating points (model, question 6)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.balance import given_load, loaded, settled
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.equilibrium import Named, chosen, positioned
from petalfoil.analysis.figures import effort, failed_record, forces, given
from petalfoil.analysis.session import Clock, Progress, one_thread, part, telling_work
from petalfoil.case import Case
from petalfoil.dynamics.harmonic_balance import Cycle, Sliding
from petalfoil.equilibrium.linear_response import Motion
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record
from petalfoil.system.friction import friction_of
from petalfoil.walls import Capability, required

Array = NDArray[np.float64]
Load = tuple[float, float]
Wanted = tuple[Array, float | None]
"""Whirl frequencies [rad/s], and the amplitude at which petals rub [m]."""


def run(
    case: Case,
    frequencies: Sequence[float] | None = None,
    *,
    load: Load | None = None,
    speed: float | None = None,
    amplitude: float | None = None,
    progress: Progress | None = None,
) -> Record:
    """Coefficients at whirl `frequencies` [rad/s] (by default the speed itself), at the case's position or load.

    `dF = -(K + i Omega C) de` for a displacement `de exp(i Omega t)` (E5); contacts that carry load stay closed. Petals
    with friction stick, or rub in cycles of an `amplitude` of the journal [m] (E11).

    Raises
    ------
    UsageError
        A shaft at rest has no film that could respond; a frequency is negative, or zero with an amplitude; an amplitude
        is not positive, or nothing rubs.
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    case = positioned(case, speed, None)
    newton_only(case)
    wanted = whirl([case.operation.speed], frequencies)
    check_amplitude(case, wanted, amplitude)
    return point(case, (wanted, amplitude), load, telling_work(progress, "coefficients"))


def iterate(
    case: Case,
    speeds: Sequence[float],
    frequencies: Sequence[float] | None = None,
    *,
    load: Load | None = None,
    amplitude: float | None = None,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield the coefficients at each of the `speeds` [rad/s], all at the same `frequencies` (by default the speeds).

    Raises
    ------
    UsageError
        A speed is not positive, a frequency or the amplitude is not as `run` wants them.
    """
    newton_only(case)
    wanted = whirl(speeds, frequencies)
    check_amplitude(case, wanted, amplitude)
    return _records([positioned(case, speed, None) for speed in speeds], (wanted, amplitude), load, progress)


def _records(cases: list[Case], wanted: Wanted, load: Load | None, progress: Progress | None) -> Iterator[Record]:
    for number, case in enumerate(cases):
        work = telling_work(part(progress, number, len(cases)), "coefficients")
        try:
            record = point(case, wanted, load, work)
        except ConvergenceError as failure:
            asked = load if load is not None else case.operation.load
            extra = {**({} if asked is None else given_load(asked)), **given_amplitude(wanted[1])}
            record = failed_record("coefficients", case, f"not converged: {failure}", work, extra)
        yield record


def whirl(speeds: Sequence[float], frequencies: Sequence[float] | None) -> Array:
    """The whirl frequencies of a run at `speeds` [rad/s], (n,), checked.

    Raises
    ------
    UsageError
        A speed is not positive, or a frequency is negative.
    """
    if not speeds or any(not speed > 0.0 for speed in speeds):
        raise UsageError("coefficients need a turning shaft: give speeds above zero")
    wanted = np.array(list(speeds) if frequencies is None else list(frequencies), dtype=float)
    if np.any(wanted < 0.0) or not len(wanted):
        raise UsageError("whirl frequencies must not be negative")
    return wanted


def check_amplitude(case: Case, frequencies: Array, amplitude: float | None) -> None:
    """Refuse an amplitude that is not one, or that changes nothing.

    Raises
    ------
    UsageError
        It is not positive, no petals rub, or a frequency is zero.
    """
    if amplitude is None:
        return
    if not 0.0 < amplitude < math.inf:
        raise UsageError("the amplitude must be positive; without one, petals with friction stick")
    required(case, Capability.RUBBING, "an amplitude")
    if not case.surface.petal_friction > 0.0:
        raise UsageError("an amplitude says how far petals rub, and here none do: surface.petal_friction is 0")
    if np.any(frequencies == 0.0):
        raise UsageError(
            "with an amplitude, whirl frequencies must be above zero: what friction takes in a cycle does not vanish "
            "with the frequency, so its equivalent damping has no bound"
        )


def given_amplitude(amplitude: float | None) -> Named:
    """The amplitude asked for, if one was."""
    return {} if amplitude is None else {"whirl_amplitude": amplitude}


def point(case: Case, wanted: Wanted, load: Load | None, work: RunLog) -> Record:
    """The record of one operating point; `wanted` are the whirl frequencies [rad/s] and the amplitude [m].

    Raises
    ------
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    clock, (frequencies, amplitude), speed = Clock(), wanted, case.operation.speed
    with one_thread():
        answer, known = operating_point(case, load, work)
        motion, sliding = elastic(case, answer, work), sliding_at(case, answer)
        if amplitude is None or sliding is None:
            pairs = [impedance(motion, frequency, speed, work) for frequency in frequencies]
        else:
            free, rubs = replace(motion, held=None), (sliding, amplitude)
            pairs = [cycle_impedance(free, frequency, speed, rubs, work) for frequency in frequencies]
    asked: Named = {**given(case), **known, **at_position(case, answer), **given_amplitude(amplitude)}
    return Record(
        analysis="coefficients",
        scalars={**asked, **effort(work), "wall_time": clock.seconds},
        fields={"stiffness": np.array([K for K, _ in pairs]), "damping": np.array([C for _, C in pairs])},
        coords={"whirl_frequency": frequencies, "row": np.arange(2), "column": np.arange(2)},
        case_toml=case.to_toml(),
        title=case.title,
        history=list(work.history),
    )


def operating_point(case: Case, load: Load | None, work: RunLog) -> tuple[Solution, Named]:
    """The balance under a load where one is given, else the case's eccentricity."""
    if load is None and case.operation.load is None:
        return chosen(case, work)
    wanted = loaded(case, load)
    found, known = settled(positioned(case, None, (0.0, 0.0)), wanted, work)
    return found.answer, {**known, **given_load(wanted), "force_residual": found.force_residual}


def at_position(case: Case, answer: Solution) -> Named:
    """Where the journal is and what is to be known of the state there."""
    e = answer.problem.displacement * answer.problem.layout.scales.length
    return {
        "eccentricity_x": float(e[0]),
        "eccentricity_y": float(e[1]),
        "contact_fraction": forces(case, answer)["contact_fraction"],
        "residual": answer.residual,
        "converged": True,
        "status": "converged",
    }


def sliding_at(case: Case, answer: Solution) -> Sliding | None:
    """Contacts that slide under load, if petals have friction."""
    friction = friction_of(case, answer.problem.layout)
    return None if friction is None else Sliding.at(friction, answer)


def elastic(case: Case, answer: Solution, work: RunLog) -> Motion:
    """Small motions about `answer`, if the bearing gives way there; petals with friction stick.

    Raises
    ------
    ConvergenceError
        It is pressed solid: the journal cannot move without bending what has no room to bend.
    """
    sliding = sliding_at(case, answer)
    motion = Motion.about(answer, None if sliding is None else sliding.stuck(len(answer.x)))
    if not motion.ties.determinate:
        raise ConvergenceError(
            "no coefficients: the journal is pressed on what is pressed solid, its stiffness has no bound",
            history=work.history,
            advice="lower the load, or ask `balance` which share of it the contacts carry",
        )
    return motion


def impedance(motion: Motion, frequency: float, speed: float, work: RunLog) -> tuple[Array, Array]:
    """`K` [N/m] and `C` [N s/m] at one whirl frequency [rad/s], each (2, 2); one factorisation.

    At a frequency of zero, `C` is the limit of small ones.
    """
    scales = motion.problem.layout.scales
    nu = max(frequency / speed, SLOW)
    Z = -motion.respond(nu, work.probe_solver).force_gradient() * scales.force / scales.length
    return Z.real, Z.imag / (nu * speed)


SLOW = 1e-6
"""Whirl ratio that stands for zero: stiffness depends on its square."""


def cycle_impedance(
    motion: Motion, frequency: float, speed: float, rubs: tuple[Sliding, float], work: RunLog
) -> tuple[Array, Array]:
    """The same where contacts rub in a whirl of an amplitude [m]; `motion` is without their friction.

    Raises
    ------
    ConvergenceError
        Slips and friction did not agree.
    """
    scales, (sliding, amplitude) = motion.problem.layout.scales, rubs
    cycle = Cycle(sliding, motion.respond(frequency / speed, work.probe_solver), amplitude / scales.length)
    Z = -cycle.force_gradient(work) * scales.force / scales.length
    return Z.real, Z.imag / frequency
