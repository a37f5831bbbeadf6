"""The heat balances of film, shaft, pack and bushing (H3), with their derivatives.

film      Phi_v - q_s - q_p - m c_p (T_f - T_0)                                     = 0
shaft     q_s + Phi_r / 2 - G_sa (T_s - T_a) - G_se (T_s - T_e) - C_s dT_s/dt       = 0
pack      q_p + Phi_r / 2 - G_pb (T_p - T_b) - G_c (T_p - T_c)  - C_p dT_p/dt       = 0
bushing   G_pb (T_p - T_b) - G_ba (T_b - T_a)                   - C_b dT_b/dt       = 0

`Phi_v` is the friction power of the film, `Phi_r` that of rubbing, `m` the side leakage, `q_s` and `q_p` the heat that
the film passes to shaft and pack (H2). A cooling flow takes `G_c = m_c c_p (1 - exp(-G_pc / (m_c c_p)))`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, Heat
from petalfoil.case.heat_table import HotGas
from petalfoil.physics.heat import FILM, OTHER, OWN
from petalfoil.system.temperatures import Temperatures

Array = NDArray[np.float64]

NODES = 4
"""Temperatures: film, shaft, pack, bushing."""


@dataclass(frozen=True)
class FilmHeat:
    """What the film and the contacts of one state do to the network, SI.

    Attributes
    ----------
    viscous, rubbing : float
        Friction power of film and of solid contact [W].
    couette : float
        The part of the former that is proportional to the viscosity [W].
    conductance : float
        Conductance of the gas between the walls, `k sum dA / h` [W/K].
    carried : float
        Heat capacity flow of the side leakage, `m c_p` [W/K].
    """

    viscous: float
    rubbing: float
    couette: float
    conductance: float
    carried: float


@dataclass(frozen=True)
class HeatNetwork:
    """The network of a case.

    Attributes
    ----------
    heat : Heat
        Conductances and capacities.
    gas : HotGas
        The gas.
    power : float
        Factor on the friction power, 1 but on the way to a solution.
    before : Temperatures or None
        Temperatures a time step ago; None for a steady state.
    step : float
        That time step [s].
    """

    heat: Heat
    gas: HotGas
    power: float = 1.0
    before: Temperatures | None = None
    step: float = math.inf

    @classmethod
    def of(cls, case: Case) -> HeatNetwork | None:
        """That of `case`; None where it has none."""
        return None if case.heat is None else cls(case.heat, case.heat.of_gas(case.gas))

    def after(self, before: Temperatures, step: float) -> HeatNetwork:
        """The balances at the end of an implicit time step [s]."""
        return replace(self, before=before, step=step)

    @property
    def ambient(self) -> float:
        """Temperature of the surroundings [K]."""
        return self.heat.ambient_temperature or self.gas.temperature

    @property
    def cold(self) -> Temperatures:
        """Temperatures of a bearing that has stood still."""
        return Temperatures.even(self.ambient)

    @property
    def start(self) -> Temperatures:
        """Temperatures when a warm-up begins: cold, but for a shaft that was told to be warm."""
        return self.cold._replace(shaft=self.heat.shaft_start_temperature or self.ambient)

    @cached_property
    def paths(self) -> tuple[Array, Array]:
        """What leaves the nodes by given paths and what is stored: `G T - sources`, (4, 4) [W/K] and (4,) [W]."""
        heat, G, sources = self.heat, np.zeros((NODES, NODES)), np.zeros(NODES)
        flow = heat.cooling_flow * self.gas.heat_capacity
        cooling = flow * -math.expm1(-heat.pack_to_cooling / flow) if flow > 0.0 else 0.0
        for node, conductance, there in (
            (SHAFT, heat.shaft_to_ambient, self.ambient),
            (SHAFT, heat.along_shaft, heat.shaft_end_temperature or self.ambient),
            (PACK, cooling, heat.cooling_temperature or self.ambient),
            (BUSHING, heat.bushing_to_ambient, self.ambient),
        ):
            G[node, node] += conductance
            sources[node] += conductance * there
        G[2:, 2:] += heat.pack_to_bushing * np.array([[1.0, -1.0], [-1.0, 1.0]])
        if self.before is not None:
            rate = np.array([0.0, heat.shaft_capacity, heat.pack_capacity, heat.bushing_capacity]) / self.step
            G += np.diag(rate)
            sources += rate * self.before.nodes
        return G, sources

    def residual(self, T: Temperatures, film: FilmHeat) -> Array:
        """The four balances (H3), what each node gains (4,) [W]."""
        G, sources = self.paths
        into = film.conductance * (EXCHANGE @ T.nodes)
        into[FILM_NODE] += film.viscous - film.carried * (T.film - self.gas.temperature)
        into[[SHAFT, PACK]] += 0.5 * film.rubbing
        gained: Array = into - G @ T.nodes + sources
        return gained

    def by_temperature(self, T: Temperatures, film: FilmHeat) -> Array:
        """Derivative of `residual` by the temperatures, pressures and film held, (4, 4) [W/K]."""
        G, _ = self.paths
        slope: Array = film.conductance * EXCHANGE - G
        by_viscosity = film.conductance * (EXCHANGE @ T.nodes)
        by_viscosity[FILM_NODE] += film.couette + film.carried * (T.film - self.gas.temperature)  # leakage goes as 1/mu
        slope[:, FILM_NODE] += by_viscosity * self.gas.exponent / T.film
        slope[FILM_NODE, FILM_NODE] -= film.carried * (1.0 - (T.film - self.gas.temperature) / T.film)
        return slope

    def outflow(self, T: Temperatures) -> float:
        """What leaves the shaft, the pack and the bushing by given paths, storage included [W]."""
        G, sources = self.paths
        return float(np.sum(G @ T.nodes - sources))


FILM_NODE, SHAFT, PACK, BUSHING = range(NODES)
"""Numbers of the nodes, in the order of `Temperatures`."""

EXCHANGE = np.array(
    [
        [-2.0 * FILM, OWN + OTHER, OWN + OTHER, 0.0],
        [FILM, -OWN, -OTHER, 0.0],
        [FILM, -OTHER, -OWN, 0.0],
        [0.0, 0.0, 0.0, 0.0],
    ]
)
"""What film, shaft and pack gain by conduction in the gas over its conductance, from the four temperatures (H2) [1]."""
