"""Random bearings that can be built: petal packages of every kind the model admits."""

import math

import numpy as np

from petalfoil.case import Bearing, Case, Gas, Model, ModelKind, Mount, Operation, Petals, Surface
from petalfoil.case.package import MAX_ARC_ANGLE
from petalfoil.errors import DefinitionError

FILM_FLOOR = 1e-6  # m
MAX_TRIES = 200


def random_case(rng: np.random.Generator, **changes: object) -> Case:
    """Draw a steel package in air, flat, 32 cells a pitch, its journal turning and displaced.

    Drawn: 5 to 12 petals, overlap 1.2 to 3 (petals up to 2.4 rad), both mounts, journals of 5 to 60 mm, petals of 0.3
    to 0.9 % of that, room for 1.25 to 2.2 times the layers and 5 um, bend radius 1.1 to 2.5 of the metric radius, L/D
    0.5 to 1.5, 20 to 250 m/s, displacement up to 0.3 of the room that the layers leave. What cannot be built is
    drawn again.

    Parameters
    ----------
    rng : numpy Generator
        Source of the numbers.
    **changes
        New values by dotted path, applied to what was drawn, as `Case.replace` takes them.
    """
    for _ in range(MAX_TRIES):
        try:
            return _draw(rng).replace(**changes)
        except DefinitionError:
            continue
    raise RuntimeError(f"no valid case in {MAX_TRIES} draws")


def _draw(rng: np.random.Generator) -> Case:
    count = int(rng.integers(5, 13))
    pitch = 2.0 * math.pi / count
    overlap = rng.uniform(1.2, min(3.0, MAX_ARC_ANGLE / pitch))
    layers = math.floor(overlap) + 1
    R_j = rng.uniform(5e-3, 60e-3)
    delta = rng.uniform(0.003, 0.009) * R_j
    clearance = layers * delta * rng.uniform(1.25, 2.2) + 5e-6
    r_m = R_j + clearance - 0.5 * delta
    reach = rng.uniform(0.0, 0.3) * (clearance - layers * delta - FILM_FLOOR)
    direction = rng.uniform(0.0, 2.0 * math.pi)
    return Case(
        bearing=Bearing(journal_radius=R_j, bushing_radius=R_j + clearance, length=2.0 * R_j * rng.uniform(0.5, 1.5)),
        petals=Petals(
            count=count,
            arc_length=overlap * pitch * r_m,
            thickness=delta,
            bend_radius=rng.uniform(1.1, 2.5) * r_m,
            mount=Mount.HINGED if rng.random() < 0.5 else Mount.CLAMPED,
            youngs_modulus=200e9,
            poisson_ratio=0.3,
        ),
        gas=Gas(viscosity=1.85e-5, ambient_pressure=1e5),
        surface=Surface(contact_film_thickness=FILM_FLOOR),
        operation=Operation(
            speed=rng.uniform(20.0, 250.0) / R_j,
            eccentricity=(reach * math.cos(direction), reach * math.sin(direction)),
        ),
        model=Model(kind=ModelKind.TWO_D, cells_per_pitch=32),
    )
