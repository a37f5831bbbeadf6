"""How a quantity follows a parameter when it keeps a result at a limit: lift-off speed, load capacity.

Where a contact opens or closes at that very state, the result has another derivative in every direction of the plane of
quantity and parameter. On either side of the parameter the quantity then moves by the rate along which the result stays
at its limit.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from petalfoil.analysis.adjoint import AdjointDerivatives
from petalfoil.analysis.crossings import PRECISION
from petalfoil.analysis.derivatives import ByParameters, Derivative, Results
from petalfoil.analysis.heated_derivatives import Derivatives
from petalfoil.analysis.varied_case import VariedCase
from petalfoil.case.parameters import parameter_of
from petalfoil.equilibrium.run_context import current_run
from petalfoil.errors import ConvergenceError

SPEED = "operation.speed"

NEWTON_STEPS = 8
"""Newton steps to a crossing: from a bracket of 0.1 % two or three reach it."""

PRECISE = 1e-8
"""Relative change of the speed at which they end; a balance determines it to some 1e-9."""

RATE = 1e-9
"""Relative precision of the rate of the quantity at a kink."""

SECANTS = 40
"""Steps to it: the result's derivative is linear in it but for one bend."""


@dataclass(frozen=True, eq=False)
class AlongWith(VariedCase):
    """A case at several values of a parameter, others changing in proportion.

    Attributes
    ----------
    rates_of_others : mapping
        Change of the others by path, over that of the parameter.
    """

    rates_of_others: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, variation: VariedCase, others: Mapping[str, float]) -> AlongWith:
        """A variation, and the rates of the others."""
        v = variation
        return cls(v.case, v.parameter, v.own, v.film, v.fineness, rates_of_others=others)

    def values_at(self, change: float) -> dict[str, float]:
        """Values of the parameter and of the others."""
        values = super().values_at(change)
        for path, rate in self.rates_of_others.items():
            own = values.get(path, float(parameter_of(self.case, path).value or 0.0))
            values[path] = own + rate * change
        return values


@dataclass(frozen=True, eq=False)
class CrossingDerivatives(ByParameters):
    """Derivatives of a quantity that keeps a result at its limit.

    Attributes
    ----------
    name : str
        Name of the quantity in results.
    value : float
        The quantity [SI].
    balance : DerivativesOf, HeatedDerivatives or AdjointDerivatives
        Derivatives at the equilibrium there.
    limited : str
        The result that is at its limit.
    paths : mapping
        Parameters that change with the quantity, and by how much.
    by_quantity : Derivative
        Derivatives by the quantity.
    """

    name: str
    value: float
    balance: Derivatives | AdjointDerivatives
    limited: str
    paths: Mapping[str, float]
    by_quantity: Derivative

    @property
    def values(self) -> Results:
        """The quantity [SI]."""
        return {self.name: self.value}

    @property
    def residual(self) -> float:
        """Residual of the equilibrium."""
        return self.balance.residual

    def variation(self, path: str) -> VariedCase:
        """The case at values of the parameter `path`; see `DerivativesOf.variation`."""
        return self.balance.variation(path)

    def along(self, variation: VariedCase) -> Derivative:
        """Derivative of the quantity along a variation of the case.

        Raises
        ------
        ConvergenceError
            There is none.
        """
        found = self.balance.along(variation)
        if not (found.at_kink or self.by_quantity.at_kink):
            rate = {self.name: -found.above[self.limited] / self.by_quantity.above[self.limited]}
            return replace(found, below=rate, above=rate)
        below, above = ({self.name: self._on_side(variation, found, side)} for side in ("below", "above"))
        return replace(found, below=below, above=above, at_kink=True)

    def _on_side(self, variation: VariedCase, found: Derivative, side: str) -> float:
        """Rate of the quantity along which the result stays at its limit, on one side of the parameter."""
        from scipy.optimize import root_scalar  # 0.2 s: only where it is needed

        sides, q = (self.by_quantity.above, self.by_quantity.below), self.limited
        first, other = (-getattr(found, side)[q] / by[q] for by in sides)

        def change(rate: float) -> float:
            others = {path: rate * part for path, part in self.paths.items()}
            return float(getattr(self.balance.along(AlongWith.of(variation, others)), side)[q])

        apart = 1e-3 * max(abs(first), abs(other)) or 1.0
        second = other if abs(other - first) > apart else first + apart
        root = root_scalar(change, method="secant", x0=first, x1=second, rtol=RATE, maxiter=SECANTS)
        if not root.converged:
            raise ConvergenceError(
                f"no derivative of {self.name} by {variation.parameter.path}: several contacts open or close at this "
                "very state",
                advice="change the case or the limit by a millionth",
            )
        return float(root.root)


def newton_to(
    name: str, limited: tuple[str, float], speed: float, balance_at: Callable[[float], Derivatives]
) -> CrossingDerivatives | None:
    """Derivatives of the speed `name` [rad/s] at which a result has its limit, by Newton's method from a near `speed`.

    `limited` is that result and its limit, `balance_at` gives its derivatives over speed. None where it does not pass
    through the limit smoothly near by.
    """
    result, limit = limited
    for _ in range(NEWTON_STEPS):
        balance = balance_at(speed)
        by_speed, value = balance.by(SPEED), balance.values[result]
        slope = (by_speed.above if value > limit else by_speed.below)[result]
        change = math.nan if slope == 0.0 else (limit - value) / slope
        current_run().note("crossing", speed=speed, value=value, limit=limit)
        if abs(change) <= PRECISE * speed:
            return CrossingDerivatives(name, speed, balance, result, {SPEED: 1.0}, by_speed)
        if not abs(change) <= 10.0 * PRECISION * speed:
            return None
        speed += change
    return None
