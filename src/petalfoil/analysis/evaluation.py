"""A solution evaluated once: film, forces on the journal, friction, leakage, balances, as typed parts of a record."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.balances import mass_balance, reaction_balance
from petalfoil.analysis.closest_gap import closest_gap
from petalfoil.analysis.extremes import Extreme, highest, lowest
from petalfoil.case import Case
from petalfoil.equilibrium.nodal_state import NodalState
from petalfoil.equilibrium.solution import Solution
from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.forces import attitude_angle, contact_fraction, node_area, viscous_torque
from petalfoil.results.parts import Balances, FilmResults, Forces

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Evaluation:
    """A solution and its film.

    Attributes
    ----------
    case : Case
        The bearing.
    answer : Solution
        Its equilibrium.
    state : NodalState
        Film, deflections and reactions in the units of the problem.
    pressure, film_thickness : (strip, node, axial) arrays
        Absolute pressure [Pa] and film thickness [m] at the nodes that are solved.
    reactions : (strip, node) array
        Normal force of contact on the journal [N].
    """

    case: Case
    answer: Solution
    state: NodalState
    pressure: Array
    film_thickness: Array
    reactions: Array

    @classmethod
    def of(cls, case: Case, answer: Solution) -> Evaluation:
        """Evaluate pressure, film and reactions."""
        state, layout = NodalState.of(answer), answer.problem.layout
        film, contacts, scales = layout.wall.film, layout.wall.contacts, layout.scales
        lam = state.lam[contacts.journal] * scales.force
        touching = lam.reshape(*film.theta.shape, -1).sum(axis=2) if len(lam) else np.zeros(film.theta.shape)
        return cls(case, answer, state, state.film.P * scales.pressure, state.film.H * scales.length, touching)

    @property
    def viscosity(self) -> float:
        """Viscosity of the gas in the film [Pa s]."""
        return self.case.gas.viscosity * self.answer.problem.viscosity_ratio

    @property
    def mean_free_path(self) -> float:
        """Mean free path of the gas in the film at ambient pressure (F8) [m]."""
        gas, warm = self.case.gas, self.answer.problem.temperatures
        hotter = 1.0 if warm is None else warm.film / gas.temperature
        return gas.mean_free_path * self.answer.problem.viscosity_ratio * math.sqrt(hotter)

    @property
    def normal_force(self) -> float:
        """Sum of the contact reactions on the journal [N]."""
        return float(self.reactions.sum())

    @property
    def contact_fraction(self) -> float:
        """Contact fraction (J3) [1]."""
        area = node_area(self.answer.problem.layout.wall.film, self.case.bearing.journal_radius)
        return contact_fraction(self.normal_force, self.pressure - self.case.gas.ambient_pressure, area)

    def forces(self) -> Forces:
        """Forces on the journal (J1), (J2), and the fraction that solid contact carries (J3)."""
        problem, total = self.state.problem, self.normal_force
        unit = problem.layout.scales.force
        by_film, by_contact = self.state.film_force * unit, self.state.contact_force * unit
        force = (by_film + by_contact)[:2]
        moment_x, moment_y = self._moment()
        return Forces(
            force_x=float(force[0]),
            force_y=float(force[1]),
            bearing_force=float(np.hypot(*force)),
            attitude_angle=attitude_angle(force, problem.displacement[:2]),
            film_force_x=float(by_film[0]),
            film_force_y=float(by_film[1]),
            contact_force_x=float(by_contact[0]),
            contact_force_y=float(by_contact[1]),
            contact_normal_force=total,
            contact_fraction=self.contact_fraction,
            moment_x=moment_x,
            moment_y=moment_y,
        )

    def _moment(self) -> tuple[float, float] | tuple[None, None]:
        """Moment on the journal about the bearing's centre (J7) [N m]; None of an axis that is parallel by itself."""
        operation, answer = self.case.operation, self.answer
        if operation.tilt is None and operation.moment is None:
            return None, None
        state = answer.lines or answer
        x, y = state.problem.journal_moment(state.x, state.lam) * answer.problem.layout.scales.force
        return float(x), float(y)

    @property
    def thinnest(self) -> Extreme:
        """Minimum film thickness [m] and its place; the contact film thickness where surfaces touch.

        Petals with continuous slopes have it where their gap curves are closest to the journal: between the film's
        nodes, where their contacts are too.
        """
        film, elements = self.answer.problem.layout.wall.film, self.answer.elements
        if elements is not None:
            near = closest_gap(elements.equations.nodal_gaps, elements.equations.whole)
            gap = max(near.gap, 0.0) * self.answer.problem.layout.scales.length
            return Extreme(self.case.surface.contact_film_thickness + gap, near.petal, near.phi, 0.0)
        thin = lowest(*whole_film(film, self.film_thickness))
        return replace(thin, value=closed_film(self.case, self.film_thickness, thin.value))

    def film(self) -> FilmResults:
        """Extremes of film and pressure, friction and leakage."""
        film, case = self.answer.problem.layout.wall.film, self.case
        radius, omega = case.bearing.journal_radius, case.operation.speed
        thin, high = self.thinnest, highest(*whole_film(film, self.pressure))
        torque = viscous_torque(
            film,
            radius,
            (self.pressure, self.film_thickness),
            (self.viscosity, omega * radius),
            case.slip_length * case.gas.ambient_pressure,
        )
        torque += case.surface.friction_coefficient * radius * self.normal_force
        return FilmResults(
            min_film_thickness=thin.value,
            min_film_thickness_angle=self._bushing_angle(thin.strip, thin.phi),
            min_film_thickness_z=None if film.axial.is_2d else thin.z,
            knudsen_number=self.mean_free_path / thin.value,
            peak_pressure=high.value,
            peak_pressure_angle=self._bushing_angle(high.strip, high.phi),
            friction_torque=torque,
            power_loss=torque * omega,
            side_leakage=None if film.axial.is_2d else self._leakage(),
        )

    def balances(self) -> Balances:
        """Residual and balances."""
        return Balances(
            reference_film_thickness=self.answer.problem.layout.scales.length,
            residual=self.answer.reported_residual,
            mass_balance_error=mass_balance(self.answer, self.state.film.fluxes),
            reaction_balance_error=reaction_balance(self.answer),
        )

    def _bushing_angle(self, strip: int, phi: float) -> float:
        film = self.answer.problem.layout.wall.film
        return float(np.mod(film.theta[strip, 0] - film.phi[0] + phi, 2.0 * np.pi))

    def _leakage(self) -> float:
        """Mass flow out of both ends [kg/s] (J5)."""
        scales, gas = self.answer.problem.layout.scales, self.case.gas
        unit = scales.pressure**2 * scales.length**3 / (12.0 * self.viscosity)  # of pressure times volume flow
        warm = self.answer.problem.temperatures
        temperature = gas.temperature if warm is None else warm.film
        leakage = self.answer.problem.layout.balance.side_leakage(self.state.film.fluxes)
        return leakage * unit / (gas.gas_constant * temperature)


def whole_film(film: FilmMesh, field: Array) -> tuple[Array, Array, Array]:
    """A nodal field (strip, node, axial) over the whole length, the angles of its nodes [rad], and its stations [m]."""
    return film.axial.whole(field), film.phi, film.axial.whole_z


def closed_film(case: Case, film_thickness: Array, between_nodes: float) -> float:
    """Minimum film thickness [m]: between nodes, but where the journal touches the contact film thickness."""
    return max(between_nodes, min(case.surface.contact_film_thickness, float(film_thickness.min())))
