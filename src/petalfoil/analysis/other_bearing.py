"""What results tell of a rotor whose bearings do not share its load evenly: one bearing whole, the other in short."""

from __future__ import annotations

from dataclasses import dataclass, replace

from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.rotor_balance import RotorInBearings
from petalfoil.case import Case, warnings_of
from petalfoil.equilibrium.solution import Solution
from petalfoil.results.record import Record
from petalfoil.system.temperatures import Temperatures


@dataclass(frozen=True, kw_only=True)
class OtherBearing:
    """The bearing that results do not describe, and the slopes of the shaft."""

    shaft_slope_x: float
    shaft_slope_y: float
    other_eccentricity_x: float
    other_eccentricity_y: float
    other_force_x: float
    other_force_y: float
    other_contact_fraction: float
    other_min_film_thickness: float
    other_peak_pressure: float
    other_power_loss: float
    other_shaft_temperature: float | None = None
    other_pack_temperature: float | None = None


def bearing_of(case: Case, found: Solution) -> Case:
    """The bearing that a state is of, by itself: `case`, or one of the bearings of its rotor at its slopes."""
    return case if found.other is None else RotorInBearings.of(case, (0.0, 0.0)).told(found)


def rotor_parts(case: Case, found: Solution) -> tuple[object, ...]:
    """What is told of the other bearing and of the shaft; nothing where one bearing tells the state of all."""
    if found.other is None:
        return ()
    rotor = RotorInBearings.of(case, (0.0, 0.0))
    there, e = Evaluation.of(rotor.untold(found.other), found.other), found.other.operating_state.displacement
    (_, _, slope_x, slope_y), forces, film = rotor.position(found), there.forces(), there.film()
    warm = found.other.problem.temperatures
    return (
        OtherBearing(
            shaft_slope_x=float(slope_x),
            shaft_slope_y=float(slope_y),
            other_eccentricity_x=float(e[0]),
            other_eccentricity_y=float(e[1]),
            other_force_x=forces.force_x,
            other_force_y=forces.force_y,
            other_contact_fraction=forces.contact_fraction,
            other_min_film_thickness=film.min_film_thickness,
            other_peak_pressure=film.peak_pressure,
            other_power_loss=film.power_loss,
            other_shaft_temperature=None if warm is None else warm.shaft,
            other_pack_temperature=None if warm is None else warm.pack,
        ),
    )


def of_rotor(record: Record, case: Case) -> Record:
    """A record of one bearing as that of the `case` of its rotor."""
    told = tuple(dict.fromkeys((*warnings_of(case, {}), *record.warnings)))
    return replace(record, case_toml=case.to_toml(), title=case.title, warnings=told)


def worst_contact(case: Case, found: Solution) -> float:
    """Contact fraction of the bearing whose solid contact carries more of its load [1]."""
    fraction = Evaluation.of(bearing_of(case, found), found).contact_fraction
    if found.other is None:
        return fraction
    other = RotorInBearings.of(case, (0.0, 0.0)).untold(found.other)
    return max(fraction, Evaluation.of(other, found.other).contact_fraction)


def temperatures_of(found: Solution) -> list[Temperatures | None]:
    """Temperatures of both bearings, or of the one, in the order of `found`."""
    return [one.problem.temperatures for one in (found, found.other) if one is not None]
