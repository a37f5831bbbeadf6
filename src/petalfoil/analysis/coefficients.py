"""Stiffness and damping of the bearing over whirl frequency and speed at operating points (model, question 6)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.balance import given_load, loaded, settled
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.equilibrium import Named, chosen, positioned
from petalfoil.analysis.figures import effort, failed_record, forces, given
from petalfoil.analysis.session import Clock, Progress, one_thread, part, telling_work
from petalfoil.case import Case
from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.response import Motion
from petalfoil.equilibria.work import Work
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.record import Record

Array = NDArray[np.float64]
Load = tuple[float, float]


def run(
    case: Case,
    frequencies: Sequence[float] | None = None,
    *,
    load: Load | None = None,
    speed: float | None = None,
    progress: Progress | None = None,
) -> Record:
    """Coefficients at whirl `frequencies` [rad/s] (by default the speed itself), at the case's position or load.

    `dF = -(K + i Omega C) de` for a displacement `de exp(i Omega t)` (E5); contacts that carry load stay closed.

    Raises
    ------
    UsageError
        A shaft at rest has no film that could respond, or a frequency is negative.
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    case = positioned(case, speed, None)
    newton_only(case)
    wanted = whirl([case.operation.speed], frequencies)
    return point(case, wanted, load, telling_work(progress, "coefficients"))


def iterate(
    case: Case,
    speeds: Sequence[float],
    frequencies: Sequence[float] | None = None,
    *,
    load: Load | None = None,
    progress: Progress | None = None,
) -> Iterator[Record]:
    """Yield the coefficients at each of the `speeds` [rad/s], all at the same `frequencies` (by default the speeds).

    Raises
    ------
    UsageError
        A speed is not positive, or a frequency is negative.
    """
    newton_only(case)
    wanted = whirl(speeds, frequencies)
    return _records([positioned(case, speed, None) for speed in speeds], wanted, load, progress)


def _records(cases: list[Case], wanted: Array, load: Load | None, progress: Progress | None) -> Iterator[Record]:
    for number, case in enumerate(cases):
        work = telling_work(part(progress, number, len(cases)), "coefficients")
        try:
            record = point(case, wanted, load, work)
        except ConvergenceError as failure:
            asked = load if load is not None else case.operation.load
            extra = {} if asked is None else given_load(asked)
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


def point(case: Case, wanted: Array, load: Load | None, work: Work) -> Record:
    """The record of one operating point.

    Raises
    ------
    ConvergenceError
        The operating point was not found, or it is pressed solid.
    """
    clock = Clock()
    with one_thread():
        answer, known = operating_point(case, load, work)
        motion = elastic(answer, work)
        pairs = [impedance(motion, frequency, case.operation.speed, work) for frequency in wanted]
    scalars: Named = {**given(case), **known, **at_position(case, answer), **effort(work), "wall_time": clock.seconds}
    return Record(
        analysis="coefficients",
        scalars=scalars,
        fields={"stiffness": np.array([K for K, _ in pairs]), "damping": np.array([C for _, C in pairs])},
        coords={"whirl_frequency": wanted, "row": np.arange(2), "column": np.arange(2)},
        case_toml=case.to_toml(),
        title=case.title,
        history=list(work.history),
    )


def operating_point(case: Case, load: Load | None, work: Work) -> tuple[Answer, Named]:
    """The balance under a load where one is given, else the case's eccentricity."""
    if load is None and case.operation.load is None:
        return chosen(case, work)
    wanted = loaded(case, load)
    found, known = settled(positioned(case, None, (0.0, 0.0)), wanted, work)
    return found.answer, {**known, **given_load(wanted), "force_residual": found.force_residual}


def at_position(case: Case, answer: Answer) -> Named:
    """Where the journal is and what is to be known of the state there."""
    e = answer.problem.displacement * answer.problem.layout.scales.length
    return {
        "eccentricity_x": float(e[0]),
        "eccentricity_y": float(e[1]),
        "contact_share": forces(case, answer)["contact_share"],
        "residual": answer.residual,
        "converged": True,
        "status": "converged",
    }


def elastic(answer: Answer, work: Work) -> Motion:
    """Small motions about `answer`, if the bearing gives way there.

    Raises
    ------
    ConvergenceError
        It is pressed solid: the journal cannot move without bending what has no room to bend.
    """
    motion = Motion.about(answer)
    if not motion.ties.determinate:
        raise ConvergenceError(
            "no coefficients: the journal is pressed on what is pressed solid, its stiffness has no bound",
            history=work.history,
            advice="lower the load, or ask `balance` which share of it the contacts carry",
        )
    return motion


def impedance(motion: Motion, frequency: float, speed: float, work: Work) -> tuple[Array, Array]:
    """`K` [N/m] and `C` [N s/m] at one whirl frequency [rad/s], each (2, 2); one factorisation.

    At a frequency of zero, `C` is the limit of small ones.
    """
    scales = motion.problem.layout.scales
    nu = max(frequency / speed, SLOW)
    Z = -motion.respond(nu, work.probe_solver).force_gradient() * scales.force / scales.length
    return Z.real, Z.imag / (nu * speed)


SLOW = 1e-6
"""Whirl ratio that stands for zero: stiffness depends on its square."""
