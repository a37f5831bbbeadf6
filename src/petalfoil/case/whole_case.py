"""Why a case cannot be solved that no single key shows: its geometry, grid, method, heat, tilt, second bearing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

from petalfoil.case.growth import REFERENCE_TEMPERATURE, growth_problems
from petalfoil.case.heat_table import heat_problems
from petalfoil.case.pack_geometry import bearing_problems, pack_problems
from petalfoil.case.petal_table import PetalTheory
from petalfoil.case.problems import Problem, refusal
from petalfoil.case.sections import ADAPTED, FrictionHistory, Method, ModelKind
from petalfoil.errors import DefinitionError, PackError
from petalfoil.units import format_quantity

if TYPE_CHECKING:
    from petalfoil.case.definitions import Case


def refuse_unsolvable(case: Case) -> None:
    """Refuse geometry that cannot be assembled and, where it can, what else does not go together.

    Raises
    ------
    PackError
        The geometry does not fit.
    DefinitionError
        Something else does not.
    """
    problems = list(_geometry_problems(case))
    if problems:
        raise refusal(PackError, problems)
    problems = [
        *_grid_problems(case),
        *_tilt_problems(case),
        *_heat_problems(case),
        *_method_problems(case),
        *_second_problems(case),
        *_history_problems(case),
        *_rubbing_problems(case),
    ]
    if problems:
        raise refusal(DefinitionError, problems)


def _geometry_problems(case: Case) -> Iterator[Problem]:
    if len(case.walls) > 1:
        names = " and ".join(f"[{wall.section}]" for wall in case.walls)
        yield Problem("", f"{names} both describe the wall; allowed: one of them", names, "one of them")
    found = [problem for wall in case.walls for problem in wall.problems()]
    found += _backing_problems(case)
    found += growth_problems(case.bearing, case.shaft)
    if not found:
        found = list(bearing_problems(case.bearing, case.surface, case.operation, case.travel))
    if not found and case.petals is not None:
        found = list(pack_problems(case.bearing, case.petals, case.surface, case.operation))
    yield from found or _problems_as_grown(case)


def _backing_problems(case: Case) -> list[Problem]:
    """Why springs cannot stand behind petals: there are none, or the stiffness is not known."""
    if case.backing is None:
        return []
    if case.petals is None:
        text = "backing springs stand behind petals, and there are none; allowed: with [petals], or [bump_foil]"
        return [Problem("backing", text, None, "with [petals]")]
    return list(case.backing.problems_under(case.petals.pitch * case.bearing.bushing_radius))


def _problems_as_grown(case: Case) -> Iterator[Problem]:
    """Yield what fits at rest at 20 °C, but not as shaft and bushing have grown."""
    closing, grown = case.growth.closing(case.operation.speed), case.grown_bearing
    if closing == 0.0:
        return
    found = list(bearing_problems(grown, case.surface, case.operation, case.travel))
    if not found and case.petals is not None:
        found = list(pack_problems(grown, case.petals, case.surface, case.operation))
    for problem in found:
        text = (
            f"shaft and bushing as grown at {format_quantity(case.operation.speed, 'rad/s')} take "
            f"{format_quantity(closing, 'm')} of the radial clearance (see `shaft` and `bushing`): "
            f"{problem.text}"
        )
        yield replace(problem, text=text)


def _grid_problems(case: Case) -> Iterator[Problem]:
    cells, density = case.axial_cells, case.model.axial_density
    if density is not None and case.model.axial_grading is not None:
        text = "is given beside model.axial_grading, and both place the stations; allowed: one of them"
        yield Problem("model.axial_density", text, density, "one of both")
    if density == ADAPTED and case.petals is None:
        text = 'stations are adapted to petals only; allowed: "uniform", a list, or model.axial_grading'
        yield Problem("model.axial_density", text, density, "uniform, a list, or model.axial_grading")
    if case.model.kind is ModelKind.THREE_D and case.symmetric and cells % 2:
        text = f"{cells} cells cannot be halved at the plane of symmetry; allowed: an even number, or symmetry = false"
        yield Problem("model.axial_cells", text, cells, "an even number")


def _heat_problems(case: Case) -> Iterator[Problem]:
    if case.heat is None:
        return
    case.heat.of_gas(case.gas)  # refuses a gas whose heat conductivity is not known
    warm = {"shaft.temperature": case.shaft, "bushing.temperature": case.bushing}
    given = {key: part is not None and part.temperature != REFERENCE_TEMPERATURE for key, part in warm.items()}
    others = {"model.slip": case.model.slip, "classic": case.model.method is Method.CLASSIC}
    yield from heat_problems(case.heat, given | others)


def _history_problems(case: Case) -> Iterator[Problem]:
    """Yield why the path of a pack with friction cannot be followed."""
    if case.surface.friction_history is not FrictionHistory.ASSEMBLED or case.follows_friction:
        return
    if not case.surface.petal_friction > 0.0:
        lacks = "surface.petal_friction above 0"
    elif case.petal_theory is not PetalTheory.SHELL:
        lacks = 'petals that slide along themselves (petals.theory = "shell")'
    else:
        lacks = "one temperature (no [heat]), and bearings that share the load of a rotor evenly"
    text = f'a pack that keeps the friction of its assembly needs {lacks}; allowed here: "relaxed"'
    yield Problem("surface.friction_history", text, "assembled", '"relaxed"')


def _rubbing_problems(case: Case) -> Iterator[Problem]:
    """Yield why the rubbing of the journal cannot pull at what it touches."""
    if not case.rubbing_pulls:
        return
    bends_only = case.petal_theory is PetalTheory.INEXTENSIBLE and case.model.kind is ModelKind.THREE_D
    if case.model.method is Method.CLASSIC:
        lacks = 'model.method = "newton"'
    elif case.backing is not None:
        lacks = "petals on a rigid bushing (no [backing])"
    elif case.petals is not None and bends_only:
        lacks = 'petals that stretch in 3-D (petals.theory = "shell")'
    else:
        return
    text = f'a journal whose rubbing pulls at what it touches needs {lacks}; allowed here: "torque"'
    yield Problem("surface.journal_rubbing", text, "force", '"torque"')


def _method_problems(case: Case) -> Iterator[Problem]:
    if case.petal_theory is PetalTheory.SHELL and case.model.kind is ModelKind.THREE_D:
        yield from _stretching_problems(case)
    if case.petal_theory is PetalTheory.SHELL and case.backing is not None:
        text = 'petals that stretch are modelled on a rigid bushing alone; allowed: "inextensible", or no [backing]'
        yield Problem("petals.theory", text, "shell", "inextensible, or no [backing]")
    if case.model.method is Method.CLASSIC and case.petals is not None and len(set(case.petals.each)) > 1:
        text = 'the paper\'s method is for equal petals; allowed: "newton", or one value for all petals'
        yield Problem("model.method", text, "classic", "newton, or equal petals")
    if case.model.method is Method.CLASSIC and case.backing is not None:
        text = 'the paper has no backing springs; allowed: "newton", or no [backing]'
        yield Problem("model.method", text, "classic", "newton, or no [backing]")


def _stretching_problems(case: Case) -> Iterator[Problem]:
    if case.model.method is Method.CLASSIC:
        text = 'the paper\'s petals do not stretch; allowed: "inextensible", or model.method = "newton"'
        yield Problem("petals.theory", text, "shell", "inextensible, or newton")


def _second_problems(case: Case) -> Iterator[Problem]:
    """Yield what is wrong with the second bearing of the rotor as a bearing by itself."""
    if case.rotor is None or case.rotor.second is None:
        return
    try:
        second = case.supports[1]
    except DefinitionError as error:
        for key, text in error.problems:
            yield Problem(f"rotor.second.{key}" if key else "rotor.second", text, error.given, error.allowed)
        return
    if second.model.kind is not case.model.kind:
        text = f'is "{second.model.kind}" beside "{case.model.kind}"; allowed: one kind for both bearings'
        yield Problem("rotor.second.model.kind", text, str(second.model.kind), f'"{case.model.kind}"')
    if case.model.method is Method.CLASSIC:
        yield Problem("rotor.second", 'is not in the paper; allowed: model.method = "newton"', None, '"newton"')


def _tilt_problems(case: Case) -> Iterator[Problem]:
    """Yield why a journal cannot tilt: no length, the paper's method, or two ways to say it."""
    operation = case.operation
    key = "operation.tilt" if operation.tilt is not None else "operation.moment"
    if operation.tilt is None and operation.moment is None:
        return
    given = operation.tilt or operation.moment
    if case.model.kind is ModelKind.TWO_D and (operation.tilt is not None or case.bearings == 1):
        yield Problem(key, 'needs the length of the bearing; allowed: model.kind = "3d"', given, '"3d"')
    if case.model.method is Method.CLASSIC:
        yield Problem(key, 'is not in the paper; allowed: model.method = "newton"', given, '"newton"')
    if operation.tilt is not None and operation.moment is not None and case.bearings == 1:
        text = "is given beside operation.tilt, and one follows from the other; allowed: one of them"
        yield Problem("operation.moment", text, operation.moment, "a tilt or a moment")
