"""What a motion leaves behind: figures at every step, its audits, pictures, and the state to go on from."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from petalfoil.analysis.evaluation import closed_film, whole_film
from petalfoil.analysis.extremes import highest, lowest
from petalfoil.case import Case
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.physics.forces import contact_fraction, node_area, viscous_torque
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.film_rows import FilmState
from petalfoil.system.friction import energy_lost
from petalfoil.system.unknowns import DEFLECTION
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]
Named = dict[str, Array]

FRAMES = 48
"""Pictures kept, the latest ones."""
FRAMES_A_TURN = 24
"""Pictures of a turn of the shaft."""


AS_THEY_ARE = (
    *(
        "x",
        "y",
        "velocity_x",
        "velocity_y",
        "shaft_speed",
        "shaft_angle",
        "min_film_thickness",
        "contact_fraction",
        "peak_pressure",
    ),
    *("force_x", "force_y", "friction_torque", "kinetic_energy"),
)
"""Figures of the steps that are kept as they are."""

TILT = ("slope_x", "slope_y", "slope_rate_x", "slope_rate_y")
"""The same of a shaft that tilts."""


@dataclass(frozen=True)
class Audits:
    """Balances that a motion must keep [1]."""

    mass_balance_error: float
    energy_balance_error: float


class StepFigures:
    """Results of every step: one number of each name, eight bytes each in arrays that double as they fill."""

    def __init__(self) -> None:
        self._names: tuple[str, ...] = ()
        self._values = np.zeros((0, 0))
        self._count = 0

    def append(self, row: dict[str, float]) -> None:
        """Add the numbers of a step, which have the same names as those before."""
        if not self._names:
            self._names, self._values = tuple(row), np.empty((FRAMES, len(row)))
        if self._count == len(self._values):
            self._values = np.concatenate([self._values, np.empty_like(self._values)])
        self._values[self._count] = [row[name] for name in self._names]
        self._count += 1

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, step: int) -> dict[str, float]:
        """Numbers of one step."""
        return dict(zip(self._names, self._values[: self._count][step].tolist(), strict=True))

    def column(self, name: str) -> Array:
        """One of the numbers over all steps, (step,)."""
        return self._values[: self._count, self._names.index(name)].copy()


@dataclass
class Trace:
    """Everything kept of one motion.

    Attributes
    ----------
    case, system
        The bearing and its rotor, and the same in the units of the problem.
    rows : StepFigures
        Figures of every step, SI.
    frames : deque
        The latest pictures: instants at equal angles of the shaft.
    last : Instant or None
        The latest instant.
    """

    case: Case
    system: RotorBearing
    rows: StepFigures = field(default_factory=StepFigures)
    frames: deque[Instant] = field(default_factory=lambda: deque(maxlen=FRAMES))
    last: Instant | None = None
    _due: float = -np.inf

    def add(self, instant: Instant) -> None:
        """Keep an instant, and what film and loads have done since the one before."""
        row = {**self.rotor_figures(instant), **self.film_figures(instant), **self.done_since(instant)}
        self.rows.append(row)
        self.last = instant
        if row["shaft_angle"] >= self._due:
            self.frames.append(instant)
            self._due = row["shaft_angle"] + 2.0 * np.pi / FRAMES_A_TURN

    @cached_property
    def _units(self) -> tuple[float, float, float, float]:
        """Length [m], pressure [Pa], force [N], units of time in a second [rad/s]."""
        scales = self.system.problem.layout.scales
        return scales.length, scales.pressure, scales.force, self.system.rotor.clock.rate

    def _problem(self, instant: Instant) -> CoupledProblem:
        """The bearing at the speed and position of an instant."""
        return self.system.problem.at(
            bearing_number=self.system.rotor.bearing_number(instant.tau), displacement=instant.e
        )

    def _tilt(self, e: Array, v: Array) -> dict[str, float]:
        """Slopes of the shaft in two bearings [rad], and their rates [rad/s]."""
        if len(e) == 2 or self.case.rotor is None:
            return {}
        slopes = np.concatenate([e[2:], v[2:]]) / self.case.rotor.lever
        return {name: float(slope) for name, slope in zip(TILT, slopes, strict=True)}

    @cached_property
    def _area(self) -> Array:
        return node_area(self.system.problem.layout.wall.film, self.case.bearing.journal_radius)

    def rotor_figures(self, instant: Instant) -> dict[str, float]:
        """Position, velocity, speed and energies at an instant."""
        length, _, force, rate = self._units
        layout, rotor = self.system.problem.layout, self.system.rotor
        t, (e, v) = instant.tau / rate, (instant.moving.e * length, instant.moving.v * length * rate)
        w = instant.x[layout.unknowns[DEFLECTION]]
        kinetic = 0.5 * float(instant.moving.v @ rotor.inertia @ instant.moving.v) * force * length
        tilt = self._tilt(e, v)
        return {
            "time": t,
            "x": float(e[0]),
            "y": float(e[1]),
            "velocity_x": float(v[0]),
            "velocity_y": float(v[1]),
            "shaft_speed": rotor.schedule.speed(t),
            "shaft_angle": rotor.schedule.angle(t),
            "kinetic_energy": kinetic,
            **tilt,
            "elastic_energy": 0.5 * float(w @ layout.elastic_force(w)) * force * length,
        }

    def film_figures(self, instant: Instant) -> dict[str, float]:
        """Film, pressure, forces and friction at an instant, its gas and what of it leaves."""
        length, ambient, force, _ = self._units
        problem = self._problem(instant)
        mesh, case, contacts = problem.layout.wall.film, self.case, problem.layout.wall.contacts
        P, H = problem.pressure(instant.x), problem.film(instant.x)
        p, h, omega = P * ambient, H * length, self.system.rotor.schedule.speed(instant.tau / self._units[3])
        touching = float(instant.lam[contacts.journal].sum()) * force
        pushed = problem.journal_force(instant.x, instant.lam) * force
        shear = (case.gas.viscosity, omega * case.bearing.journal_radius)
        rubbing = case.surface.friction_coefficient * case.bearing.journal_radius * touching
        viscous = viscous_torque(mesh, case.bearing.journal_radius, (p, h), shear, case.slip_length * ambient)
        film = FilmState(problem.layout.film_rows, P, H, problem.bearing_number)
        return {
            "min_film_thickness": closed_film(case, h, lowest(*whole_film(mesh, h)).value),
            "peak_pressure": highest(*whole_film(mesh, p)).value,
            "contact_fraction": contact_fraction(touching, p - ambient, self._area),
            "force_x": float(pushed[0]),
            "force_y": float(pushed[1]),
            "friction_torque": viscous + rubbing,
            "rubbing_torque": rubbing,
            "gas": film.rows.total(instant.moving.stored[: mesh.n_unknown]),
            "outflow": film.rows.total(film.residual) * self._units[3],
        }

    def done_since(self, instant: Instant) -> dict[str, float]:
        """Work of film, loads and growth on rotor and petals since the latest instant, by the trapezium rule [J]."""
        before = self.last
        if before is None:
            return {"film_step": 0.0, "load_step": 0.0, "petals_step": 0.0, "growth_step": 0.0}
        length, _, force, _ = self._units
        layout, system = self.system.problem.layout, self.system
        kept, wall = system.problem.positive, layout.unknowns[DEFLECTION]
        by_film = 0.5 * (system.problem.film_force(before.x) + system.problem.film_force(instant.x))
        pushed = 0.5 * layout.push @ (before.x[kept] + instant.x[kept] - 2.0)
        loads = 0.5 * (system.rotor.outside(before.tau) + system.rotor.outside(instant.tau))
        moved, bent = instant.e - before.e, instant.x[wall] - before.x[wall]
        unit, friction, worn = force * length, system.friction, 0.0
        if friction is not None and before.friction is not None and instant.friction is not None:
            worn = energy_lost(friction.in_step(before.lam), before.friction, instant.friction)
        if layout.loss is not None:
            rates = before.change.stored + instant.change.stored
            worn += 0.5 * float(rates[layout.wall.film.n_unknown :] @ bent)
        done = float(by_film @ moved + pushed @ bent)
        touching = float(np.sum((before.lam + instant.lam)[layout.wall.contacts.journal]))
        grown = 0.5 * touching * (self._problem(instant).closing - self._problem(before).closing)
        return {
            "film_step": done * unit,
            "load_step": float(loads @ moved) * unit,
            "petals_step": worn * unit,
            "growth_step": grown * unit,
        }

    def column(self, name: str) -> Array:
        """One figure over all steps."""
        return self.rows.column(name)

    def histories(self) -> tuple[Array, Named]:
        """Time [s] and everything over it."""
        time, speed = self.column("time"), self.column("shaft_speed")
        over = {name: self.column(name) for name in (*AS_THEY_ARE, *(n for n in TILT if n in self.rows[0]))}
        elastic = self.column("elastic_energy")
        over["elastic_energy"] = elastic - elastic[0]
        over["load_work"] = np.cumsum(self.column("load_step"))
        over["film_work"] = np.cumsum(self.column("film_step"))
        over["petal_friction_work"] = np.cumsum(self.column("petals_step"))
        for work, torque in (("shaft_work", "friction_torque"), ("rubbing_work", "rubbing_torque")):
            over[work] = cumulative_trapezoid(self.column(torque) * speed, time, initial=0.0)
        return time, over

    def audits(self, over: Named) -> Audits:
        """Mass-balance and energy-balance errors (O6) of the histories `over`: both fall as the square of the steps."""
        gas, outflow, time = self.column("gas"), self.column("outflow"), self.column("time")
        gained = gas - gas[0] + cumulative_trapezoid(outflow, time, initial=0.0)
        energy = over["kinetic_energy"] + over["elastic_energy"] - over["kinetic_energy"][0]
        missing = energy - over["load_work"] - over["film_work"] + over["petal_friction_work"]
        missing -= np.cumsum(self.column("growth_step"))  # a journal that grows bends the petals it touches
        exchanged = np.sum(np.abs(self.column("load_step"))) + np.sum(np.abs(self.column("film_step")))
        return Audits(
            mass_balance_error=float(np.max(np.abs(gained)) / gas[0]) if gas[0] else 0.0,
            energy_balance_error=float(np.max(np.abs(missing)) / exchanged) if exchanged else 0.0,
        )

    def pictures(self) -> tuple[dict[str, NDArray[np.generic]], Named]:
        """Coordinates and fields of the pictures."""
        length, ambient, _, rate = self._units
        problem = self.system.problem
        mesh = problem.layout.wall.film
        whole, instants = mesh.axial.whole, list(self.frames)
        first = len(mesh.theta) // problem.layout.wall.n_bearings  # of two bearings the first is shown
        coords: dict[str, NDArray[np.generic]] = {
            "frame": np.array([instant.tau for instant in instants]) / rate,
            "petal": np.arange(first),
            "root_angle": mesh.theta[:first, 0] - mesh.phi[0],
            "phi_exposed": mesh.phi,
            "z": mesh.axial.whole_z,
        }
        films = [self._problem(instant).film(instant.x) * length for instant in instants]
        fields: Named = {
            "frame_pressure": np.array([whole(problem.pressure(at.x)[:first] * ambient) for at in instants]),
            "frame_film_thickness": np.array([whole(film[:first]) for film in films]),
            "frame_x": np.array([self._at_first(instant)[0] for instant in instants]),
            "frame_y": np.array([self._at_first(instant)[1] for instant in instants]),
        }
        sections = [wall_kind(self.case).cross_section(self._whole, self._deflection(at)) for at in instants]
        if any(sections):
            coords |= wall_kind(self.case).coordinates(self._whole, problem.layout.wall)
            fields["frame_radius"] = np.array([section["radius"] for section in sections])
        return coords, fields

    @cached_property
    def _whole(self) -> Case:
        """The case on the grid that is solved: of a shaft that tilts the whole length."""
        tilts = self.system.problem.layout.wall.n_bearings > 1
        return self.case.replace(**{"model.symmetry": False}) if tilts else self.case

    def _at_first(self, instant: Instant) -> Array:
        """Displacement of the journal in the (first) bearing [m]."""
        e = instant.e * self._units[0]
        if self.system.problem.layout.wall.n_bearings == 1 or self.case.rotor is None:
            return e
        return np.asarray(e[:2] + self.case.rotor.places[0] / self.case.rotor.lever * e[2:])

    def _deflection(self, instant: Instant) -> Array:
        """Deflections of the wall of the (first) bearing, (n,) [m]."""
        layout = self.system.problem.layout
        deflection: Array = instant.x[: layout.n_wall // layout.wall.n_bearings] * layout.scales.length
        return deflection
