"""Stiffness and damping of the bearing over whirl frequency at an operating point (model, question 6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.balance import given_load, loaded
from petalfoil.analysis.equilibrium import Named, chosen, positioned
from petalfoil.analysis.figures import effort, forces, given
from petalfoil.analysis.session import Clock, Progress, one_thread, telling_work
from petalfoil.case import Case
from petalfoil.equilibria.answer import Answer
from petalfoil.equilibria.balancing import balance_cold
from petalfoil.equilibria.response import respond
from petalfoil.equilibria.work import Work
from petalfoil.errors import UsageError
from petalfoil.problem.build import build_problem
from petalfoil.results.record import Record

Array = NDArray[np.float64]


def run(
    case: Case,
    frequencies: Sequence[float] | None = None,
    *,
    load: tuple[float, float] | None = None,
    speed: float | None = None,
    progress: Progress | None = None,
) -> Record:
    """Coefficients at whirl `frequencies` [rad/s] (by default the speed itself), at the case's position or load.

    `dF = -(K + i Omega C) de` for a displacement `de exp(i Omega t)`; contacts that carry load stay closed.

    Raises
    ------
    UsageError
        A shaft at rest has no film that could respond, or a frequency is negative.
    ConvergenceError
        The operating point was not found.
    """
    clock, work = Clock(), telling_work(progress, "coefficients")
    case = positioned(case, speed, None)
    if not case.operation.speed > 0.0:
        raise UsageError("coefficients need a turning shaft: give a speed above zero")
    wanted = np.array([case.operation.speed] if frequencies is None else list(frequencies), dtype=float)
    if np.any(wanted < 0.0) or not len(wanted):
        raise UsageError("whirl frequencies must not be negative")
    with one_thread():
        answer, about = operating_point(case, load, work)
        pairs = [impedance(answer, frequency, case.operation.speed, work) for frequency in wanted]
    e = answer.problem.displacement * answer.problem.layout.scales.length
    scalars: Named = {
        **given(case),
        **about,
        **effort(work),
        "residual": answer.residual,
        "converged": True,
        "status": "converged",
        "eccentricity_x": float(e[0]),
        "eccentricity_y": float(e[1]),
        "contact_share": forces(case, answer)["contact_share"],
        "wall_time": clock.seconds,
    }
    return Record(
        analysis="coefficients",
        scalars=scalars,
        fields={"stiffness": np.array([K for K, _ in pairs]), "damping": np.array([C for _, C in pairs])},
        coords={"whirl_frequency": wanted, "row": np.arange(2), "column": np.arange(2)},
        case_toml=case.to_toml(),
        title=case.title,
        history=list(work.history),
    )


def operating_point(case: Case, load: tuple[float, float] | None, work: Work) -> tuple[Answer, Named]:
    """The balance under a load where one is given, else the case's eccentricity."""
    if load is None and case.operation.load is None:
        return chosen(case, work)
    wanted = loaded(case, load)
    problem = build_problem(case.replace(**{"operation.eccentricity": (0.0, 0.0)}))
    found = balance_cold(problem, np.array(wanted) / problem.layout.scales.force, work)
    return found.answer, {**given_load(wanted), "force_residual": found.force_residual, "branch": found.answer.way}


def impedance(answer: Answer, frequency: float, speed: float, work: Work) -> tuple[Array, Array]:
    """`K` [N/m] and `C` [N s/m] at one whirl frequency [rad/s], each (2, 2); one factorisation.

    At a frequency of zero, `C` is the limit of small ones.
    """
    scales = answer.problem.layout.scales
    nu = max(frequency / speed, SLOW)
    state = (answer.problem, answer.x, answer.in_contact)
    Z = -respond(state, nu, work.probe_solver).force_gradient() * scales.force / scales.length
    return Z.real, Z.imag / (nu * speed)


SLOW = 1e-6
"""Whirl ratio that stands for zero: stiffness depends on its square."""
