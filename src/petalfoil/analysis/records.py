"""Records from typed parts: of a solution, of a point without one, and the parts they share."""

from __future__ import annotations

import math

import numpy as np

from petalfoil.analysis.contact_model import ContactModel
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.fields import all_fields, coordinates
from petalfoil.analysis.friction_told import FrictionTold
from petalfoil.analysis.heat_results import heat_results
from petalfoil.case import Case, warnings_of
from petalfoil.equilibrium.run_context import HistoryRow, RunContext, current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.results.parts import Branch, Effort, Geometry, Position, RunOutcome, scalars_of
from petalfoil.results.record import Array, Record
from petalfoil.system.build import lever_of
from petalfoil.system.temperatures import Temperatures
from petalfoil.walls import wall_kind


def solution_record(analysis: str, found: Evaluation, *parts: object) -> Record:
    """The record of an equilibrium: its film, forces, balances and fields, and what its analysis adds."""
    case, answer = found.case, found.answer
    fields = all_fields(found)
    hot = heat_results(case, answer)
    wall = wall_kind(case).scalars(fields), ContactModel.of(answer), FrictionTold.of(case, answer)
    film = (found.forces(), found.film(), found.balances(), *wall, *([hot] if hot else []))
    return record_of(
        analysis,
        case,
        *geometry(case),
        *film,
        *parts,
        RunOutcome(),
        fields=dict(fields),
        coords=coordinates(found),
    )


def failed_record(analysis: str, case: Case, reason: object, *parts: object) -> Record:
    """The record of a point without a solution: what was asked, what it cost, and why there is none."""
    ended = RunOutcome(converged=False, status=f"not converged: {reason}", residual=math.nan)
    return record_of(analysis, case, *geometry(case), asked_position(case), *parts, effort(), ended)


def record_of(
    analysis: str,
    case: Case,
    *parts: object,
    fields: dict[str, Array] | None = None,
    coords: dict[str, Array] | None = None,
    history: list[HistoryRow] | None = None,
) -> Record:
    """A record from its parts, with what is implausible about them.

    The history is that of the current run unless another is given.
    """
    scalars = scalars_of(*parts)
    return Record(
        analysis=analysis,
        scalars=scalars,
        fields=fields or {},
        coords=coords or {},
        case_toml=case.to_toml(),
        title=case.title,
        history=list(current_run().history if history is None else history),
        warnings=tuple(warnings_of(case, scalars)),
    )


def geometry(case: Case) -> tuple[object, ...]:
    """Sizes of the bearing and of its wall."""
    bearing = Geometry(
        journal_radius=case.bearing.journal_radius,
        bushing_radius=case.bearing.bushing_radius,
        length=case.bearing.length,
        ambient_pressure=case.gas.ambient_pressure,
        contact_film_thickness=case.surface.contact_film_thickness,
    )
    return bearing, wall_kind(case).geometry(case)


def asked_position(case: Case) -> Position:
    """Speed and displacement that the case asks for."""
    return position_at(case, np.array(case.operation.eccentricity), case.operation.tilt)


def position(case: Case, answer: Solution) -> Position:
    """Speed of the case and displacement of a solution."""
    e, tilt = answer.position * answer.problem.layout.scales.length, case.operation.tilt
    if case.operation.moment is not None:
        a_x, a_y = e[2:] / lever_of(case)
        tilt = (float(a_x), float(a_y))
    return position_at(case, e, tilt, answer.problem.temperatures)


def position_at(case: Case, e: Array, tilt: tuple[float, float] | None, warm: Temperatures | None = None) -> Position:
    """The displacement `e` [m] and the `tilt` [rad] at the speed of the case, and the growth there."""
    speed, (tilt_x, tilt_y) = case.operation.speed, tilt or (None, None)
    growth = case.growth if warm is None else case.growth_at(warm.shaft, warm.bushing)
    return Position(
        speed=speed,
        eccentricity_x=float(e[0]),
        eccentricity_y=float(e[1]),
        shaft_growth=None if case.shaft is None else growth.journal(speed),
        bushing_growth=None if case.bushing is None else growth.bushing,
        tilt_x=tilt_x,
        tilt_y=tilt_y,
    )


def effort(wall_time: float | None = None, run: RunContext | None = None) -> Effort:
    """What a run cost, by default the current one."""
    run = run or current_run()
    return Effort(
        iterations=sum("residual" in row or row["phase"] in ("contacts", "classic") for row in run.history),
        factorizations=run.film.factorizations,
        pack_iterations=run.pack.factorizations,
        probe_factorizations=run.probes.factorizations,
        coarse_factorizations=run.coarse.factorizations,
        wall_time=wall_time,
    )


def branch(rate: complex, case: Case, known: int | None, path: str, jump: bool | None = None) -> Branch:
    """Branch and stability, from the leading eigenvalue; a shaft at rest has no film that could grow.

    As long as others were not looked for and none is met, the number `known` is None.
    """
    omega = case.operation.speed
    return Branch(
        stable=not rate.real > 0.0,
        growth_rate=rate.real * omega if not math.isnan(rate.real) else math.nan,
        growth_frequency=abs(rate.imag) * omega if not math.isnan(rate.imag) else math.nan,
        known_equilibria=known,
        solution_path=path,
        jump=jump,
    )
