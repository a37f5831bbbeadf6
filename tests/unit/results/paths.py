"""Made-up motions: paths whose frequencies are known, and a result with such a path."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from petalfoil.results import Record
from petalfoil.results.motion import TURN, Path
from tests.cases import case

Floats = npt.NDArray[np.float64]
SPEED = 1000.0
BEARING = case("plain_journal", **{"model.cells_per_pitch": 16, "model.axial_cells": 4, "rotor.mass": 3.0})


def whirling(turns: float, *circles: tuple[float, float], speed: float = SPEED, drift: complex = 0.0) -> Path:
    """A sum of circles of (frequency over speed, radius [m]) on steps of unequal length, about 30 a turn."""
    part = np.linspace(0.0, 1.0, round(30 * turns) + 1)
    time = (part + 0.004 * np.sin(40.0 * part) * part * (1.0 - part)) * turns * TURN / speed
    z, v = drift * time, np.full(len(time), drift, dtype=complex)
    for ratio, radius in circles:
        circle = radius * np.exp(1j * ratio * speed * time)
        z, v = z + circle, v + 1j * ratio * speed * circle
    return Path(time, z.real, z.imag, v.real, v.imag, speed * time, np.full(len(time), speed))


def ramped(top: float, duration: float, ratio: float, radius: float) -> Path:
    """A circle whose frequency follows a speed that grows from zero."""
    time = np.linspace(0.0, duration, 6000)
    speed, angle = top * time / duration, 0.5 * top * time**2 / duration
    z = radius * np.exp(1j * ratio * angle)
    v = 1j * ratio * speed * z
    return Path(time, z.real, z.imag, v.real, v.imag, angle, speed)


def moved(path: Path, touching: bool = False) -> Record:
    """The result of a motion along a path in a plain bearing; its film and energies are made up, its balance exact."""
    distance, squared = np.hypot(path.x, path.y), path.velocity_x**2 + path.velocity_y**2
    kinetic = 1.5 * squared
    film_work = -0.1 * path.angle
    over = {
        **{"x": path.x, "y": path.y, "velocity_x": path.velocity_x, "velocity_y": path.velocity_y},
        **{"shaft_speed": path.speed, "shaft_angle": path.angle},
        "min_film_thickness": 25e-6 - distance,
        "contact_fraction": np.where(distance > 0.5 * distance.max(), 0.25, 0.0) * touching,
        "peak_pressure": np.full(len(path.time), 1.2e5),
        **{"force_x": 0.0 * path.x, "force_y": 0.0 * path.x + 29.4, "friction_torque": 0.0 * path.x + 1e-3},
        **{"kinetic_energy": kinetic, "elastic_energy": 0.0 * kinetic},
        **{"load_work": kinetic - kinetic[0] - film_work, "film_work": film_work},
        **{"shaft_work": 1e-3 * path.angle, "rubbing_work": 0.0 * path.angle},
    }
    coords, pictures = _pictures(path)
    geometry = {"journal_radius": 25e-3, "bushing_radius": 25.025e-3, "length": 50e-3, "contact_film_thickness": 1e-6}
    return Record(
        analysis="orbit",
        scalars={
            **geometry,
            **{
                "ambient_pressure": 1e5,
                "rotor_mass": 3.0,
                "speed": SPEED,
                "mass_balance_error": 1e-5,
                "energy_balance_error": 1e-4,
            },
            **{"amplitude": 1e-5, "dominant_whirl_ratio": 0.5, "revolutions": path.turns, "steps": len(path.time) - 1},
            **{"factorizations": 7, "failed_steps": 0, "wall_time": 0.5, "converged": True, "status": "converged"},
        },
        fields={**over, **pictures},
        coords={"time": path.time, **coords},
        case_toml=BEARING.to_toml(),
        title="Plain bearing",
    )


def _pictures(path: Path) -> tuple[dict[str, npt.NDArray[np.generic]], dict[str, Floats]]:
    """Three pictures of the film."""
    chosen = np.linspace(0, len(path.time) - 1, 3).astype(int)
    phi = np.linspace(0.0, TURN, 17)
    e_x, e_y = path.x[chosen], path.y[chosen]
    film = 25e-6 - e_x[:, None] * np.cos(phi) - e_y[:, None] * np.sin(phi)
    shape = (3, 1, 17, 1)
    coords: dict[str, npt.NDArray[np.generic]] = {
        **{"frame": path.time[chosen], "petal": np.arange(1), "root_angle": np.zeros(1), "phi_exposed": phi},
        "z": np.array([25e-3]),
    }
    pressure = 1e5 * (1.0 + (1e-5 / film) ** 2)
    fields = {"frame_pressure": pressure.reshape(shape), "frame_film_thickness": film.reshape(shape)}
    return coords, fields | {"frame_x": e_x, "frame_y": e_y}
