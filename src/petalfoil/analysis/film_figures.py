"""Film, contacts and friction of one bearing at an instant of a motion, and the work that they do between two."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.closest_gap import closest_gap
from petalfoil.analysis.evaluation import closed_film, whole_film
from petalfoil.analysis.extremes import highest, lowest
from petalfoil.dynamics.time_state import Instant
from petalfoil.physics.forces import node_area, viscous_torque
from petalfoil.system.film_rows import FilmState
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.point_equations import PointEquations
from petalfoil.system.point_friction import stretching_energy
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.time_step import StepProblem
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]


@dataclass(frozen=True)
class BearingState:
    """A bearing at an instant.

    Attributes
    ----------
    problem : StepProblem
        Speed and position.
    x, lam : (n,), (m,) array
        Unknowns and reactions, those at the nodes.
    points : PointEquations or None
        The same with contact points, of which unknowns and reactions are samples; None where contacts are at nodes.
    stretching : float
        Energy of petals that friction at contact points stretches [1].
    """

    problem: StepProblem
    x: Array
    lam: Array
    points: PointEquations | None = None
    stretching: float = 0.0

    @classmethod
    def each_of(cls, problem: StepProblem | ShaftStep, instant: Instant, whole: PointLayout | None) -> list[Self]:
        """Every bearing of a `problem` at the speed and position of an instant."""
        if instant.points is None or whole is None or not isinstance(problem, StepProblem):
            return [cls(*part) for part in problem.each(instant.x, instant.lam)]
        pulls, equations = instant.friction, PointEquations(whole, problem, instant.points)
        stretching = 0.0 if pulls is None else stretching_energy(whole, instant.points.points, pulls.force)
        return [cls(problem, instant.x, instant.lam, equations, stretching)]

    @cached_property
    def pressure(self) -> Array:
        """At all film nodes [1]."""
        if self.points is not None:
            return np.asarray(self.problem.layout.balance.nodal_pressure(self.points.state.P))
        return self.problem.pressure(self.x)

    @cached_property
    def film(self) -> Array:
        """Film thickness at all film nodes [1]."""
        return self.problem.film(self.x) if self.points is None else self.points.film_thickness

    @property
    def deflection(self) -> Array:
        """Of the wall at its nodes [1]."""
        return self.x[self.problem.layout.unknowns[DEFLECTION]]

    @cached_property
    def elastic_energy(self) -> float:
        """Of the wall; that of elements which point loads bend further (K11) is `lam C b lam / 2`; [1]."""
        if self.points is None:
            return 0.5 * float(self.deflection @ self.problem.layout.elastic_force(self.deflection))
        reaction, curvature = self.points.state.points.reaction, self.points.whole.bending @ self.points.state.w
        bent = 0.5 * float(curvature @ curvature + reaction @ self.points.gaps.bending)
        return bent + self.stretching

    @cached_property
    def thinnest(self) -> float:
        """Minimum film thickness [m]; with contact points that of the gap curves."""
        layout = self.problem.layout
        if self.points is not None:
            near = closest_gap(self.points.nodal_gaps, self.points.whole).gap
            return layout.case.surface.contact_film_thickness + max(near, 0.0) * layout.scales.length
        h = self.film * layout.scales.length
        return closed_film(layout.case, h, lowest(*whole_film(layout.wall.film, h)).value)

    @property
    def journal_force(self) -> Array:
        """Of film and contacts over the unit of force, (d,) [1]."""
        return self.problem.journal_force(self.x, self.lam) if self.points is None else self.points.force


@dataclass(frozen=True)
class FilmFigures:
    """Film, contacts and friction of one bearing.

    Attributes
    ----------
    thinnest, peak : float
        Minimum film thickness [m] and peak pressure [Pa].
    touching : float
        Normal force of solid contact on the journal [N].
    pressed : (n,) array
        Forces of the film on the nodes of the journal [N].
    viscous, rubbing : float
        Friction torques of film and solid contact [N m].
    gas, outflow : float
        Gas in the film, and what of it leaves in a unit of time, in a unit that all bearings share.
    """

    thinnest: float
    peak: float
    touching: float
    pressed: Array
    viscous: float
    rubbing: float
    gas: float
    outflow: float

    @classmethod
    def of(cls, bearing: BearingState, stored: Array) -> Self:
        """Those of a bearing; `stored` is what its film and wall store (n_stored,)."""
        part, layout = bearing.problem, bearing.problem.layout
        case = layout.case
        mesh, ambient, R_j = layout.wall.film, layout.scales.pressure, case.bearing.journal_radius
        P, H = bearing.pressure, bearing.film
        p, h, omega = P * ambient, H * layout.scales.length, layout.speed(part.bearing_number)
        touching = float(bearing.lam[part.journal].sum()) * layout.scales.force
        film = FilmState(layout.film_rows, P, H, part.bearing_number)
        unit = ambient**2 / case.gas.viscosity  # of flow, but for the length that all films are measured by
        shear = (case.gas.viscosity, omega * R_j)
        return cls(
            thinnest=bearing.thinnest,
            peak=highest(*whole_film(mesh, p)).value,
            touching=touching,
            pressed=((p - ambient) * node_area(mesh, R_j)).ravel(),
            viscous=viscous_torque(mesh, R_j, (p, h), shear, case.slip_length * ambient),
            rubbing=case.surface.friction_coefficient * R_j * touching,
            gas=film.rows.total(stored[: mesh.n_unknown]) * unit,
            outflow=film.rows.total(film.residual) * unit,
        )


def film_work(before: BearingState, after: BearingState) -> float:
    """Work of the film of a bearing on journal and wall between two instants [1].

    Between an instant with contact points and one with contacts at nodes it is that at the nodes.
    """
    earlier, later = before.problem, after.problem
    kept = earlier.positive
    force = 0.5 * (earlier.film_force(before.x) + later.film_force(after.x))
    on_journal = float(force @ (later.displacement - earlier.displacement))
    mean = 0.5 * (before.x[kept] + after.x[kept]) - 1.0
    if before.points is None or after.points is None:
        return on_journal + float((earlier.layout.push @ mean) @ (after.deflection - before.deflection))
    return on_journal + float((before.points.whole.push @ mean) @ (after.points.state.w - before.points.state.w))


def dragging_work(before: BearingState, after: BearingState) -> float:
    """Work of the journal's dry friction on wall and rotor between two instants (D6), (D7) [1], not on the shaft."""
    earlier, later = before.problem, after.problem
    if later.acting is later.G:
        return 0.0
    pulled = 0.5 * (before.lam + after.lam)
    on_wall = (later.acting.T @ pulled - later.G.T @ pulled) @ (after.x - before.x)
    on_rotor = (later.border.by_reactions - later.border.gap_derivative.T) @ pulled
    return float(on_wall + on_rotor @ (later.displacement - earlier.displacement))


def growth_work(before: BearingState, after: BearingState) -> float:
    """Work of a journal that grows on the contacts that it touches between two instants [1]."""
    pressed = (before.lam + after.lam)[before.problem.journal]
    return 0.5 * float(np.sum(pressed)) * (after.problem.closing - before.problem.closing)
