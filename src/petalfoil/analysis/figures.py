"""Figures of an answer: forces, film, friction, leakage, how far it can be trusted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.checks import mass_balance, reaction_balance, side_leakage
from petalfoil.analysis.extremes import highest, lowest
from petalfoil.analysis.fields import all_fields, coordinates
from petalfoil.case import Case
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.forces import attitude_angle, contact_force, film_force, node_area, viscous_torque
from petalfoil.results.record import Record
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]
Named = dict[str, float | int | bool | str]


def record_of(analysis: str, case: Case, answer: Solution, extra: Named, work: RunLog) -> Record:
    """The record of an answer: figures, fields, coordinates, history."""
    fields = all_fields(case, answer)
    scalars = {**given(case), **forces(case, answer), **film_figures(case, answer, fields), **trust(answer), **extra}
    scalars.update(wall_kind(case).scalars(fields))
    return Record(
        analysis=analysis,
        scalars=scalars,
        fields=dict(fields),
        coords=coordinates(case, answer),
        case_toml=case.to_toml(),
        title=case.title,
        history=list(work.history),
    )


def failed_record(analysis: str, case: Case, status: str, work: RunLog, extra: Named | None = None) -> Record:
    """The record of a point without an answer; `extra` is what else was given."""
    asked = {**given(case), **(extra or {})}
    scalars = {**asked, **effort(work), "converged": False, "status": status, "residual": float("nan")}
    return Record(
        analysis=analysis, scalars=scalars, case_toml=case.to_toml(), title=case.title, history=list(work.history)
    )


def given(case: Case) -> Named:
    """What was asked, and the geometry that views need."""
    bearing, (e_x, e_y) = case.bearing, case.operation.eccentricity
    return {
        "speed": case.operation.speed,
        "eccentricity_x": e_x,
        "eccentricity_y": e_y,
        "journal_radius": bearing.journal_radius,
        "bushing_radius": bearing.bushing_radius,
        "length": bearing.length,
        **wall_kind(case).geometry(case),
        "ambient_pressure": case.gas.ambient_pressure,
        "contact_film_thickness": case.surface.contact_film_thickness,
    }


def forces(case: Case, answer: Solution) -> Named:
    """Forces on the journal (J1), (J2) and the share that contact carries (J3)."""
    film, scales = answer.problem.layout.wall.film, answer.problem.layout.scales
    Q = (answer.problem.pressure(answer.x) - 1.0) * scales.pressure
    by_film = film_force(film, case.bearing.journal_radius, Q)
    reaction = answer.lam[answer.problem.layout.wall.contacts.journal] * scales.force
    touching = reaction.reshape(*film.theta.shape, -1).sum(axis=2) if len(reaction) else np.zeros(film.theta.shape)
    by_contact, total = contact_force(film.theta, touching), float(touching.sum())
    lift = float(np.sum(Q * node_area(film, case.bearing.journal_radius)))
    force = by_film + by_contact
    return {
        "force_x": float(force[0]),
        "force_y": float(force[1]),
        "bearing_force": float(np.hypot(*force)),
        "attitude_angle": attitude_angle(force, answer.problem.displacement),
        "film_force_x": float(by_film[0]),
        "film_force_y": float(by_film[1]),
        "contact_force_x": float(by_contact[0]),
        "contact_force_y": float(by_contact[1]),
        "contact_normal_force": total,
        "contact_fraction": total / (total + lift) if total > 0.0 else 0.0,
    }


def film_figures(case: Case, answer: Solution, fields: dict[str, Array]) -> Named:
    """Film, pressure, friction and leakage."""
    p, h = fields["pressure"], fields["film_thickness"]
    film, R_j = answer.problem.layout.wall.film, case.bearing.journal_radius
    z, omega, mu = film.axial.whole_z, case.operation.speed, case.gas.viscosity
    thin, high = lowest(h, film.phi), highest(p, film.phi)
    closed = min(
        case.surface.contact_film_thickness, float(h.min())
    )  # where the journal touches, the film is its floor
    gridded = tuple(part[..., : len(film.axial.z)] for part in (p, h))
    slip = case.slip_length * case.gas.ambient_pressure
    torque = viscous_torque(film, R_j, (gridded[0], gridded[1]), (mu, omega * R_j), slip)
    reactions = answer.lam[answer.problem.layout.wall.contacts.journal].sum() * answer.problem.layout.scales.force
    torque += case.surface.friction_coefficient * R_j * float(reactions)
    return {
        "min_film_thickness": max(thin.value, closed),
        "min_film_thickness_angle": float(np.mod(film.theta[thin.strip, 0] - film.phi[0] + thin.phi, 2.0 * np.pi)),
        "min_film_thickness_z": float(z[thin.axial]),
        "knudsen_number": case.gas.mean_free_path / max(thin.value, closed),
        "peak_pressure": high.value,
        "peak_pressure_angle": float(np.mod(film.theta[high.strip, 0] - film.phi[0] + high.phi, 2.0 * np.pi)),
        "friction_torque": torque,
        "power_loss": torque * omega,
        "side_leakage": leakage(case, answer),
    }


def leakage(case: Case, answer: Solution) -> float:
    """Mass flow out of both ends [kg/s] (J5)."""
    scales, gas = answer.problem.layout.scales, case.gas
    unit = scales.pressure**2 * scales.length**3 / (12.0 * gas.viscosity)  # of `p` times volume flow
    return side_leakage(answer) * unit * gas.ambient_density / gas.ambient_pressure


def trust(answer: Solution) -> Named:
    """Residual and balances."""
    return {
        "reference_film_thickness": answer.problem.layout.scales.length,
        "residual": answer.residual,
        "mass_balance_error": mass_balance(answer),
        "reaction_balance_error": reaction_balance(answer),
        "converged": True,
        "status": "converged",
    }


def effort(work: RunLog) -> Named:
    """What it cost."""
    return {
        "iterations": sum("residual" in row or row["phase"] in ("contacts", "classic") for row in work.history),
        "factorizations": work.film.factorizations,
        "pack_iterations": work.package.factorizations,
        "probe_factorizations": work.probes.factorizations,
    }
