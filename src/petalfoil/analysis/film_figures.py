"""Film, contacts and friction of one bearing at an instant of a motion, and the work that they do between two."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.closest_gap import lowest_gaps
from petalfoil.analysis.evaluation import closed_film, whole_film
from petalfoil.analysis.extremes_of_many import highest_of_each, lowest_of_each
from petalfoil.dynamics.time_state import Instant
from petalfoil.physics.forces import node_area, viscous_torques
from petalfoil.system.film_rows import FilmState
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.point_equations import PointEquations
from petalfoil.system.point_friction import stretching_energy
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
    found : pair of arrays, or Instant
        Unknowns and reactions at the nodes, (n,) and (m,), or the instant that gives them when they are asked for.
    points : PointEquations or None
        The state with contact points, of which what is at the nodes is sampled; None where contacts are at nodes.
    stretching : float
        Energy of petals that friction at contact points stretches [1].
    """

    problem: StepProblem
    found: tuple[Array, Array] | Instant
    points: PointEquations | None = None
    stretching: float = 0.0

    @classmethod
    def each_of(cls, problem: StepProblem | ShaftStep, instant: Instant) -> list[Self]:
        """Every bearing of a `problem` at the speed and position of an instant."""
        equations, pulls = instant.equations, instant.friction
        if equations is None or not isinstance(problem, StepProblem):
            return [cls(part, (x, lam)) for part, x, lam in problem.each(instant.x, instant.lam)]
        points = equations.state.points
        stretching = 0.0 if pulls is None else stretching_energy(equations.whole, points, pulls.force)
        return [cls(problem, instant, equations, stretching)]

    @property
    def x(self) -> Array:
        """Unknowns at the nodes, (n,) [1]."""
        return self.found.x if isinstance(self.found, Instant) else self.found[0]

    @property
    def lam(self) -> Array:
        """Reactions at the nodes, (m,) [1]."""
        return self.found.lam if isinstance(self.found, Instant) else self.found[1]

    @property
    def unknown_pressures(self) -> Array:
        """Pressure unknowns, (n_film,) [1]."""
        return self.x[self.problem.positive] if self.points is None else self.points.pressures

    @property
    def pressure(self) -> Array:
        """At all film nodes [1]."""
        return np.asarray(self.problem.layout.balance.nodal_pressure(self.unknown_pressures))

    @cached_property
    def film(self) -> Array:
        """Film thickness at all film nodes [1]."""
        return self.problem.film(self.x) if self.points is None else self.points.film_thickness

    @property
    def outflow(self) -> Array:
        """Residuals of the film's rows without what they store, (n_film,) [1]."""
        if self.points is not None:
            return self.points.film.residual
        return FilmState(self.problem.layout.film_rows, self.pressure, self.film, self.problem.bearing_number).residual

    @property
    def pressing(self) -> float:
        """Sum of the reactions on the journal [1]."""
        if self.points is None:
            return float(self.lam[self.problem.journal].sum())
        points = self.points.state.points
        return float(points.reaction[points.every_curve < self.points.whole.pack.mesh.count].sum())

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

    @property
    def journal_force(self) -> Array:
        """Of film and contacts over the unit of force, (d,) [1]."""
        return self.problem.journal_force(self.x, self.lam) if self.points is None else self.points.journal_force


