"""What a state of film and contacts does to the heat network, and how it changes with the state."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.physics.heat import FilmPower, film_conductance, film_power
from petalfoil.solvers.problem import Border
from petalfoil.sparsity import add_up
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.film_rows import FilmState
from petalfoil.system.heat_network import EXCHANGE, FILM_NODE, NODES, PACK, SHAFT, FilmHeat, HeatNetwork
from petalfoil.system.temperatures import Temperatures
from petalfoil.system.unknowns import DEFLECTION, PRESSURE

Array = NDArray[np.float64]

VISCOSITY_STEP = 1e-6
"""Relative step of the central difference of the film's rows by their bearing number: exact to some 1e-10."""


@dataclass(frozen=True)
class HeatRows:
    """The balances of a network at one state, and their derivatives, in the units of the problem.

    Temperatures are unknowns over that of the gas as it enters.

    Attributes
    ----------
    network : HeatNetwork
        The network.
    problem : CoupledProblem
        The bearing at its speed, position and temperatures.
    x, lam : (n,), (m,) array
        Unknowns and reactions.
    """

    network: HeatNetwork
    problem: CoupledProblem
    x: Array
    lam: Array

    @property
    def temperatures(self) -> Temperatures:
        """The temperatures [K]."""
        if self.problem.temperatures is None:
            raise ValueError("this state has no temperatures")
        return self.problem.temperatures

    @cached_property
    def film(self) -> tuple[Array, Array]:
        """Pressure and film thickness over their units at all nodes."""
        return self.problem.pressure(self.x), self.problem.film(self.x)

    @cached_property
    def surface_speed(self) -> float:
        """Speed of the journal's surface [m/s]."""
        layout = self.problem.layout
        return layout.speed(self.problem.bearing_number) * layout.balance.radius

    @cached_property
    def _power(self) -> FilmPower:
        layout, (P, H) = self.problem.layout, self.film
        state = (P * layout.scales.pressure, H * layout.scales.length)
        viscosity = self.network.gas.viscosity * self.problem.viscosity_ratio
        return film_power(layout.wall.film, layout.balance.radius, state, (viscosity, self.surface_speed))

    @cached_property
    def _conductance(self) -> tuple[float, Array]:
        layout, (_, H) = self.problem.layout, self.film
        conductivity = self.network.gas.conductivity * self.problem.viscosity_ratio
        return film_conductance(layout.wall.film, layout.balance.radius, H * layout.scales.length, conductivity)

    @property
    def _rubbing(self) -> float:
        """Friction power of contact by a unit of reaction [W]."""
        layout = self.problem.layout
        friction = layout.case.surface.friction_coefficient
        return self.network.power * friction * self.surface_speed * layout.scales.force

    @cached_property
    def film_heat(self) -> FilmHeat:
        """What film and contacts do to the network."""
        journal = self.problem.layout.wall.contacts.journal
        return FilmHeat(
            viscous=self.network.power * (self._power.couette + self._power.poiseuille),
            rubbing=self._rubbing * float(self.lam[journal].sum()),
            couette=self.network.power * self._power.couette,
            conductance=self._conductance[0],
            carried=self._carried(),
        )

    def _carried(self) -> float:
        """Heat capacity flow of the side leakage, `m c_p` (J5) [W/K]."""
        layout, gas = self.problem.layout, self.network.gas
        if layout.wall.film.axial.is_2d:
            return 0.0
        scales, state = layout.scales, FilmState(layout.film_rows, *self.film, self.problem.film_number)
        unit = scales.pressure**2 * scales.length**3 / (12.0 * gas.viscosity * self.problem.viscosity_ratio)
        mass = (
            layout.balance.side_leakage(state.fluxes) * unit / (layout.case.gas.gas_constant * self.temperatures.film)
        )
        return gas.heat_capacity * mass

    @cached_property
    def residual(self) -> Array:
        """The four balances (H3), (4,) [W]."""
        return self.network.residual(self.temperatures, self.film_heat)

    @property
    def scale(self) -> float:
        """What they are compared with: the friction power, or more where the tolerance would be their rounding [W]."""
        heat, (G, _) = self.film_heat, self.network.paths
        rounding = ROUNDING * float(np.trace(G)) * self.network.gas.temperature
        return max(heat.viscous + heat.rubbing, rounding / BALANCE)

    # ------------------------------------------------------------------------------------------ derivatives

    @cached_property
    def by_film(self) -> Array:
        """Derivative of the balances by the film thickness at all nodes, (4, nodes) [W]; leakage apart."""
        unit, T = self.problem.layout.scales.length, self.temperatures.nodes
        rows: Array = np.outer(EXCHANGE @ T, self._conductance[1].ravel() * unit)
        rows[FILM_NODE] += self.network.power * self._power.by_h.ravel() * unit
        return rows

    @cached_property
    def by_unknowns(self) -> Array:
        """Derivative by the unknowns, (4, n) [W].

        That of the leakage is left out: it carries below a tenth of the heat, and the iteration contracts by as much.
        """
        layout, unknowns = self.problem.layout, self.problem.layout.unknowns
        mesh, rows = layout.wall.film, np.zeros((NODES, layout.n))
        numbers = np.where(mesh.unknown >= 0, mesh.unknown, mesh.n_unknown).ravel()
        by_p = self.network.power * self._power.by_p.ravel() * layout.scales.pressure
        rows[FILM_NODE, unknowns[PRESSURE]] = add_up(numbers, by_p, mesh.n_unknown + 1)[:-1]
        under = np.where(layout.wall.film_unknown >= 0, layout.wall.film_unknown, layout.n_wall).ravel()
        for row, each in zip(rows, self.by_film, strict=True):
            row[unknowns[DEFLECTION]] = add_up(under, each, layout.n_wall + 1)[:-1]
        return rows

    @cached_property
    def by_reactions(self) -> Array:
        """Derivative by the reactions, (4, m) [W]."""
        rows = np.zeros((NODES, len(self.lam)))
        rows[[SHAFT, PACK], self.problem.layout.wall.contacts.journal] = 0.5 * self._rubbing
        return rows

    @cached_property
    def closing_slopes(self) -> Array:
        """Derivative of what growth takes from the gaps by the temperatures over that of the gas, (4,) [1]."""
        case, unit = self.problem.layout.case, self.network.gas.temperature / self.problem.layout.scales.length
        radii = case.bearing.journal_radius, case.bearing.bushing_radius
        journal, bore = case.growth.by_kelvin(case.shaft, case.bushing, radii)
        return np.array([0.0, journal, 0.0, -bore]) * unit

    @property
    def by_position(self) -> Array:
        """Derivative by the journal's position through the film, (4, n_position) [W]."""
        contacts = self.problem.layout.wall.contacts
        moved: Array = self.by_film @ contacts.by_e[contacts.journal]
        return moved

    @property
    def by_temperature(self) -> Array:
        """Derivative by the temperatures over that of the gas, the unknowns held, (4, 4) [W]."""
        direct = self.network.by_temperature(self.temperatures, self.film_heat) * self.network.gas.temperature
        slopes: Array = direct - np.outer(self.by_film.sum(axis=1), self.closing_slopes)
        return slopes

    def border(self, free: Border | None) -> Border:
        """How the temperatures enter, behind the journal's position where that is `free`; balances over their scale."""
        layout, unit = self.problem.layout, self.scale
        by_T, n = np.zeros((len(self.lam), NODES)), layout.n
        by_T[layout.wall.contacts.journal] = -self.closing_slopes
        forcing = np.zeros((n, NODES))
        forcing[:, FILM_NODE] = self._by_viscosity()
        rows, reactions = self.by_unknowns / unit, self.by_reactions / unit
        if free is None:
            return Border(by_T, rows, slice(0, n), reactions, forcing)
        of_force = np.zeros((free.size, n))
        of_force[:, free.columns] = free.row_derivative
        return Border(
            np.hstack([free.gap_derivative, by_T]),
            np.vstack([of_force, rows]),
            slice(0, n),
            np.vstack([free.by_reactions, reactions]),
            np.hstack([np.zeros((n, free.size)), forcing]),
        )

    def _by_viscosity(self) -> Array:
        """Derivative of the equations by the film's temperature over that of the gas, through the viscosity, (n,)."""
        problem, out = self.problem, self.problem.layout.unknowns.zeros()
        Lam, (P, H) = problem.film_number, self.film
        ahead, behind = (
            problem.layout.film_rows.at(P, H, Lam * (1.0 + side * VISCOSITY_STEP)).residual for side in (1.0, -1.0)
        )
        relative = self.network.gas.exponent * self.network.gas.temperature / self.temperatures.film
        out[problem.layout.unknowns[PRESSURE]] = (ahead - behind) / (2.0 * VISCOSITY_STEP) * relative
        return out


BALANCE = 1e-10
"""Largest imbalance of a node over the scale of the balances."""

ROUNDING = 4.0 * float(np.finfo(float).eps)
"""Rounding of a temperature, over it."""
