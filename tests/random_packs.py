"""Random bearings that can be built: a narrow family of steel packs in air, and the whole declared domain."""

import math
from collections.abc import Callable

import numpy as np

from petalfoil.case import Bearing, Case, Edges, Gas, Model, ModelKind, Mount, Operation, Petals, Surface
from petalfoil.case.free_shape import chordal_tilt
from petalfoil.case.pack_geometry import MAX_ARC_ANGLE
from petalfoil.errors import DefinitionError

FILM_FLOOR = 1e-6  # m
MAX_TRIES = 200


def random_case(rng: np.random.Generator, **changes: object) -> Case:
    """Draw a steel pack in air, 2-D, 32 cells per pitch, its journal turning and displaced.

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
    return _buildable(_draw, rng, changes)


def _buildable(
    draw: Callable[[np.random.Generator], Case], rng: np.random.Generator, changes: dict[str, object]
) -> Case:
    """The first case drawn that can be built with `changes`."""
    for _ in range(MAX_TRIES):
        try:
            return draw(rng).replace(**changes)
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


GASES = ("air", "nitrogen", "helium", "hydrogen", "argon", "carbon dioxide")
MAX_OVERLAP = 3.9


def wide_case(rng: np.random.Generator, **changes: object) -> Case:
    """Draw a bearing from the whole domain that the model declares, 2-D, 32 or 48 cells per pitch.

    Drawn: ambient or continuous edges, 3 to 20 petals, overlap 1.02 to 3.9 (petals up to 2.4 rad), both mounts, chordal
    roots or roots tilted by up to 0.15 rad from that, coatings, foils of 50 to 250 GPa, gases by name or by numbers,
    0.1 to 10 bar, 200 to 600 K, slip or none, 0.5 to 400 m/s, displacement up to 0.9 of the clearance that the layers
    leave. What cannot be built is drawn again.
    """
    return _buildable(_draw_wide, rng, changes)


def _draw_wide(rng: np.random.Generator) -> Case:
    R_j = _log_uniform(rng, 5e-3, 60e-3)
    count = int(rng.integers(3, 21))
    pitch = 2.0 * math.pi / count
    overlap = rng.uniform(1.02, min(MAX_OVERLAP, MAX_ARC_ANGLE / pitch))
    layers = math.floor(overlap) + 1
    metal = _log_uniform(rng, 1e-3, 9e-3) * R_j
    coating = metal * rng.choice([0.0, rng.uniform(0.0, 0.5)])
    thickness = metal + coating
    floor = _log_uniform(rng, 1e-7, 3e-6)
    clearance = layers * thickness * rng.uniform(1.1, 2.5) + floor + 2e-6
    r_m = R_j + clearance - 0.5 * thickness
    bend_radius = rng.uniform(1.05, 5.0) * r_m
    chordal = bool(rng.random() < 0.6)
    tilt = chordal_tilt(r_m, bend_radius, overlap * pitch) + rng.uniform(-0.15, 0.15)
    reach = rng.uniform(0.0, 0.9) * (clearance - layers * thickness - floor)
    direction = rng.uniform(0.0, 2.0 * math.pi)
    return Case(
        bearing=Bearing(journal_radius=R_j, bushing_radius=R_j + clearance, length=2.0 * R_j * rng.uniform(0.3, 3.0)),
        petals=Petals(
            count=count,
            arc_length=overlap * pitch * r_m,
            thickness=metal,
            coating=coating,
            bend_radius=bend_radius,
            root_tilt="chordal" if chordal else tilt,
            mount=Mount.HINGED if rng.random() < 0.5 else Mount.CLAMPED,
            youngs_modulus=rng.uniform(50e9, 250e9),
            poisson_ratio=rng.uniform(0.2, 0.4),
            first_root=rng.uniform(-math.pi, math.pi),
        ),
        gas=_draw_gas(rng),
        surface=Surface(contact_film_thickness=floor, friction_coefficient=rng.uniform(0.0, 0.6)),
        operation=Operation(
            speed=_log_uniform(rng, 0.5, 400.0) / R_j,
            eccentricity=(reach * math.cos(direction), reach * math.sin(direction)),
        ),
        model=Model(
            kind=ModelKind.TWO_D,
            edges=Edges.CONTINUOUS if rng.random() < 0.5 else Edges.AMBIENT,
            slip=bool(rng.random() < 0.5),
            cells_per_pitch=int(rng.choice([32, 48])),
        ),
    )


def _draw_gas(rng: np.random.Generator) -> Gas:
    state = {"temperature": rng.uniform(200.0, 600.0), "ambient_pressure": _log_uniform(rng, 1e4, 1e6)}
    if rng.random() < 0.5:
        return Gas(name=str(rng.choice(GASES)), **state)
    return Gas(viscosity=_log_uniform(rng, 5e-6, 6e-5), gas_constant=_log_uniform(rng, 100.0, 4200.0), **state)


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))
