"""Film, contacts and friction of one bearing at an instant of a motion, and the work that they do between two."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.evaluation import closed_film, whole_film
from petalfoil.analysis.extremes import highest, lowest
from petalfoil.physics.forces import node_area, viscous_torque
from petalfoil.system.film_rows import FilmState
from petalfoil.system.time_step import StepProblem
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]

BearingState = tuple[StepProblem, Array, Array]
"""A bearing with its unknowns and reactions."""


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
        part, x, lam = bearing
        layout, case = part.layout, part.layout.case
        mesh, ambient, R_j = layout.wall.film, layout.scales.pressure, case.bearing.journal_radius
        P, H = part.pressure(x), part.film(x)
        p, h, omega = P * ambient, H * layout.scales.length, layout.speed(part.bearing_number)
        touching = float(lam[part.journal].sum()) * layout.scales.force
        film = FilmState(layout.film_rows, P, H, part.bearing_number)
        unit = ambient**2 / case.gas.viscosity  # of flow, but for the length that all films are measured by
        shear = (case.gas.viscosity, omega * R_j)
        return cls(
            thinnest=closed_film(case, h, lowest(*whole_film(mesh, h)).value),
            peak=highest(*whole_film(mesh, p)).value,
            touching=touching,
            pressed=((p - ambient) * node_area(mesh, R_j)).ravel(),
            viscous=viscous_torque(mesh, R_j, (p, h), shear, case.slip_length * ambient),
            rubbing=case.surface.friction_coefficient * R_j * touching,
            gas=film.rows.total(stored[: mesh.n_unknown]) * unit,
            outflow=film.rows.total(film.residual) * unit,
        )


def film_work(before: BearingState, after: BearingState) -> float:
    """Work of the film of a bearing on journal and wall between two instants [1]."""
    (earlier, x, _), (later, X, _) = before, after
    kept, wall = earlier.positive, earlier.layout.unknowns[DEFLECTION]
    force = 0.5 * (earlier.film_force(x) + later.film_force(X))
    pushed = 0.5 * earlier.layout.push @ (x[kept] + X[kept] - 2.0)
    return float(force @ (later.displacement - earlier.displacement) + pushed @ (X[wall] - x[wall]))


def dragging_work(before: BearingState, after: BearingState) -> float:
    """Work of the journal's dry friction on wall and rotor between two instants (D6), (D7) [1], not on the shaft."""
    (earlier, x, lam), (later, X, LAM) = before, after
    if later.acting is later.G:
        return 0.0
    pulled = 0.5 * (lam + LAM)
    on_wall = (later.acting.T @ pulled - later.G.T @ pulled) @ (X - x)
    on_rotor = (later.border.by_reactions - later.border.gap_derivative.T) @ pulled
    return float(on_wall + on_rotor @ (later.displacement - earlier.displacement))


def growth_work(before: BearingState, after: BearingState) -> float:
    """Work of a journal that grows on the contacts that it touches between two instants [1]."""
    (earlier, _, lam), (later, _, LAM) = before, after
    return 0.5 * float(np.sum((lam + LAM)[earlier.journal])) * (later.closing - earlier.closing)
