"""Exact derivatives of the load capacity by the parameters of a case.

The load capacity `W` is where a result of the loaded journal has its limit, `q(W, p) = q*`, with the load in a fixed
direction. Hence

    dW/dp = -(dq/dp) / (dq/dW)                                                                         (V8)

with both derivatives at the balance under that load.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from petalfoil.analysis.capacity import FIRST
from petalfoil.analysis.derivatives import Derivative, Results, equilibrium_results
from petalfoil.analysis.heated_derivatives import Derivatives, derivatives_of
from petalfoil.analysis.load_limit import Limits, LoadRay, largest_load
from petalfoil.analysis.variation import Variation
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError

NAME = "load_capacity"


@dataclass(frozen=True, eq=False)
class CapacityDerivatives:
    """Derivatives of the load capacity.

    Attributes
    ----------
    size : float
        The load capacity [N].
    balance : DerivativesOf or HeatedDerivatives
        Derivatives at the balance under it.
    limited : str
        The result that is at its limit.
    by_load : Derivative
        Derivatives of the results along the load, toward less and toward more of it.
    """

    size: float
    balance: Derivatives
    limited: str
    by_load: Derivative

    @property
    def values(self) -> Results:
        """The load capacity [N]."""
        return {NAME: self.size}

    @property
    def residual(self) -> float:
        """Residual of the balance."""
        return self.balance.residual

    def variation(self, path: str) -> Variation:
        """The case at values of the parameter `path`; see `DerivativesOf.variation`."""
        return self.balance.variation(path)

    def along(self, variation: Variation) -> Derivative:
        """Derivative of the load capacity along a variation of the case.

        Raises
        ------
        ConvergenceError
            There is none.
        """
        found = self.balance.along(variation)
        if found.at_kink:
            raise at_kink(variation.parameter.path)
        rate = {NAME: -found.above[self.limited] / self.by_load.above[self.limited]}
        return replace(found, below=rate, above=rate)


def capacity_derivatives(
    case: Case, limits: Limits, direction: tuple[float, float], *, as_points: bool = False
) -> list[CapacityDerivatives]:
    """Derivatives of the load capacity in a direction (unit vector) within limits; `as_points` as in `DerivativesOf`.

    Raises
    ------
    ConvergenceError
        No load keeps to the limits, or none of them bounds it smoothly.
    """
    ray = LoadRay(case.replace(**{"operation.eccentricity": (0.0, 0.0)}), direction, limits)
    found = largest_load(ray, FIRST * ray.unit)
    if found.at is None or found.status != "converged":
        raise ConvergenceError(
            f"no derivative of the load capacity: {found.status}",
            advice="ask `capacity` what bounds the load, and for limits that a smaller load reaches",
        )
    size = found.at.size
    load = (size * direction[0], size * direction[1])
    loaded = case.replace(**{"operation.load": load, "operation.eccentricity": (0.0, 0.0)})
    balance = derivatives_of(loaded, found.at.found.answer, equilibrium_results, as_points=as_points)
    by_load = along_direction(balance, direction, found.at.limit)
    return [CapacityDerivatives(size, balance, found.at.limit, by_load)]


def along_direction(balance: Derivatives, direction: tuple[float, float], limited: str) -> Derivative:
    """Derivative of the limited result by the size of a load in a direction."""
    parts = [(part, balance.by(f"operation.load.{axis}")) for axis, part in zip("xy", direction, strict=True) if part]
    if any(found.at_kink for _, found in parts):
        raise at_kink("the load")
    slope = {limited: sum(part * found.above[limited] for part, found in parts)}
    return replace(parts[0][1], below=slope, above=slope)


def at_kink(path: str) -> ConvergenceError:
    """The error of a limit that is reached where a contact opens or closes."""
    return ConvergenceError(
        f"no derivative of the load capacity by {path}: a contact opens or closes at this very load",
        advice="change the limit by a millionth",
    )
