"""Questions whose results have derivatives by the parameters of a case, and what each of them needs."""

from __future__ import annotations

from petalfoil.analysis.capacity import check_limits
from petalfoil.analysis.derivative_sources import DerivativeRequest
from petalfoil.analysis.friction_told import follows_path, rubs
from petalfoil.analysis.liftoff import own_load
from petalfoil.analysis.operating_point import Vector, applied_load, at
from petalfoil.analysis.records import asked_position
from petalfoil.analysis.solve import placed
from petalfoil.case import Case
from petalfoil.case.parameters import parameter_of, parameters_of
from petalfoil.errors import UsageError
from petalfoil.results.parts import AppliedLoad
from petalfoil.walls import Capability, required

MAIN_RESULT = {
    "solve": "bearing_force",
    "balance": "min_film_thickness",
    "liftoff": "liftoff_speed",
    "capacity": "load_capacity",
    "curve": "bearing_force",
    "runup": "min_film_thickness",
    "static": "starting_torque",
    "coefficients": "stiffness_yy",
    "stability": "critical_mass",
}
"""Questions that have derivatives, and the result that is asked for unless another is."""

WITHOUT_DERIVATIVES = {
    "orbit": "its results are extremes of a motion of thousands of steps, whose length follows the motion: compare two "
    "runs, or ask `stability` for natural modes and the threshold speed",
    "check": "it solves nothing: compare two runs, which cost nothing",
    "converge": "it is about the grid: ask the question that it refines",
}
"""Questions without derivatives, and why."""

OF_TWO_BEARINGS = tuple(f"rotor.{key}" for key in ("centre", "load_place", "transverse", "polar", "skew", "second"))
"""Parameters of a rotor in two bearings: refused in a case whose rotor has no span."""
WITHOUT_EFFECT = ("model.", "surface.friction_width", "surface.petal_friction", "petals.free_shape_tolerance")
"""Numbers of the discretisation, and friction that acts in motions alone: derivatives by them are not looked for."""


def asked_verb(case: Case, ask: str | None, load: Vector | None, eccentricity: Vector | None) -> str:
    """The question whose derivatives are asked for; by default `balance` where there is a load, else `solve`.

    Raises
    ------
    UsageError
        It has none.
    """
    if ask in WITHOUT_DERIVATIVES:
        raise UsageError(f"{ask} has no derivatives: {WITHOUT_DERIVATIVES[ask]}")
    return ask or ("balance" if load is not None or (case.operation.load and eccentricity is None) else "solve")


def posed(case: Case, verb: str, load: Vector | None, eccentricity: Vector | None) -> Case:
    """The case with the load or the position that the question `verb` is about.

    Raises
    ------
    UsageError
        It has neither, or both.
    """
    if verb == "static":
        return posed_at_rest(case, eccentricity)
    if verb == "capacity":
        if load is not None or eccentricity is not None:
            raise UsageError("capacity finds the load: give --min-film, --contact-fraction or --max-stress alone")
        return case.replace(**{"operation.load": None, "operation.eccentricity": (0.0, 0.0)})
    if verb in ("coefficients", "stability"):
        return posed_to_whirl(case, load, eccentricity)
    if verb in ("solve", "curve"):
        if load is not None:
            raise UsageError(f"{verb} holds the journal at a position: give an eccentricity, or ask balance")
        return placed(case, eccentricity)
    if eccentricity is not None:
        raise UsageError(f"{verb} finds the position under a load: give a load, or ask solve")
    wanted = applied_load(case, load)
    loaded = case.replace(**{"operation.load": wanted, "operation.eccentricity": (0.0, 0.0)})
    if verb == "runup":
        check_runup(loaded)
    if verb == "liftoff":
        required(case, Capability.LIFT_OFF, "lift-off")
        own_load(loaded)
    return loaded


def posed_at_rest(case: Case, eccentricity: Vector | None) -> Case:
    """The case of a pack at zero speed.

    Raises
    ------
    UsageError
        There is none, or its petals rub on each other.
    """
    required(case, Capability.PACK, "`static`")
    if case.surface.petal_friction > 0.0:
        raise UsageError(
            "the state of petals with friction depends on their path, and a derivative has no path: set "
            "surface.petal_friction to 0, or compare two runs of `static`"
        )
    return placed(at(case, 0.0), eccentricity or (0.0, 0.0))


def check_runup(case: Case) -> None:
    """Refuse a run-up whose petals keep friction forces.

    Raises
    ------
    UsageError
        They do, or the wall does not rest on the journal at zero speed.
    """
    required(case, Capability.LIFT_OFF, "a run-up")
    if rubs(case) and follows_path(case, by_default=True):
        raise UsageError(
            "a run-up keeps the friction forces that petals gather on the way, and no derivative tells these: set "
            'surface.friction_history to "relaxed", or compare two runs of `runup`'
        )


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
    for verb, option in (("curve", "--displacements"), ("runup", "--speeds")):
        given = asked.series.get(verb) is not None
        if asked.verb == verb and not given:
            raise UsageError(f"{verb} is asked for at several points: give {option}")
        if asked.verb != verb and given:
            raise UsageError(f"{option} are the points of `{verb}`: {asked.verb} has none")
    if asked.mass is not None and asked.verb != "stability":
        raise UsageError(f"--mass is that of the rotor whose threshold speed is asked for: {asked.verb} has none")


def default_paths(case: Case, verb: str) -> list[str]:
    """Parameters that the results of a question may depend on."""
    given = ["operation.load" if case.operation.load is None else "operation.eccentricity"]
    given += {"capacity": ["operation.eccentricity"]}.get(verb, [])
    without = (*WITHOUT_EFFECT, *given, *(["operation.speed"] if verb in ("liftoff", "static") else []))
    if case.rotor is not None and case.rotor.span is None:
        without += OF_TWO_BEARINGS
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
        raise UsageError(f"{path} follows from other keys in this case; give it a value there")
    return path


def state_of(case: Case, verb: str) -> tuple[object, ...]:
    """What is given of the equilibrium: its load or its position, and its speed unless that is the result."""
    if verb == "capacity":
        return ({"speed": case.operation.speed},)
    if case.operation.load is None:
        return (asked_position(case),)
    speed = {} if verb == "liftoff" else {"speed": case.operation.speed}
    return speed, AppliedLoad.of(case.operation.load, case.operation.moment)
