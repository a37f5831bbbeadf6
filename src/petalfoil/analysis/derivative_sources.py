"""Where the results of each question have their derivatives."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from petalfoil.analysis.adjoint import AdjointDerivatives
from petalfoil.analysis.capacity_derivatives import capacity_derivatives
from petalfoil.analysis.contact_model import reported
from petalfoil.analysis.crossing_derivatives import CrossingDerivatives
from petalfoil.analysis.derivatives import (
    GROWTH,
    ByParameters,
    Derivative,
    DerivativesOf,
    Results,
    equilibrium_results,
    results_with_growth,
)
from petalfoil.analysis.heated_derivatives import Derivatives, derivatives_of
from petalfoil.analysis.liftoff import own_load
from petalfoil.analysis.liftoff_derivatives import speed_derivatives
from petalfoil.analysis.load_ray import Limits
from petalfoil.analysis.operating_point import operating_point
from petalfoil.analysis.parameter_change import Changes
from petalfoil.analysis.response_derivatives import coefficient_results, stability_derivatives, with_lines_of_motion
from petalfoil.analysis.sensitivity_table import ALL, Source
from petalfoil.analysis.smooth_equilibrium import over_asperities
from petalfoil.analysis.varied_case import VariedCase
from petalfoil.case import Case
from petalfoil.equilibrium.continuation import rest
from petalfoil.equilibrium.led_points import with_nodal_contacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
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
    changes : Changes
        Changes of the parameters whose effect is told.
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
    series : mapping
        Displacements of a `curve` [m] and speeds of a `runup` [rad/s]; None of other questions.
    """

    verb: str
    paths: list[str]
    quantities: list[str]
    changes: Changes
    all_of_them: bool
    as_points: bool
    contact_fraction: float
    limits: Limits
    direction: float
    frequency: float | None = None
    mass: float | None = None
    by_adjoint: bool = False
    series: Mapping[str, Sequence[float] | None] = field(default_factory=dict)


def sources_of(case: Case, asked: DerivativeRequest) -> Sequence[Source]:
    """Where the results of a question have their derivatives.

    Raises
    ------
    ConvergenceError
        The equilibrium was not found.
    """
    return best_of(by_tangent(case, asked), asked)


def best_of(sources: Sequence[Derivatives | CrossingDerivatives], asked: DerivativeRequest) -> Sequence[Source]:
    """The same by the adjoint where it is asked for, or has less rounding."""
    found: list[Source] = []
    for source in sources:
        found += with_adjoint(source, asked) if asked.by_adjoint or rounded(source) else [source]
    return found


def rounded(source: Derivatives | CrossingDerivatives) -> bool:
    """Whether contact pressures over asperities carry: the tangent takes differences of them over 5 nm."""
    whole = source.balance if isinstance(source, CrossingDerivatives) else source
    return isinstance(whole, DerivativesOf) and over_asperities(whole.told)


@dataclass(frozen=True, eq=False)
class TangentInstead(ByParameters):
    """Derivatives by the tangent of results that have no adjoint, which their status tells.

    Attributes
    ----------
    source : ByParameters
        Where they are.
    why : str
        What has no adjoint, for people.
    """

    source: Derivatives | CrossingDerivatives
    why: str

    @property
    def values(self) -> Results:
        """The results."""
        return self.source.values

    @property
    def residual(self) -> float:
        """Residual of the equilibrium."""
        return self.source.residual

    def variation(self, path: str) -> VariedCase:
        """The case at values of the parameter `path`; see `DerivativesOf.variation`."""
        return self.source.variation(path)

    def along(self, variation: VariedCase) -> Derivative:
        """Derivatives along a variation of the case."""
        found = self.source.along(variation)
        remarks = filter(None, [f"no adjoint {self.why}: by the tangent", found.remark])
        return replace(found, remark="; ".join(remarks))


def with_adjoint(source: Derivatives | CrossingDerivatives, asked: DerivativeRequest) -> Sequence[Source]:
    """The same by the adjoint, and by the tangent for results that have none."""
    whole = source.balance if isinstance(source, CrossingDerivatives) else source
    if not isinstance(whole, DerivativesOf):
        return [TangentInstead(source, "with [heat]")]
    if whole.told.elements is None and (whole.told.lines is not None or whole.with_points is not None):
        return [TangentInstead(source, "where contacts are between nodes of the grid")]
    adjoint = AdjointDerivatives.of_all(whole)
    if isinstance(source, CrossingDerivatives):
        if source.limited not in adjoint.names or source.by_quantity.at_kink:
            return [TangentInstead(source, f"of {source.limited} here") if asked.by_adjoint else source]
        return [replace(source, balance=replace(adjoint, names=[source.limited]))]
    names = [name for name in adjoint.names if ALL in asked.quantities or name in asked.quantities]
    rest: Source = TangentInstead(source, "of this result") if asked.by_adjoint else source
    return [rest, replace(adjoint, names=names)] if names else [rest]


def by_tangent(case: Case, asked: DerivativeRequest) -> Sequence[Derivatives | CrossingDerivatives]:
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
        return stability_derivatives(case, asked.mass, asked.quantities, as_points=asked.as_points)
    solution = with_nodal_contacts(operating_point(case, None).answer)
    if asked.verb == "coefficients":
        results, about = coefficient_results(asked.frequency), with_lines_of_motion(case, solution)
        return [derivatives_of(case, about, results, as_points=asked.as_points)]
    return [of_equilibrium(case, solution, asked)]


def of_equilibrium(case: Case, solution: Solution, asked: DerivativeRequest) -> Derivatives:
    """Derivatives of the results of an equilibrium; of its leading eigenvalue where that is asked for.

    In 3-D the eigenvalue is that of contacts at nodes.
    """
    if not set(asked.quantities) & set(GROWTH):
        return derivatives_of(case, solution, equilibrium_results, as_points=asked.as_points)
    return derivatives_of(case, replace(solution, lines=None), results_with_growth(solution), as_points=asked.as_points)


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
