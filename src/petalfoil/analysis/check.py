"""What follows from a case without a run: geometry, stiffness, room, and the assembled cross-section."""

from __future__ import annotations

import math

import numpy as np

from petalfoil.analysis.fields import coordinates, petal_fields
from petalfoil.analysis.figures import given
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case, ModelKind
from petalfoil.equilibrium.ascent import rest
from petalfoil.equilibrium.run_log import RunLog
from petalfoil.errors import ConvergenceError
from petalfoil.results.record import Record
from petalfoil.system.build import build_problem
from petalfoil.system.scales import Scales
from petalfoil.walls.petals import petals_of

FINE = 2001
"""Angles at which the free shape is looked at."""

Named = dict[str, float | int | bool | str]


def run(case: Case) -> Record:
    """Derive the figures of `case` and assemble its package at rest.

    Raises
    ------
    ConvergenceError
        The package did not settle.
    """
    scalars: Named = {**given(case), **bearing_figures(case)}
    if case.petals is None:
        return Record(analysis="check", scalars=scalars, case_toml=case.to_toml(), title=case.title)
    flat = case.replace(**{"model.kind": ModelKind.TWO_D, "operation.speed": 0.0})
    with one_thread():
        work = RunLog()
        answer = rest(build_problem(flat), work)
    if answer is None:
        raise ConvergenceError("the package did not settle at rest", history=work.history, advice="check its geometry")
    fields = petal_fields(flat, answer)
    return Record(
        analysis="check",
        scalars={**scalars, **package_figures(case)},
        fields={"free_radius": fields["free_radius"], "radius": fields["radius"]},
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
    thinnest = case.room if case.petals is None else case.surface.contact_film_thickness
    return {
        "radial_clearance": case.room,
        "pack_clearance": case.pack_clearance,
        "compressibility_number": number,
        "viscosity": case.gas.viscosity,
        "mean_free_path": case.gas.mean_free_path,
        "knudsen_number": case.gas.mean_free_path / thinnest,
    }


def package_figures(case: Case) -> Named:
    """Overlap, layers, stiffness, free shape."""
    petals, package = petals_of(case)
    phi = np.linspace(0.0, package.petal_angle, FINE)
    r0 = package.free_radius(phi)
    inner = r0 - 0.5 * package.thickness - case.bearing.journal_radius
    touching = np.flatnonzero(inner <= 0.0)
    return {
        "overlap": package.overlap,
        "layers": package.layers,
        "petal_angle": package.petal_angle,
        "pitch": package.pitch,
        "covered_angle": package.covered_angle,
        "metric_radius": package.metric_radius,
        "bending_stiffness": petals.bending_stiffness,
        "root_tilt": package.root_tilt,
        "first_contact_angle": float(phi[touching[0]]) if len(touching) else math.nan,
        "free_petal_height": float(np.max(package.metric_radius - r0)),
    }
