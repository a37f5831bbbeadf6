"""Typed parts that a record is put together from: each field is a result of the schema, SI units.

What a wall or an analysis declares for itself may come as a mapping by name.

A record takes every result from one part; two parts that give the same result are refused. A field that is None is not
there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields

from petalfoil.results.record import Scalar


@dataclass(frozen=True, kw_only=True, slots=True)
class Geometry:
    """The geometry that views need."""

    journal_radius: float
    bushing_radius: float
    length: float
    ambient_pressure: float
    contact_film_thickness: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Position:
    """Speed and displacement of the journal; where a case has them, its tilt and the growth of shaft and bushing."""

    speed: float
    eccentricity_x: float
    eccentricity_y: float
    shaft_growth: float | None = None
    bushing_growth: float | None = None
    tilt_x: float | None = None
    tilt_y: float | None = None


@dataclass(frozen=True, slots=True)
class Leg:
    """Part of a path: up or down in speed; loading, unloading or reloading."""

    leg: str


@dataclass(frozen=True, kw_only=True, slots=True)
class AppliedLoad:
    """Load on the journal."""

    load_x: float
    load_y: float
    load_moment_x: float | None = None
    load_moment_y: float | None = None

    @classmethod
    def of(cls, load: tuple[float, float], moment: tuple[float, float] | None = None) -> AppliedLoad:
        """The load (x, y) [N] and, where one is given, the moment about the bearing's centre [N m]."""
        moment_x, moment_y = moment or (None, None)
        return cls(load_x=load[0], load_y=load[1], load_moment_x=moment_x, load_moment_y=moment_y)


@dataclass(frozen=True, kw_only=True, slots=True)
class Forces:
    """Forces of film and contacts on the journal."""

    force_x: float
    force_y: float
    bearing_force: float
    attitude_angle: float
    film_force_x: float
    film_force_y: float
    contact_force_x: float
    contact_force_y: float
    contact_normal_force: float
    contact_fraction: float
    moment_x: float | None = None
    moment_y: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class FilmResults:
    """Extremes of the film, friction and leakage.

    A 2-D film has no axial place and does not model the leakage.
    """

    min_film_thickness: float
    min_film_thickness_angle: float
    min_film_thickness_z: float | None
    knudsen_number: float
    peak_pressure: float
    peak_pressure_angle: float
    friction_torque: float
    power_loss: float
    side_leakage: float | None


@dataclass(frozen=True, kw_only=True, slots=True)
class Balances:
    """Residual of the equations, and balances computed from the state alone."""

    reference_film_thickness: float
    residual: float
    mass_balance_error: float
    reaction_balance_error: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Branch:
    """How an equilibrium was reached, how many are known, and whether it is stable."""

    solution_path: str
    stable: bool | None = None
    growth_rate: float | None = None
    growth_frequency: float | None = None
    known_equilibria: int | None = None
    jump: bool | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class Effort:
    """What the run cost."""

    iterations: int
    factorizations: int
    pack_iterations: int
    probe_factorizations: int
    coarse_factorizations: int
    wall_time: float | None = None


@dataclass(frozen=True, kw_only=True, slots=True)
class RunOutcome:
    """How the run ended."""

    converged: bool = True
    status: str = "converged"
    residual: float | None = None


def scalars_of(*parts: object) -> dict[str, Scalar]:
    """Results of typed parts, and of mappings, by name.

    Raises
    ------
    ValueError
        Two parts give the same result: a mistake of the program.
    """
    scalars: dict[str, Scalar] = {}
    for part in parts:
        for name, value in _named(part):
            if name in scalars:
                raise ValueError(f"{name!r} is given by two parts, the second is {type(part).__name__}")
            scalars[name] = value
    return scalars


def _named(part: object) -> Iterator[tuple[str, Scalar]]:
    """Names and values of a part; what is None is not there."""
    values = part.items() if isinstance(part, Mapping) else ((f.name, getattr(part, f.name)) for f in fields(part))  # type: ignore[arg-type]
    yield from ((name, value) for name, value in values if value is not None)
