"""Where the results of each question have their derivatives."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from petalfoil.analysis.adjoint import TANGENT, AdjointDerivatives
from petalfoil.analysis.capacity_derivatives import capacity_derivatives
from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.crossing_derivatives import CrossingDerivatives
from petalfoil.analysis.derivatives import GROWTH, DerivativesOf, Results, equilibrium_results, results_with_growth
from petalfoil.analysis.heated_derivatives import derivatives_of
from petalfoil.analysis.liftoff import own_load
from petalfoil.analysis.liftoff_derivatives import speed_derivatives
from petalfoil.analysis.load_ray import Limits
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.response_derivatives import THRESHOLD, coefficient_results, stability_derivatives
from petalfoil.analysis.sensitivity_table import ALL, Source
from petalfoil.case import Case
from petalfoil.equilibrium.continuation import rest
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.system.build import build_problem


@dataclass(frozen=True)
class DerivativeRequest:
    """What derivatives are asked for.

    Attributes
    ----------
    verb : str
        The question that they belong to.
    paths : list of str
        Parameters.
    quantities : list of str
        Results.
    step : float
        Relative change of the parameters whose effect is told [1].
    all_of_them : bool
        Whether the parameters are all that the case has, so that those without effect are left out.
    as_points : bool
        Whether isolated contacts travel between nodes.
    contact_fraction : float or None
        Limit of the contact fraction [1].
    limits : Limits
        All limits of a load capacity.
    direction : float
        Direction of its load [rad].
    frequency : float or None
        Whirl frequency of stiffness and damping [rad/s]; None for that of the speed.
    mass : float or None
        Mass of the rotor whose threshold speed is asked for [kg]; None for that of the case or its load.
    by_adjoint : bool
        Whether each result has a solve of its own, in place of each parameter.
    """

    verb: str
    paths: list[str]
    quantities: list[str]
    step: float
    all_of_them: bool
    as_points: bool
    contact_fraction: float
    limits: Limits
    direction: float
    frequency: float | None = None
    mass: float | None = None
    by_adjoint: bool = False


def sources_of(case: Case, asked: DerivativeRequest) -> Sequence[Source]:
    """Where the results of a question have their derivatives.

    Raises
    ------
    ConvergenceError
        The equilibrium was not found.
    UsageError
        A result has no adjoint, and is asked for by one.
    """
    found = by_tangent(case, asked)
    return [with_adjoint(source, asked) for source in found] if asked.by_adjoint else found


def with_adjoint(source: Source, asked: DerivativeRequest) -> Source:
    """The same by the adjoint.

    Raises
    ------
    UsageError
        There is none.
    """
    if isinstance(source, CrossingDerivatives) and isinstance(source.balance, DerivativesOf):
        return replace(source, balance=AdjointDerivatives(source.balance, [source.limited]))
    if isinstance(source, DerivativesOf):
        if ALL in asked.quantities:
            return AdjointDerivatives.of_all(source)
        return AdjointDerivatives(source, [name for name in asked.quantities if name in source.values])
    raise UsageError(f"no adjoint with [heat]: {TANGENT}")


def by_tangent(case: Case, asked: DerivativeRequest) -> Sequence[Source]:
    """Where they have them by the tangent; see `sources_of`."""
    if asked.verb == "liftoff":
        return speed_derivatives(case, own_load(case), asked.contact_fraction, as_points=asked.as_points)
    if asked.verb == "capacity":
        direction = (round(math.cos(asked.direction), 15), round(math.sin(asked.direction), 15))
        return capacity_derivatives(case, asked.limits, direction, as_points=asked.as_points)
    if asked.verb == "static":
        at_rest = reported(case, at_zero_speed(case))
        return [derivatives_of(case, at_rest, results_at_rest, as_points=asked.as_points)]
    if asked.verb == "stability":
        threshold = THRESHOLD in asked.quantities
        return stability_derivatives(case, asked.mass, threshold=threshold, as_points=asked.as_points)
    solution = operating_point(case, None).answer
    if asked.verb == "coefficients":
        return [derivatives_of(case, solution, coefficient_results(asked.frequency), as_points=asked.as_points)]
    results = results_with_growth(solution) if set(asked.quantities) & set(GROWTH) else equilibrium_results
    return [derivatives_of(case, solution, results, as_points=asked.as_points)]


def at_zero_speed(case: Case) -> Solution:
    """The foil pack at zero speed.

    Raises
    ------
    ConvergenceError
        It was not found.
    """
    found = rest(build_problem(case))
    if found is None:
        raise ConvergenceError(
            "the foil pack at zero speed was not found",
            history=current_run().history,
            advice="ask `static` for the displacements at which it is",
        )
    return found


def results_at_rest(case: Case, solution: Solution) -> Results:
    """Results of a foil pack at zero speed: its friction is that against a journal that begins to turn."""
    results = equilibrium_results(case, solution)
    return {**results, "starting_torque": results["friction_torque"]}
