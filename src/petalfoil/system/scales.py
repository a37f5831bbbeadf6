"""Units of the unknowns, chosen once for a case so that numbers near 1 mean what matters."""

from __future__ import annotations

from dataclasses import dataclass

from petalfoil.case import Case
from petalfoil.walls.base import Wall


@dataclass(frozen=True)
class Scales:
    """Reference length `h_ref` [m], pressure `p_a` [Pa], nodal force `p_a` times a node's area [N]."""

    length: float
    pressure: float
    force: float

    def bearing_number(self, viscosity: float, speed: float, radius: float) -> float:
        """`Lam = 6 mu omega R_j^2 / (p_a h_ref^2)` [1]."""
        return 6.0 * viscosity * speed * radius**2 / (self.pressure * self.length**2)


def scales_of(case: Case, wall: Wall) -> Scales:
    """Units for `case` on its wall."""
    pressure = case.gas.ambient_pressure
    return Scales(wall.reference_film, pressure, pressure * wall.node_area)
