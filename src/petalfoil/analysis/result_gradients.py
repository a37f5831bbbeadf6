"""Derivatives of results by the state of an equilibrium, its case held: what an adjoint begins with.

Each result is read from a few fields. Its derivatives by these are closed forms; those of an extreme are the weights of
the nodes about it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.closest_gap import closest_gap
from petalfoil.analysis.evaluation import Evaluation, whole_film
from petalfoil.analysis.extremes import Extreme, highest, lowest, weights_at
from petalfoil.physics.forces import node_area
from petalfoil.sparsity import add_up

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FieldGradient:
    """Derivatives of a result by fields over their units.

    Attributes
    ----------
    pressure, film : (strip, node, axial) arrays
        By pressure and film thickness at the nodes.
    reactions : float
        By the sum of the normal forces on the journal.
    film_force, contact_force : (d,) arrays
        By the force of film and of contacts on the journal.
    displacement : (d,) array
        By the journal's displacement.
    gaps : (2 n_node,) array or None
        By the nodal gaps of petals with continuous slopes.
    """

    pressure: Array
    film: Array
    reactions: float
    film_force: Array
    contact_force: Array
    displacement: Array
    gaps: Array | None = None

    def times(self, factor: float) -> FieldGradient:
        """A multiple."""
        return FieldGradient(
            factor * self.pressure,
            factor * self.film,
            factor * self.reactions,
            factor * self.film_force,
            factor * self.contact_force,
            factor * self.displacement,
            None if self.gaps is None else factor * self.gaps,
        )


def nothing(found: Evaluation) -> FieldGradient:
    """That of a constant."""
    field, d = np.zeros_like(found.pressure), np.zeros(len(found.answer.position))
    return FieldGradient(field, field, 0.0, d, d, d)


def gradient(name: str, found: Evaluation) -> FieldGradient | None:
    """Derivatives of the result `name`; None of one without, and of a film that contact keeps closed."""
    function = GRADIENTS.get(name)
    return None if function is None else function(found)


def _component(axis: int, *, film: bool, contact: bool) -> Callable[[Evaluation], FieldGradient]:
    """A component of the forces on the journal."""

    def of(found: Evaluation) -> FieldGradient:
        none = nothing(found)
        unit = np.zeros_like(none.displacement)
        unit[axis] = found.answer.problem.layout.scales.force
        return replace(none, film_force=film * unit, contact_force=contact * unit)

    return of


def _along_force(found: Evaluation, rows: Array) -> FieldGradient:
    """A function of the force with derivatives `rows` (2,) [1/N]."""
    none = nothing(found)
    force = np.zeros_like(none.displacement)
    force[:2] = rows * found.answer.problem.layout.scales.force
    return replace(none, film_force=force, contact_force=force)


def _force(found: Evaluation) -> Array:
    forces = found.forces()
    return np.array([forces.force_x, forces.force_y])


def bearing_force(found: Evaluation) -> FieldGradient:
    """Magnitude of the force."""
    force = _force(found)
    return _along_force(found, force / np.linalg.norm(force))


def attitude_angle(found: Evaluation) -> FieldGradient:
    """Angle from the load to the displacement (J2)."""
    (x, y), e = _force(found), found.answer.position
    none = _along_force(found, np.array([y, -x]) / (x**2 + y**2))
    turned = np.zeros_like(none.displacement)
    turned[:2] = np.array([-e[1], e[0]]) / (e[0] ** 2 + e[1] ** 2)
    return replace(none, displacement=turned)


def contact_normal_force(found: Evaluation) -> FieldGradient:
    """Sum of the normal forces."""
    return replace(nothing(found), reactions=found.answer.problem.layout.scales.force)


def contact_fraction(found: Evaluation) -> FieldGradient:
    """Part of solid contact in what presses on the journal (J3)."""
    contact = found.normal_force
    if not contact > 0.0:
        return nothing(found)
    area = node_area(found.answer.problem.layout.wall.film, found.case.bearing.journal_radius)
    over = found.pressure - found.case.gas.ambient_pressure
    film = float(np.sum(np.maximum(over, 0.0) * area))
    per_pressure = np.where(over > 0.0, area, 0.0) * found.answer.problem.layout.scales.pressure
    whole = (contact + film) ** 2
    scaled = contact_normal_force(found).times(film / whole)
    return replace(scaled, pressure=-contact / whole * per_pressure)


def min_film_thickness(found: Evaluation) -> FieldGradient | None:
    """Minimum film thickness; None where surfaces touch and it keeps the contact film thickness."""
    layout, field = found.answer.problem.layout, found.film_thickness
    if found.thinnest.value <= CLOSED * found.case.surface.contact_film_thickness:
        return None
    if (elements := found.answer.elements) is not None:
        near = closest_gap(elements.equations.nodal_gaps, elements.equations.whole)
        return replace(nothing(found), gaps=near.weights(elements.equations.whole) * layout.scales.length)
    low = lowest(*whole_film(layout.wall.film, field))
    if found.thinnest.value != low.value:
        return None
    return replace(nothing(found), film=by_nodes(low, found, field) * layout.scales.length)


CLOSED = 1.0 + 1e-6
"""Minimum film thickness over the contact film thickness up to which surfaces touch."""


def by_nodes(extreme: Extreme, found: Evaluation, field: Array) -> Array:
    """Derivatives of an extreme of a nodal `field` by the nodes that are solved, mirrored ones included."""
    film = found.answer.problem.layout.wall.film
    numbers = film.axial.whole(np.arange(field.size, dtype=np.float64).reshape(field.shape)).astype(np.intp)
    weights = weights_at(extreme, *whole_film(film, field))
    return np.asarray(add_up(numbers.ravel(), weights.ravel(), field.size).reshape(field.shape))


def knudsen_number(found: Evaluation) -> FieldGradient | None:
    """Mean free path over the minimum film thickness."""
    film, thinnest = min_film_thickness(found), found.film().min_film_thickness
    return None if film is None else film.times(-found.mean_free_path / thinnest**2)


def peak_pressure(found: Evaluation) -> FieldGradient:
    """Peak pressure."""
    film, field = found.answer.problem.layout.wall.film, found.pressure
    weights = by_nodes(highest(*whole_film(film, field)), found, field)
    return replace(nothing(found), pressure=weights * found.answer.problem.layout.scales.pressure)


def friction_torque(found: Evaluation) -> FieldGradient:
    """Torque of the film (J4) and of rubbing contacts."""
    case, film, scales = found.case, found.answer.problem.layout.wall.film, found.answer.problem.layout.scales
    R_j, p, h = case.bearing.journal_radius, found.pressure, found.film_thickness
    slip = case.slip_length * case.gas.ambient_pressure
    shear = found.viscosity * case.operation.speed * R_j * node_area(film, R_j) / (h + 2.0 * slip / p) ** 2
    by_h, by_p = -shear, shear * 2.0 * slip / p**2
    across = film.axial.load_weight
    pressed, mean_h = 0.25 * np.diff(p, axis=1) * across, 0.25 * (h[:, :-1] + h[:, 1:]) * across
    for faces, sign in ((slice(0, -1), -1.0), (slice(1, None), 1.0)):
        by_h[:, faces] += pressed
        by_p[:, faces] += sign * mean_h
    rubbing = contact_normal_force(found).times(case.surface.friction_coefficient * R_j)
    return replace(rubbing, pressure=R_j * scales.pressure * by_p, film=R_j * scales.length * by_h)


def power_loss(found: Evaluation) -> FieldGradient:
    """Friction torque times speed."""
    return friction_torque(found).times(found.case.operation.speed)


def _position(axis: int) -> Callable[[Evaluation], FieldGradient]:
    """A coordinate of the journal."""

    def of(found: Evaluation) -> FieldGradient:
        none = nothing(found)
        unit = np.zeros_like(none.displacement)
        unit[axis] = found.answer.problem.layout.scales.length
        return replace(none, displacement=unit)

    return of


GRADIENTS: dict[str, Callable[[Evaluation], FieldGradient | None]] = {
    "force_x": _component(0, film=True, contact=True),
    "force_y": _component(1, film=True, contact=True),
    "film_force_x": _component(0, film=True, contact=False),
    "film_force_y": _component(1, film=True, contact=False),
    "contact_force_x": _component(0, film=False, contact=True),
    "contact_force_y": _component(1, film=False, contact=True),
    "bearing_force": bearing_force,
    "attitude_angle": attitude_angle,
    "contact_normal_force": contact_normal_force,
    "contact_fraction": contact_fraction,
    "min_film_thickness": min_film_thickness,
    "knudsen_number": knudsen_number,
    "peak_pressure": peak_pressure,
    "friction_torque": friction_torque,
    "starting_torque": friction_torque,
    "power_loss": power_loss,
    "eccentricity_x": _position(0),
    "eccentricity_y": _position(1),
}
"""Results that have an adjoint."""
