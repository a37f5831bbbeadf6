"""What follows from a case without a run: geometry, stiffness, room, and the assembled cross-section."""

from __future__ import annotations

from petalfoil.analysis.fields import coordinates, wall_state
from petalfoil.analysis.figures import given
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.ascent import rest
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.scales import Scales
from petalfoil.walls import Capability, wall_kind

Named = dict[str, float | int | bool | str]


def run(case: Case) -> Record:
    """Derive the figures of `case` and assemble its package at rest.

    Raises
    ------
    ConvergenceError
        The package did not settle.
    """
    kind = wall_kind(case)
    scalars: Named = {**given(case), **bearing_figures(case), **kind.check_scalars(case)}
    if not kind.can(Capability.PACK):
        return Record(analysis="check", scalars=scalars, case_toml=case.to_toml(), title=case.title)
    flat = case.replace(**{"model.kind": ModelKind.TWO_D, "operation.speed": 0.0})
    with one_thread():
        work = RunLog()
        answer = rest(build_problem(flat), work)
    if answer is None:
        raise ConvergenceError("the package did not settle at rest", history=work.history, advice="check its geometry")
    return Record(
        analysis="check",
        scalars=scalars,
        fields=dict(kind.cross_section(flat, wall_state(answer).deflection)),
        coords=coordinates(flat, answer),
        case_toml=case.to_toml(),
        title=case.title,
    )


def bearing_figures(case: Case) -> Named:
    """Room, bearing number on the clearance, and what decides whether slip matters.

    Without a run the smallest film is the room of a plain bearing, and at the least the film floor of a package.
    """
    scales = Scales(case.bearing.clearance, case.gas.ambient_pressure, 1.0)
    number = scales.bearing_number(case.gas.viscosity, case.operation.speed, case.bearing.journal_radius)
    on_journal = wall_kind(case).can(Capability.PACK)
    thinnest = case.surface.contact_film_thickness if on_journal else case.room
    return {
        "radial_clearance": case.room,
        "pack_clearance": case.pack_clearance,
        "compressibility_number": number,
        "viscosity": case.gas.viscosity,
        "mean_free_path": case.gas.mean_free_path,
        "knudsen_number": case.gas.mean_free_path / thinnest,
    }
