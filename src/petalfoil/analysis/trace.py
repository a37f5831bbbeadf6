"""What a motion leaves behind: figures at every step, its audits, pictures, and the state to go on from."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.film_figures import BearingState, FilmFigures, dragging_work, film_work, growth_work
from petalfoil.case import Case
from petalfoil.dynamics.point_path import nodal_friction, point_friction
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.mesh.quadrature import accumulated
from petalfoil.physics.forces import contact_fraction
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.friction import energy_lost
from petalfoil.system.unknowns import DEFLECTION
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]
Named = dict[str, Array]

FRAMES = 48
"""Pictures kept, the latest ones."""
FRAMES_A_TURN = 24
"""Pictures of a turn of the shaft."""

AT_ONCE = 2**14
"""Film nodes of the steps whose results are computed together: arrays of more no longer fit into a cache."""

STILL = 1e-12
"""Work over the elastic energy of the pack at first up to which nothing has moved: energies are rounded to 1e-15."""

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
    contact_model_energy: float | None


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
    frames : deque
        The latest pictures: instants at equal angles of the shaft.
    last : Instant or None
        The latest instant.
    """

    case: Case
    system: RotorBearing
    frames: deque[Instant] = field(default_factory=lambda: deque(maxlen=FRAMES))
    last: Instant | None = None
    _figures: StepFigures = field(default_factory=StepFigures)
    _waiting: list[Instant] = field(default_factory=list)
    _before: tuple[Instant, list[BearingState]] | None = None
    _due: float = -np.inf

    def add(self, instant: Instant) -> None:
        """Keep an instant."""
        self.last = instant
        angle = self.turned
        self._waiting.append(instant)
        if angle >= self._due:
            self.frames.append(instant)
            self._due = angle + 2.0 * np.pi / FRAMES_A_TURN
        if len(self._waiting) >= self._at_once:
            self._settle()

    @property
    def turned(self) -> float:
        """Angle that the shaft has turned by at the latest instant, since time zero [rad]."""
        rotor = self.system.rotor
        return 0.0 if self.last is None else rotor.schedule.angle(self.last.tau / rotor.clock.rate)

    @property
    def rows(self) -> StepFigures:
        """Figures of every step, SI."""
        self._settle()
        return self._figures

    @cached_property
    def _at_once(self) -> int:
        """Steps whose results are computed together."""
        parts = self.system.problem.each(*self._waiting[0].nodal[:2])
        return max(1, AT_ONCE // max(part.layout.wall.film.unknown.size for part, _, _ in parts))

    def _settle(self) -> None:
        """Compute the figures of all instants that wait for it, and what film and loads have done up to each."""
        waiting, self._waiting = self._waiting, []
        if not waiting:
            return
        parts = [self._bearings(instant) for instant in waiting]
        films = self._films(waiting, parts)
        for instant, own, film in zip(waiting, parts, films, strict=True):
            done = self.done_since(instant, own)
            self._figures.append({**self.rotor_figures(instant, own), **self.film_figures(instant, own, film), **done})
            self._before = instant, own

    @cached_property
    def _units(self) -> tuple[float, float, float, float]:
        """Length [m], pressure [Pa], force [N], units of time in a second [rad/s]."""
        scales = self.system.problem.layout.scales
        return scales.length, scales.pressure, scales.force, self.system.rotor.clock.rate

    def _bearings(self, instant: Instant) -> list[BearingState]:
        """Every bearing at the speed and position of an instant, with its unknowns and reactions."""
        number = self.system.rotor.bearing_number(instant.tau)
        there = self.system.problem.at(bearing_number=number, displacement=instant.e)
        return BearingState.each_of(there, instant)

    def _tilt(self, e: Array, v: Array) -> dict[str, float]:
        """Slopes of the shaft in two bearings [rad], and their rates [rad/s]."""
        if len(e) == 2 or self.case.rotor is None:
            return {}
        slopes = np.concatenate([e[2:], v[2:]]) / self.case.rotor.lever
        return {name: float(slope) for name, slope in zip(TILT, slopes, strict=True)}

    def rotor_figures(self, instant: Instant, parts: list[BearingState]) -> dict[str, float]:
        """Position, velocity, speed and energies at an instant."""
        length, _, force, rate = self._units
        rotor = self.system.rotor
        t, (e, v) = instant.tau / rate, (instant.moving.e * length, instant.moving.v * length * rate)
        elastic = sum(part.elastic_energy for part in parts)
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
            "elastic_energy": elastic * force * length,
            "at_points": float(instant.between_nodes),
        }

    def _deflections(self, instant: Instant) -> list[tuple[BearingLayout, Array]]:
        """Every bearing and the deflections of its wall over the unit of length."""
        parts = self.system.problem.each(instant.x, instant.lam)
        return [(part.layout, x[part.layout.unknowns[DEFLECTION]]) for part, x, _ in parts]

    def _films(self, instants: Sequence[Instant], parts: Sequence[list[BearingState]]) -> list[tuple[FilmFigures, ...]]:
        """Figures of each bearing at every instant."""
        stored = [self.system.problem.stored_of_each(instant.moving.stored) for instant in instants]
        pairs = zip(zip(*parts, strict=True), zip(*stored, strict=True), strict=True)
        return list(zip(*(FilmFigures.of_each(states, gas) for states, gas in pairs), strict=True))

    def film_figures(
        self, instant: Instant, parts: list[BearingState], films: tuple[FilmFigures, ...]
    ) -> dict[str, float]:
        """Film, pressure, forces and friction at an instant, gas and what of it leaves; of all bearings together."""
        pushed = self._journal_force(instant, parts) * self._units[2]
        touching, pressed = sum(film.touching for film in films), np.array([film.pressed for film in films])
        return {
            "min_film_thickness": min(film.thinnest for film in films),
            "peak_pressure": max(film.peak for film in films),
            "contact_fraction": contact_fraction(touching, pressed, np.ones_like(pressed)),
            "force_x": float(pushed[0]),
            "force_y": float(pushed[1]),
            "friction_torque": sum(film.viscous + film.rubbing for film in films),
            "rubbing_torque": sum(film.rubbing for film in films),
            "gas": sum(film.gas for film in films),
            "outflow": sum(film.outflow for film in films) * self._units[3],
        }

    def _journal_force(self, instant: Instant, parts: list[BearingState]) -> Array:
        """Force of all bearings on the rotor, (d,) [1]."""
        if instant.points is not None:
            return parts[0].journal_force
        number = self.system.rotor.bearing_number(instant.tau)
        there = self.system.problem.at(bearing_number=number, displacement=instant.e)
        return there.journal_force(instant.x, instant.lam)

    def done_since(self, instant: Instant, parts: list[BearingState]) -> dict[str, float]:
        """Work of film, loads and growth on rotor and petals since the latest instant, by the trapezium rule [J]."""
        if self._before is None:
            return dict.fromkeys(("film_step", "load_step", "petals_step", "growth_step", "dragging_step"), 0.0)
        system, unit, before = self.system, self._units[2] * self._units[0], self._before[0]
        pairs = list(zip(self._before[1], parts, strict=True))
        loads = 0.5 * (system.rotor.outside(before.tau) + system.rotor.outside(instant.tau))
        worn = self._lost(before, instant) + self._rubbed(before, instant)
        return {
            "film_step": sum(film_work(*pair) for pair in pairs) * unit,
            "load_step": float(loads @ (instant.e - before.e)) * unit,
            "petals_step": worn * unit,
            "growth_step": sum(growth_work(*pair) for pair in pairs) * unit,
            "dragging_step": sum(dragging_work(*pair) for pair in pairs) * unit,
        }

    def _rubbed(self, before: Instant, instant: Instant) -> float:
        """Energy that friction between petals takes between two instants [1]."""
        friction, whole = self.system.friction, self.system.points
        if friction is None or before.friction is None or instant.friction is None:
            return 0.0
        if whole is None or instant.points is None:
            then = nodal_friction(friction, before)
            return energy_lost(friction.in_step(before.lam), then, instant.friction)
        return point_friction(whole, friction, before).lost(instant.friction, instant.points.points)

    @cached_property
    def _loses(self) -> bool:
        """Whether a wall loses energy."""
        return any(state.problem.layout.loss is not None for state in self._before[1]) if self._before else False

    def _lost(self, before: Instant, instant: Instant) -> float:
        """Energy that walls with a loss factor lose between two instants [1]."""
        if not self._loses:
            return 0.0
        rates, lost = before.change.stored + instant.change.stored, 0.0
        walls = zip(self._deflections(before), self._deflections(instant), strict=True)
        for own, ((layout, earlier), (_, later)) in zip(self.system.problem.stored_of_each(rates), walls, strict=True):
            if layout.loss is not None:
                lost += 0.5 * float(own[layout.wall.film.n_unknown :] @ (later - earlier))
        return lost

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
            over[work] = accumulated(self.column(torque) * speed, time)
        return time, over

    def audits(self, over: Named) -> Audits:
        """Mass-balance and energy-balance errors (O6) of the histories `over`: both fall as the square of the steps.

        What changes in steps from contact points to nodes or back is told apart: the difference of the grids. Where
        nothing moves (`STILL`) there is no error of energy.
        """
        gas, outflow, time = self.column("gas"), self.column("outflow"), self.column("time")
        gained = gas - gas[0] + accumulated(outflow, time)
        energy = over["kinetic_energy"] + over["elastic_energy"] - over["kinetic_energy"][0]
        missing = energy - over["load_work"] - over["film_work"] + over["petal_friction_work"]
        missing -= np.cumsum(self.column("growth_step"))  # a journal that grows bends the petals it touches
        missing -= np.cumsum(self.column("dragging_step"))  # one that rubs moves them along itself
        exchanged = np.sum(np.abs(self.column("load_step"))) + np.sum(np.abs(self.column("film_step")))
        moves = exchanged > STILL * abs(self.rows[0]["elastic_energy"])
        passes = np.diff(self.column("at_points"), prepend=self.rows[0]["at_points"]) != 0.0
        passing = np.where(passes, np.diff(missing, prepend=missing[0]), 0.0)
        error, passed = np.max(np.abs(missing - np.cumsum(passing))), np.sum(np.abs(passing))
        return Audits(
            mass_balance_error=float(np.max(np.abs(gained)) / gas[0]) if gas[0] else 0.0,
            energy_balance_error=float(error / exchanged) if moves else 0.0,
            contact_model_energy=float(passed / exchanged) if passes.any() and moves else None,
        )

    def pictures(self) -> tuple[dict[str, NDArray[np.generic]], Named]:
        """Coordinates and fields of the pictures; of two bearings the first is shown."""
        rate, instants = self._units[3], list(self.frames)
        shown = [self._bearings(instant)[0] for instant in instants]
        layout = shown[0].problem.layout
        mesh, length, ambient = layout.wall.film, layout.scales.length, layout.scales.pressure
        whole, kind = mesh.axial.whole, wall_kind(layout.case)
        coords: dict[str, NDArray[np.generic]] = {
            "frame": np.array([instant.tau for instant in instants]) / rate,
            "petal": np.arange(len(mesh.theta)),
            "root_angle": mesh.theta[:, 0] - mesh.phi[0],
            "phi_exposed": mesh.phi,
            "z": mesh.axial.whole_z,
        }
        fields: Named = {
            "frame_pressure": np.array([whole(part.pressure * ambient) for part in shown]),
            "frame_film_thickness": np.array([whole(part.film * length) for part in shown]),
            "frame_x": np.array([part.problem.displacement[0] * length for part in shown]),
            "frame_y": np.array([part.problem.displacement[1] * length for part in shown]),
        }
        sections = kind.cross_section(layout.case, np.array([part.deflection * length for part in shown]))
        if sections:
            coords |= kind.coordinates(layout.case, layout.wall)
            fields["frame_radius"] = sections["radius"]
        return coords, fields
