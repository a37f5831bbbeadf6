"""`sensitivity`: how far a small change of each parameter moves a result, from exact derivatives."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Annotated

from petalfoil.analysis.arguments import JournalPosition, Load, Mass, NumberWithUnit, Speed
from petalfoil.analysis.capacity import DOWN, LoadDirection, MinFilm, Stress, check_limits
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.crossings import CONTACT_FRACTION
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.derivative_sources import DerivativeRequest, sources_of
from petalfoil.analysis.friction_told import refuse_path
from petalfoil.analysis.liftoff import own_load
from petalfoil.analysis.load_ray import Limits
from petalfoil.analysis.operating_point import Vector, applied_load, at
from petalfoil.analysis.records import asked_position, effort, record_of
from petalfoil.analysis.runs import Points
from petalfoil.analysis.sensitivity_table import (
    ALL,
    LAYOUT,
    MATRICES,
    RESULTS,
    SensitivityLine,
    lines_of,
    ordered,
    rounding_of,
)
from petalfoil.analysis.solve import placed
from petalfoil.analysis.words import Choice, Names, known
from petalfoil.case import Case
from petalfoil.case.parameters import parameter_of, parameters_of
from petalfoil.equilibrium.run_context import Progress, RunContext, running
from petalfoil.errors import UsageError
from petalfoil.results.parts import AppliedLoad
from petalfoil.results.record import Record
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role
from petalfoil.walls import Capability, required

MAIN_RESULT = {
    "solve": "bearing_force",
    "balance": "min_film_thickness",
    "liftoff": "liftoff_speed",
    "capacity": "load_capacity",
    "static": "starting_torque",
    "coefficients": "stiffness_yy",
    "stability": "critical_mass",
}
"""Questions that have derivatives, and the result that is asked for unless another is."""

WITHOUT_EFFECT = ("model.", "surface.friction_width", "surface.petal_friction", "petals.free_shape_tolerance")
"""Numbers of the discretisation, and friction that acts in motions alone: derivatives by them are not looked for."""

ANSWERS = [
    name
    for name, variable in SCALARS.items()
    if not variable.dims and variable.kind is DataType.FLOAT and variable.role is Role.ANSWER
] + ["eccentricity_x", "eccentricity_y", "load_capacity", *MATRICES]
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
        words=tuple(MAIN_RESULT),
        help="Whose results: solve, balance, liftoff, capacity, static, coefficients or stability; by default balance "
        "where there is a load, else solve.",
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
RelativeStep = Annotated[
    float,
    NumberWithUnit(
        unit="1",
        metavar="FRACTION",
        help="Relative change of each parameter, whose effect is printed.",
        above=0.0,
        at_most=1.0,
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
        help="One solve for each parameter, which tells how far contacts hold too; adjoint: one for each result that "
        "has one.",
    ),
]

ContactPlaces = Annotated[
    str,
    Choice(
        metavar="PLACE",
        words=("points", "nodes"),
        help="Contacts as points that travel between nodes; at nodes: exact for tiny changes on this grid.",
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
    contact_fraction: AnyLimit = None,
    min_film_thickness: MinFilm = None,
    max_stress: Stress = None,
    direction: LoadDirection = DOWN,
    frequency: WhirlFrequency = None,
    mass: Mass = None,
    contacts: ContactPlaces = "points",
    method: SolveMethod = "tangent",
    step: RelativeStep = 0.01,
    progress: Progress | None = None,
) -> Points:
    """Tell how far a small change of each parameter moves a result.

    From exact derivatives of the equilibrium, through geometry, grid and
    contacts: a table of parameters by their effect. "Contacts hold" is the
    change up to which no contact begins or ends. With --samples the command
    finds Sobol' indices instead: petalfoil sensitivity --samples 256 --help.

    Example: petalfoil sensitivity case.toml --ask liftoff --load "20 N" --plot tornado.png

    Raises
    ------
    UsageError
        A parameter is none of the case, a whole number or left to a rule; a result is none of the question; a load
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
    verb = ask or ("balance" if load is not None or (case.operation.load and eccentricity is None) else "solve")
    refuse_path(case, "derivatives are those")
    there = posed(at(case.replace(**{"model.contacts": contacts}), speed), verb, load, eccentricity)
    paths = default_paths(there, verb) if vary is None else [checked(there, path) for path in vary]
    quantities = [known(name, [ALL, *ANSWERS], "result") for name in of or [MAIN_RESULT[verb]]]
    limits = Limits(min_film_thickness=min_film_thickness, contact_fraction=contact_fraction, max_stress=max_stress)
    fraction = CONTACT_FRACTION if contact_fraction is None else contact_fraction
    asked = DerivativeRequest(
        verb, paths, quantities, step, vary is None, contacts == "points", fraction, limits, direction,
        frequency, mass, method == ADJOINT,
    )  # fmt: skip
    refuse_limits(there, asked)
    most = len(ANSWERS) if ALL in quantities else len(quantities)
    return Points(_points(there, asked, progress), len(paths) * most, "effects")


