"""`check`: what follows from a case without a run: geometry, stiffness, clearance, and the assembled cross-section."""

from __future__ import annotations

import math
from dataclasses import dataclass

from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.fields import coordinates, state_of_wall
from petalfoil.analysis.records import asked_position, geometry, record_of
from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.continuation import rest
from petalfoil.equilibrium.run_context import running
from petalfoil.errors import ConvergenceError
from petalfoil.results.layout import SinglePoint
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.scales import Scales
from petalfoil.walls import Capability, wall_kind


@dataclass(frozen=True, kw_only=True)
class BearingNumbers:
    """Clearances, the bearing number on the clearance, and what decides whether slip matters."""

    radial_clearance: float
    pack_clearance: float | None
    """None for a foil that has no solid height."""
    compressibility_number: float
    viscosity: float
    mean_free_path: float
    contact_knudsen_number: float | None
    """None for a wall that does not rest on the journal."""
    clearance_knudsen_number: float | None
    """None for one that does."""


@analysis(SinglePoint())
def check(case: Case) -> Record:
    """Validate a case, print its derived geometry and draw its cross-section.

    Only the foil pack at zero speed is solved, for the cross-section.

    Example: petalfoil check case.toml --plot section.svg

    Raises
    ------
    ConvergenceError
        No equilibrium of the foil pack was found.
    """
    kind = wall_kind(case)
    derived = (*geometry(case), asked_position(case), bearing_numbers(case), kind.check_scalars(case))
    if not kind.can(Capability.PACK):
        return record_of("check", case, *derived, history=[])
    slow = case.replace(
        **{"model.kind": ModelKind.TWO_D, "operation.speed": 0.0, "operation.tilt": None, "operation.moment": None}
    )
    with running() as run:
        answer = rest(build_problem(slow))
    if answer is None:
        raise ConvergenceError(
            "no equilibrium of the foil pack at zero speed was found",
            history=run.history,
            advice="lower the preload (a larger petals.bend_radius, thinner petals) or change model.cells_per_pitch",
        )
    found = Evaluation.of(slow, answer)
    section = kind.cross_section(slow, state_of_wall(found.state).deflection)
    return record_of("check", case, *derived, fields=dict(section), coords=coordinates(found), history=[])


def bearing_numbers(case: Case) -> BearingNumbers:
    """Numbers of any bearing.

    The film is as thin as the radial clearance of a plain bearing, and in a pack at the least as the contact film.
    """
    scales = Scales(case.bearing.clearance, case.gas.ambient_pressure, 1.0)
    number = scales.bearing_number(case.gas.viscosity, case.operation.speed, case.bearing.journal_radius)
    on_journal = wall_kind(case).can(Capability.PACK)
    path = case.gas.mean_free_path
    return BearingNumbers(
        radial_clearance=case.radial_clearance,
        pack_clearance=case.pack_clearance if math.isfinite(case.pack_clearance) else None,
        compressibility_number=number,
        viscosity=case.gas.viscosity,
        mean_free_path=path,
        contact_knudsen_number=path / case.surface.contact_film_thickness if on_journal else None,
        clearance_knudsen_number=None if on_journal else path / case.radial_clearance,
    )