@dataclass(frozen=True)
class FilmFigures:
    """Film, contacts and friction of one bearing.

    Attributes
    ----------
    thinnest, peak : float
        Minimum film thickness [m] and peak pressure [Pa].
    touching : float
        Normal force of solid contact on the journal [N].
    pressed : float
        Sum of the forces of the film on the journal where it presses on it [N].
    viscous, rubbing : float
        Friction torques of film and solid contact [N m].
    gas, outflow : float
        Gas in the film, and what of it leaves in a unit of time, in a unit that all bearings share.
    """

    thinnest: float
    peak: float
    touching: float
    pressed: float
    viscous: float
    rubbing: float
    gas: float
    outflow: float

    @classmethod
    def of_each(cls, states: Sequence[BearingState], stored: Sequence[Array]) -> list[Self]:
        """Those of a bearing in each of several states; `stored` is what its film and wall store then (n_stored,)."""
        layout = states[0].problem.layout
        case, rows, mesh = layout.case, layout.film_rows, layout.wall.film
        ambient, R_j, viscosity = layout.scales.pressure, case.bearing.journal_radius, case.gas.viscosity
        p = np.array([state.pressure for state in states]) * ambient
        h = np.array([state.film for state in states]) * layout.scales.length
        surface = R_j * np.array([layout.speed(state.problem.bearing_number) for state in states])
        touching = np.array([state.pressing for state in states]) * layout.scales.force
        unit = ambient**2 / viscosity  # of flow, but for the length that all films are measured by
        columns = (
            thinnest_of_each(states, h),
            highest_of_each(*whole_film(mesh, p)),
            touching,
            np.sum(np.maximum(p - ambient, 0.0) * node_area(mesh, R_j), axis=(1, 2, 3)),
            viscous_torques(mesh, R_j, (p, h), (viscosity, surface), case.slip_length * ambient),
            case.surface.friction_coefficient * R_j * touching,
            np.array([rows.total(gas[: mesh.n_unknown]) for gas in stored]) * unit,
            np.array([rows.total(state.outflow) for state in states]) * unit,
        )
        return [cls(*row) for row in zip(*(column.tolist() for column in columns), strict=True)]


def thinnest_of_each(states: Sequence[BearingState], h: Array) -> Array:
    """Minimum film thickness in each state, (k,) [m], from that at the nodes (k, strip, node, axial) [m].

    With contact points it is that of the gap curves.
    """
    layout, out = states[0].problem.layout, np.zeros(len(states))
    at_nodes = [k for k, state in enumerate(states) if state.points is None]
    if at_nodes:
        between = lowest_of_each(*whole_film(layout.wall.film, h[at_nodes]))
        out[at_nodes] = [closed_film(layout.case, h[k], low) for k, low in zip(at_nodes, between.tolist(), strict=True)]
    at_points = {k: state.points for k, state in enumerate(states) if state.points is not None}
    if at_points:
        whole = next(iter(at_points.values())).whole
        gaps = lowest_gaps(np.array([points.nodal_gaps for points in at_points.values()]), whole)[0].min(axis=1)
        out[[*at_points]] = layout.case.surface.contact_film_thickness + np.maximum(gaps, 0.0) * layout.scales.length
    return out


def film_work(before: BearingState, after: BearingState) -> float:
    """Work of the film of a bearing on journal and wall between two instants [1].

    Between an instant with contact points and one with contacts at nodes it is that at the nodes.
    """
    layout = before.problem.layout
    mean = 0.5 * (before.unknown_pressures + after.unknown_pressures) - 1.0
    moved = after.problem.displacement - before.problem.displacement
    on_journal = float(layout.border.row_derivative @ mean @ moved)
    if before.points is None or after.points is None:
        return on_journal + float((layout.push @ mean) @ (after.deflection - before.deflection))
    return on_journal + float((before.points.whole.push @ mean) @ (after.points.state.w - before.points.state.w))


def dragging_work(before: BearingState, after: BearingState) -> float:
    """Work of the journal's dry friction on wall and rotor between two instants (D6), (D7) [1], not on the shaft.

    Between an instant with contact points and one with contacts at nodes it is that at the nodes.
    """
    earlier, later = before.problem, after.problem
    if later.acting is later.G:
        return 0.0
    if before.points is not None and after.points is not None:
        each = (before.points.rubbing, after.points.rubbing)
        on_wall, on_rotor = (0.5 * (one + other) for one, other in zip(*each, strict=True))
        moved = after.points.state.w - before.points.state.w, later.displacement - earlier.displacement
        return float(on_wall @ moved[0] + on_rotor @ moved[1])
    pulled = 0.5 * (before.lam + after.lam)
    on_wall = (later.acting.T @ pulled - later.G.T @ pulled) @ (after.x - before.x)
    on_rotor = (later.border.by_reactions - later.border.gap_derivative.T) @ pulled
    return float(on_wall + on_rotor @ (later.displacement - earlier.displacement))


def growth_work(before: BearingState, after: BearingState) -> float:
    """Work of a journal that grows on the contacts that it touches between two instants [1]."""
    return 0.5 * (before.pressing + after.pressing) * (after.problem.closing - before.problem.closing)