def posed(case: Case, verb: str, load: Vector | None, eccentricity: Vector | None) -> Case:
    """The case with the load or the position that the question `verb` is about.

    Raises
    ------
    UsageError
        It has neither, or both.
    """
    if verb == "static":
        required(case, Capability.PACK, "`static`")
        if case.surface.petal_friction > 0.0:
            raise UsageError(
                "petals with friction remember how they came to rest, and no derivative tells that: set "
                "surface.petal_friction to 0, or compare two runs of `static`"
            )
        return placed(at(case, 0.0), eccentricity or (0.0, 0.0))
    if verb == "capacity":
        if load is not None or eccentricity is not None:
            raise UsageError("capacity finds the load: give --min-film, --contact-fraction or --max-stress alone")
        return case.replace(**{"operation.load": None, "operation.eccentricity": (0.0, 0.0)})
    if verb in ("coefficients", "stability"):
        return posed_to_whirl(case, load, eccentricity)
    if verb == "solve":
        if load is not None:
            raise UsageError("solve holds the journal at a position: give an eccentricity, or ask balance")
        return placed(case, eccentricity)
    if eccentricity is not None:
        raise UsageError(f"{verb} finds the position under a load: give a load, or ask solve")
    wanted = applied_load(case, load)
    loaded = case.replace(**{"operation.load": wanted, "operation.eccentricity": (0.0, 0.0)})
    if verb == "liftoff":
        required(case, Capability.LIFT_OFF, "lift-off")
        own_load(loaded)
    return loaded


def posed_to_whirl(case: Case, load: Vector | None, eccentricity: Vector | None) -> Case:
    """The case with the load or the position about which the journal whirls.

    Raises
    ------
    UsageError
        The shaft does not turn, or the journal is free to tilt.
    """
    if not case.operation.speed > 0.0:
        raise UsageError("small motions need a turning shaft: give a speed above zero")
    if case.operation.moment is not None:
        raise UsageError(
            "stiffness, damping and critical mass have no derivatives under a moment: leave operation.moment out, or "
            "compare two runs"
        )
    if eccentricity is not None or (load is None and case.operation.load is None):
        return placed(case, eccentricity)
    return case.replace(**{"operation.load": applied_load(case, load), "operation.eccentricity": (0.0, 0.0)})


def refuse_limits(case: Case, asked: DerivativeRequest) -> None:
    """Refuse a capacity without a limit, and limits of what has none.

    Raises
    ------
    UsageError
        A limit is missing, says nothing of this bearing, or is given for another question.
    """
    if asked.verb == "capacity":
        check_limits(case, asked.limits)
    elif asked.limits.min_film_thickness is not None or asked.limits.max_stress is not None:
        raise UsageError(f"--min-film and --max-stress are limits of a load capacity: {asked.verb} has none")
    if asked.frequency is not None and asked.verb != "coefficients":
        raise UsageError(f"--frequency is that of stiffness and damping: {asked.verb} has none")
    if asked.mass is not None and asked.verb != "stability":
        raise UsageError(f"--mass is that of the rotor whose threshold speed is asked for: {asked.verb} has none")


def default_paths(case: Case, verb: str) -> list[str]:
    """Parameters that the results of a question may depend on."""
    given = ["operation.load" if case.operation.load is None else "operation.eccentricity"]
    given += {"capacity": ["operation.eccentricity"]}.get(verb, [])
    without = (*WITHOUT_EFFECT, *given, *(["operation.speed"] if verb in ("liftoff", "static") else []))
    known_ones = parameters_of(case).values()
    return [p.path for p in known_ones if not p.is_count and p.value is not None and not p.path.startswith(without)]


def checked(case: Case, path: str) -> str:
    """A path of a parameter that has a derivative.

    Raises
    ------
    UsageError, DefinitionError
        It has none.
    """
    parameter = parameter_of(case, path)
    if parameter.is_count:
        raise UsageError(f"{path} is a whole number: it has no derivative; `sweep` varies it")
    if parameter.value is None:
        raise UsageError(f"{path} is left to a rule in this case: give it a value there")
    return path


def _points(case: Case, asked: DerivativeRequest, progress: Progress | None) -> Iterator[Record]:
    """One record for each parameter and result, by the size of the effect."""
    with running(progress, "sensitivity") as run:
        there = {name: source for source in sources_of(case, asked) for name in source.values if name in SCALARS}
        quantities = named(asked, list(there))
        sources = {name: there[name] for name in quantities}
        lines, before = [], solves_of(run)
        for number, path in enumerate(asked.paths, 1):
            lines += lines_of(path, sources, asked.step)
            if progress is not None:
                progress(number / len(asked.paths), f"sensitivity: {path}")
        felt = [line for line in lines if not asked.all_of_them or is_felt(case, line)] or lines
        cost = effort(run.seconds), Solves(solves_of(run) - before)
        records = [
            record_of("sensitivity", case, line.row, *state_of(case, asked.verb), *cost, line.outcome)
            for line in ordered(felt, quantities)
        ]
    silent = {line.row.parameter: True for line in lines if line.row.parameter not in {f.row.parameter for f in felt}}
    if records and silent:
        records[-1] = replace(records[-1], remarks=(f"without effect: {', '.join(silent)}",))
    yield from records


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


def state_of(case: Case, verb: str) -> tuple[object, ...]:
    """What is given of the equilibrium: its load or its position, and its speed unless that is the result."""
    if verb == "capacity":
        return ({"speed": case.operation.speed},)
    if case.operation.load is None:
        return (asked_position(case),)
    speed = {} if verb == "liftoff" else {"speed": case.operation.speed}
    return speed, AppliedLoad.of(case.operation.load, case.operation.moment)
