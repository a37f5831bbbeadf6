"""`sensitivity`: how far a small change of each parameter moves a result, from exact derivatives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Annotated

from petalfoil.analysis.arguments import JournalPosition, Load, Mass, NumbersWithUnit, NumberWithUnit, Speed, Speeds
from petalfoil.analysis.capacity import DOWN, LoadDirection, MinFilm, Stress
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.crossings import CONTACT_FRACTION
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.derivative_sources import DerivativeRequest
from petalfoil.analysis.derivatives_in_series import SERIES, Differentiated, points_of
from petalfoil.analysis.differentiable import (
    MAIN_RESULT,
    WITHOUT_DERIVATIVES,
    asked_verb,
    checked,
    default_paths,
    posed,
    refuse_limits,
    state_of,
)
from petalfoil.analysis.friction_told import refuse_path
from petalfoil.analysis.load_ray import Limits
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.parameter_change import Changes, ParameterChanges
from petalfoil.analysis.records import effort, failed_record, record_of
from petalfoil.analysis.runs import Points
from petalfoil.analysis.sensitivity_table import (
    ALL,
    LAYOUT,
    MATRICES,
    MODES,
    RESULTS,
    SensitivityLine,
    SensitivityRow,
    lines_of,
    ordered,
    rounding_of,
)
from petalfoil.analysis.session import part
from petalfoil.analysis.words import Choice, Names, known
from petalfoil.case import Case, parameter_of
from petalfoil.equilibrium.run_context import Progress, RunContext, running
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.parts import AppliedLoad
from petalfoil.results.record import Record
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role

ANSWERS = [
    name
    for name, variable in SCALARS.items()
    if not variable.dims and variable.kind is DataType.FLOAT and variable.role is Role.ANSWER
] + ["eccentricity_x", "eccentricity_y", "load_capacity", *MATRICES, *chain(*MODES)]
"""Results that a question may have; which of them it has is known once it is answered."""

Vary = Annotated[
    list[str] | None,
    Names(
        metavar="PATHS", help='Parameters, as "petals.thickness, gas.viscosity"; by default all that have an effect.'
    ),
]
Ask = Annotated[
    str | None,
    Choice(
        metavar="VERB",
        words=(*MAIN_RESULT, *WITHOUT_DERIVATIVES),
        help="Whose results: solve, balance, liftoff, capacity, curve, runup, static, coefficients or stability; by "
        "default balance where there is a load, else solve.",
    ),
]
Of = Annotated[
    list[str] | None,
    Names(
        metavar="RESULTS", help='Results, as "min_film_thickness, friction_torque", or "all"; by default the main one.'
    ),
]
AnyLimit = Annotated[
    float | None,
    NumberWithUnit(
        unit="1",
        metavar="FRACTION",
        help="Contact fraction: at lift-off (1 % by default), or allowed by a load capacity.",
        above=0.0,
        below=1.0,
    ),
]
GivenChanges = Annotated[
    dict[str, float | str] | None,
    ParameterChanges(
        metavar="CHANGES",
        help='Change of the parameters, whose effect is printed: "2 %", "5 um" for all lengths, or '
        '"petals.thickness = 5 um, 2 %"; by default 1 %, of journal and bushing radius 1 % of the clearance.',
    ),
]


Distances = Annotated[
    Sequence[float] | None,
    NumbersWithUnit(
        unit="m", metavar="LIST", help='Displacements of `curve` along the direction: "0 um : 280 um : 5".'
    ),
]
WhirlFrequency = Annotated[
    float | None,
    NumberWithUnit(
        unit="rad/s",
        metavar="FREQUENCY",
        help="Whirl frequency of stiffness and damping; by default that of the speed.",
        at_least=0.0,
    ),
]
ADJOINT = "adjoint"
SolveMethod = Annotated[
    str,
    Choice(
        metavar="METHOD",
        words=("tangent", ADJOINT),
        help="How derivatives are solved for: tangent, one linear solve for each parameter, which also tells how far "
        "contacts hold; adjoint, one for each result, quicker for many parameters.",
    ),
]

ContactPlaces = Annotated[
    str,
    Choice(
        metavar="PLACE",
        words=("points", "nodes"),
        help="Where petals touch: points, which move between grid nodes as parameters change; or nodes of the grid, "
        "where derivatives are those of tiny changes, in which no contact moves on to the next node.",
    ),
]


@analysis(LAYOUT, results=RESULTS, excludes={"load": ("eccentricity",)})
def sensitivity(  # noqa: PLR0913 - the options of the verb
    case: Case,
    vary: Vary = None,
    *,
    ask: Ask = None,
    of: Of = None,
    load: Load = None,
    eccentricity: JournalPosition = None,
    speed: Speed = None,
    speeds: Speeds = None,
    displacements: Distances = None,
    contact_fraction: AnyLimit = None,
    min_film_thickness: MinFilm = None,
    max_stress: Stress = None,
    direction: LoadDirection = DOWN,
    frequency: WhirlFrequency = None,
    mass: Mass = None,
    contacts: ContactPlaces = "points",
    method: SolveMethod = "tangent",
    step: GivenChanges = None,
    progress: Progress | None = None,
) -> Points:
    """Tell how far a small change of each parameter moves a result.

    From exact derivatives of the equilibrium, through geometry, grid and
    contacts: a table of parameters by their effect. The effect is derivative
    times change. It is good for changes in which the same petals touch at
    the same places: "contacts hold" tells up to which relative change they
    do, by the same derivatives. With --samples the command
    finds Sobol' indices instead: petalfoil sensitivity --samples 256 --help.

    Example: petalfoil sensitivity case.toml --ask liftoff --load "20 N" --plot tornado.png

    Raises
    ------
    UsageError
        A parameter is none of the case, a whole number or has no value; a result is none of the question; a load
        capacity has no limit.
    ConvergenceError
        The equilibrium was not found, or its contacts do not determine it.
    """
    newton_only(case)
    if not case.shares_evenly:
        raise UsageError(
            "derivatives are those of one bearing, and the bearings of this rotor do not share its load evenly: ask "
            "for one of them alone under its part of the load, as `balance` tells it, or compare two runs"
        )
    verb = asked_verb(case, ask, load, eccentricity)
    refuse_path(case, "derivatives are those")
    there = posed(at(case.replace(**{"model.contacts": contacts}), speed), verb, load, eccentricity)
    paths = default_paths(there, verb) if vary is None else [checked(there, path) for path in vary]
    quantities = [known(name, [ALL, *ANSWERS], "result") for name in of or [MAIN_RESULT[verb]]]
    limits = Limits(min_film_thickness=min_film_thickness, contact_fraction=contact_fraction, max_stress=max_stress)
    fraction = CONTACT_FRACTION if contact_fraction is None else contact_fraction
    asked = DerivativeRequest(
        verb, paths, quantities, Changes(step or {}), vary is None, contacts == "points", fraction, limits, direction,
        frequency, mass, method == ADJOINT, {"curve": displacements, "runup": speeds},
    )  # fmt: skip
    refuse_limits(there, asked)
    asked.changes.check([parameter_of(there, path) for path in paths])
    most = len(ANSWERS) if ALL in quantities else len(quantities)
    points = points_of(there, asked)
    return Points(_points(points, asked, progress), len(paths) * most * len(points), "effects")


def _points(points: list[Differentiated], asked: DerivativeRequest, progress: Progress | None) -> Iterator[Record]:
    """One record for each parameter and result, by the size of the effect; of a series point by point."""
    for number, point in enumerate(points):
        here = part(progress, number, len(points)) if len(points) > 1 else progress
        with running(here, "sensitivity") as run:
            try:
                records = _effects(point, asked, run, here)
            except ConvergenceError as failure:
                if asked.verb not in SERIES:
                    raise
                load = point.case.operation.load
                given = [] if load is None else [AppliedLoad.of(load, point.case.operation.moment)]
                records = [failed_record("sensitivity", point.case, failure, point.where, *given)]
        yield from records


def _effects(
    point: Differentiated, asked: DerivativeRequest, run: RunContext, progress: Progress | None
) -> list[Record]:
    """The records of one equilibrium."""
    case, found = point.case, point.sources()
    there = {name: source for source in found for name in source.values if name in SCALARS}
    quantities = named(asked, list(there))
    sources = {name: there[name] for name in quantities}
    lines, before = [], solves_of(run)
    for number, path in enumerate(asked.paths, 1):
        lines += lines_of(path, sources, asked.changes)
        if progress is not None:
            progress(number / len(asked.paths), f"sensitivity: {path}")
    felt = [line for line in lines if not asked.all_of_them or is_felt(case, line)] or lines
    cost = effort(run.seconds), Solves(solves_of(run) - before)
    own = point.where, *state_of(case, asked.verb), *cost
    records = [
        doubted(record_of("sensitivity", case, line.row, *own, line.outcome), line.row)
        for line in ordered(felt, quantities)
    ]
    silent = {line.row.parameter: True for line in lines if line.row.parameter not in {f.row.parameter for f in felt}}
    if records and silent:
        records[-1] = replace(records[-1], remarks=(f"without effect: {', '.join(silent)}",))
    return records


def doubted(record: Record, row: SensitivityRow) -> Record:
    """The record with a warning where its effect is no estimate of what its change does."""
    if not row.doubts:
        return record
    text = (
        f"effect: of {row.parameter} ({row.change_text}) on {row.quantity} it is {'; '.join(row.doubts)}. Derivatives "
        "tell small changes only; take a smaller --step, or solve the changed case"
    )
    return replace(record, warnings=(*record.warnings, text))


@dataclass(frozen=True)
class Solves:
    """What the derivatives took beside the equilibrium."""

    derivative_solves: int


def solves_of(run: RunContext) -> int:
    """Right-hand sides solved for so far."""
    return run.film.solves + run.pack.solves + run.probes.solves


def named(asked: DerivativeRequest, there: list[str]) -> list[str]:
    """Names of the results that are asked for, of those that are `there`.

    Raises
    ------
    UsageError
        A result is none of the question.
    """
    if ALL in asked.quantities:
        return there
    return [known(name, there, f"result of {asked.verb} here") for name in asked.quantities]


def is_felt(case: Case, line: SensitivityLine) -> bool:
    """Whether a line tells of an effect beyond rounding, or why it tells none; the angle of no force has no effects."""
    if math.isnan(line.row.effect):
        return not line.outcome.converged
    return line.row.is_felt(rounding_of(case, line.row.quantity))
