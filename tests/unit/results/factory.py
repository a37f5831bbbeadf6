"""Synthetic but realistic records: what a solver would hand over, without a solver.

The pack obeys the geometry of the model: exposed strips tile the circle, the film jumps by one petal thickness from
strip to strip, contact is where the film is at its floor.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from petalfoil.results import Record

Floats = npt.NDArray[np.float64]

R_J, R_B, DELTA, LENGTH, BEND = 25e-3, 26e-3, 0.176e-3, 50e-3, 40e-3
R_M = R_B - DELTA / 2
AMBIENT, FLOOR = 1e5, 1e-6
CASE = 'title = "Paper, flat study, 8 petals"\n\n[bearing]\njournal_radius = "25 mm"  # µ survives\n'
GEOMETRY = {
    "journal_radius": R_J,
    "bushing_radius": R_B,
    "length": LENGTH,
    "petal_thickness": DELTA,
    "ambient_pressure": AMBIENT,
    "contact_film_thickness": FLOOR,
}


def free_radius(phi: Floats) -> Floats:
    """Circular arc whose free edge is back on the bore (the chordal root tilt)."""
    half = phi[-1] / 2
    centre = R_M * math.cos(half) - math.sqrt(BEND**2 - (R_M * math.sin(half)) ** 2)
    along = centre * np.cos(phi - half)
    return along + np.sqrt(along**2 - centre**2 + BEND**2)


def solved(
    *,
    petals: int = 8,
    overlap: float = 1.77,
    nz: int = 1,
    eccentricity: float = 100e-6,
    touching: bool = False,
    load: float = 25.0,
) -> Record:
    """One converged state of a petal bearing whose journal is displaced downward."""
    coords = grid(petals, overlap, nz)
    film, pressure, contact = film_fields(coords, eccentricity, touching)
    pack = pack_fields(coords, film, eccentricity, contact)
    scalars = {**GEOMETRY, **figures(coords, film, pressure, eccentricity, load), **bookkeeping()}
    return Record(
        analysis="solve",
        scalars=scalars,
        fields={"pressure": pressure, "film_thickness": film, "journal_contact_pressure": contact, **pack},
        coords=coords,
        case_toml=CASE,
        title="Paper, flat study, 8 petals",
        history=[
            {"phase": "pack", "iteration": 1, "residual": 1e-2},
            {"phase": "film", "iteration": 2, "residual": float("nan")},
        ],
    )


def plain(nz: int = 9) -> Record:
    """A rigid bore: one strip all round, no petals."""
    phi, z = np.linspace(0.0, 2 * np.pi, 97), np.linspace(0.0, LENGTH, nz)
    clearance = 30e-6
    film = np.broadcast_to((clearance * (1 + 0.6 * np.sin(phi)))[None, :, None], (1, 97, nz)).copy()
    profile = 4 * z * (LENGTH - z) / LENGTH**2
    pressure = AMBIENT * (1 + 0.8 * np.clip(np.sin(-phi - 0.5), 0.0, None)[None, :, None] ** 2 * profile[None, None, :])
    coords = {"petal": np.array([0]), "root_angle": np.array([0.0]), "phi_exposed": phi, "z": z}
    geometry = {**GEOMETRY, "bushing_radius": R_J + clearance}
    del geometry["petal_thickness"]
    return Record(
        analysis="solve",
        scalars={**geometry, **figures(coords, film, pressure, 18e-6, 40.0), **bookkeeping()},
        fields={"pressure": pressure, "film_thickness": film},
        coords=coords,
        title="Plain bearing",
    )


def at_rest(eccentricity: float = 0.0) -> Record:
    """The pack on a journal that does not turn: contact, no film figures."""
    record = solved(eccentricity=eccentricity, touching=True)
    fields = {name: values for name, values in record.fields.items() if name not in ("pressure", "film_thickness")}
    given = {"speed": 0.0, "eccentricity_x": 0.0, "eccentricity_y": -eccentricity}
    force = 3e4 * eccentricity + 4e8 * eccentricity**2
    answer = {
        "force_x": 0.0,
        "force_y": force,
        "bearing_force": force,
        "contact_normal_force": 55.0 + force,
        "starting_torque": 0.3 * R_J * (55.0 + force),
    }
    return Record(
        analysis="static",
        scalars={**GEOMETRY, **given, **answer, **bookkeeping()},
        fields=fields,
        coords=record.coords,
        title=record.title,
        case_toml=CASE,
    )


def checked() -> Record:
    """What ``check`` hands over: derived geometry, the free and the assembled shape."""
    record = solved(eccentricity=0.0, touching=True)
    phi = record.coords["phi"]
    derived = {
        "eccentricity_x": 0.0,
        "eccentricity_y": 0.0,
        "speed": 8000.0,
        "overlap": 1.77,
        "layers": 2,
        "petal_angle": float(phi[-1]),
        "pitch": math.pi / 4,
        "covered_angle": float(phi[-1]) - math.pi / 4,
        "metric_radius": R_M,
        "radial_clearance": R_B - R_J,
        "pack_clearance": R_B - R_J - 2 * DELTA - FLOOR,
        "compressibility_number": 5.55,
        "bending_stiffness": 0.0998,
        "root_tilt": 0.25,
        "first_contact_angle": 0.31,
        "free_petal_height": float(R_M - free_radius(phi).min()),
    }
    fields = {name: record.fields[name] for name in ("free_radius", "radius")}
    return Record(
        analysis="check",
        scalars={**GEOMETRY, **derived},
        fields=fields,
        coords=record.coords,
        title=record.title,
        case_toml=CASE,
    )


def failed(eccentricity: float = 300e-6) -> Record:
    """A point of a curve that did not converge, with the figures of its last iterate still in it."""
    scalars = {
        "speed": 8000.0,
        "eccentricity_x": 0.0,
        "eccentricity_y": -eccentricity,
        "bearing_force": 999.0,
        "force_x": 1.0,
        "force_y": 999.0,
    }
    run = {**bookkeeping(), "converged": False, "status": "the step length fell below its limit", "stable": True}
    return Record(
        analysis="solve", scalars={**GEOMETRY, **scalars, **run}, title="Paper, flat study, 8 petals", case_toml=CASE
    )


def curve(petals: int = 8, gain: float = 1.0) -> list[Record]:
    """A load characteristic with a failed, an unstable and a jumped-to point."""
    records: list[Record] = []
    for number, e in enumerate(np.linspace(0.0, 280e-6, 8)):
        load = gain * (60.0 * e / 280e-6 + 20.0 * (e / 280e-6) ** 3) + (6.0 if number >= 6 else 0.0)
        record = (
            failed(float(e)) if number == 4 else solved(petals=petals, overlap=1.77, eccentricity=float(e), load=load)
        )
        flags = {"jump": number == 6, "stable": number not in (2, 4), "growth_rate": 12.0 if number == 2 else -40.0}
        records.append(Record(**{**vars(record), "scalars": {**record.scalars, **flags}}))
    return records


def grid(petals: int, overlap: float, nz: int, cells: int = 32) -> dict[str, npt.NDArray[np.generic]]:
    """Nodes of a pitch divided at the fraction of the overlap, repeated."""
    pitch = 2 * np.pi / petals
    whole, fraction = divmod(overlap, 1.0)
    inner = max(1, round(cells * fraction))
    unit = np.concatenate(
        [np.linspace(0, fraction, inner, endpoint=False), np.linspace(fraction, 1, cells - inner, endpoint=False)]
    )
    turns = np.concatenate([unit + turn for turn in range(int(whole) + 1)])
    phi = pitch * np.append(turns[turns < overlap - 1e-9], overlap)
    return {
        "petal": np.arange(petals),
        "root_angle": pitch * np.arange(petals),
        "phi": phi,
        "phi_exposed": phi[phi > pitch * (overlap - 1) - 1e-9],
        "z": np.linspace(0.0, LENGTH, nz) if nz > 1 else np.array([LENGTH / 2]),
    }


def film_fields(
    coords: dict[str, npt.NDArray[np.generic]], eccentricity: float, touching: bool
) -> tuple[Floats, Floats, Floats]:
    """Film wedge, pressure hump and contact pressure of every exposed strip."""
    phi, z = coords["phi_exposed"].astype(float), coords["z"].astype(float)
    s = (phi - phi[0]) / (phi[-1] - phi[0])
    theta = coords["root_angle"].astype(float)[:, None] + phi
    closeness = 0.5 * (1.0 - np.sin(theta)) * min(1.0, eccentricity / 280e-6)  # 1 below, where the journal goes
    tip = 9e-6 - 5e-6 * closeness
    film = tip + DELTA * (1.0 - s) ** 2.2
    profile = 4 * z * (LENGTH - z) / LENGTH**2 if z.size > 1 else np.ones(1)
    pressure = (
        AMBIENT * (1.0 + (0.45 + 0.7 * closeness) * (27 / 4 * s**2 * (1 - s))[None, :])[:, :, None] * np.ones(z.size)
    )
    pressure = AMBIENT + (pressure - AMBIENT) * profile
    contact = np.zeros_like(pressure)
    full = np.repeat(film[:, :, None], z.size, axis=2)
    if touching:
        touched = (s > 0.85) & (s < 0.95)
        full[:, touched, :] = FLOOR
        contact[:, touched, :] = 2e4
    return full, pressure, contact


def pack_fields(
    coords: dict[str, npt.NDArray[np.generic]], film: Floats, eccentricity: float, contact: Floats
) -> dict[str, Floats]:
    """Deformed petals that carry the film: from the bore at the root to the strip they expose."""
    phi, exposed, roots = (coords[name].astype(float) for name in ("phi", "phi_exposed", "root_angle"))
    theta = roots[:, None] + exposed
    on_strip = R_J - eccentricity * np.sin(theta)[:, :, None] + film + DELTA / 2
    covered = phi[phi < exposed[0] - 1e-9] / exposed[0]
    start = on_strip[:, :1, :]
    under = R_M + (start - R_M) * (2 * covered - covered**2)[None, :, None]
    radius = np.concatenate([under, on_strip], axis=1)
    free = free_radius(phi)
    bushing, neighbour = np.zeros_like(radius), np.zeros_like(radius)
    bushing[:, 1:3, :] = 1e4
    neighbour[:, -1, :] = contact.max() + 3e4
    stress = 150e6 * np.sin(np.pi * phi / phi[-1])[None, :, None] * np.ones_like(radius)
    return {
        "deflection": radius - free[None, :, None],
        "radius": radius,
        "free_radius": free,
        "bushing_contact_pressure": bushing,
        "petal_contact_pressure": neighbour,
        "bending_stress": stress,
    }


def figures(
    coords: dict[str, npt.NDArray[np.generic]], film: Floats, pressure: Floats, eccentricity: float, load: float
) -> dict[str, float]:
    """Scalars of an answer; the load stands 20 degrees behind the displacement."""
    theta = coords["root_angle"].astype(float)[:, None] + coords["phi_exposed"].astype(float)
    thin, high = (np.unravel_index(index, film.shape) for index in (film.argmin(), pressure.argmax()))
    beta = math.radians(20.0)
    force_x, force_y = load * math.sin(beta), load * math.cos(beta)
    return {
        "speed": 8000.0,
        "eccentricity_x": 0.0,
        "eccentricity_y": -eccentricity,
        "force_x": force_x,
        "force_y": force_y,
        "bearing_force": load,
        "attitude_angle": beta,
        "film_force_x": force_x,
        "film_force_y": force_y,
        "contact_force_x": 0.0,
        "contact_force_y": 0.0,
        "contact_normal_force": 0.0,
        "contact_fraction": 0.0,
        "min_film_thickness": float(film.min()),
        "min_film_thickness_angle": float(theta[thin[0], thin[1]] % (2 * np.pi)),
        "min_film_thickness_z": float(coords["z"][thin[2]]),
        "peak_pressure": float(pressure.max()),
        "peak_pressure_angle": float(theta[high[0], high[1]] % (2 * np.pi)),
        "friction_torque": 3.2e-3,
        "power_loss": 25.6,
        "side_leakage": 1.2e-6,
        "max_bending_stress": 150e6,
    }


def bookkeeping() -> dict[str, float | int | bool | str]:
    """How the run went."""
    return {
        "residual": 3e-11,
        "mass_balance_error": 2e-12,
        "reaction_balance_error": 4e-12,
        "iterations": 18,
        "factorizations": 19,
        "pack_iterations": 9,
        "wall_time": 0.05,
        "converged": True,
        "status": "converged",
        "solution_path": "from rest",
        "known_equilibria": 1,
    }
