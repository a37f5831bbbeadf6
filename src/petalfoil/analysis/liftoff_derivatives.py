"""Exact derivatives of the lift-off and the touchdown speed by the parameters of a case.

The speed `omega` is where the contact fraction of the loaded journal has its limit, `s(omega, p) = s*`. Hence

    d omega / dp = -(ds/dp) / (ds/d omega)                                                             (V4)

with both derivatives at the balance under the load at that speed, which is refined first: the search for it ends in a
bracket of 0.1 %.
"""

from __future__ import annotations

import math
from dataclasses import replace

from petalfoil.analysis.crossing_derivatives import SPEED, CrossingDerivatives, newton_to
from petalfoil.analysis.crossings import crossings
from petalfoil.analysis.derivatives import Results
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.heated_derivatives import Derivatives, derivatives_of
from petalfoil.analysis.operating_point import at
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case import Case
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError

FRACTION = "contact_fraction"


def speed_derivatives(case: Case, load: float, limit: float, *, as_points: bool = False) -> list[CrossingDerivatives]:
    """Derivatives of lift-off and touchdown speed of a load [N] along -y, as far as these speeds are finite.

    `as_points` as in `DerivativesOf`.

    Raises
    ------
    ConvergenceError
        A balance was not found, the journal never lifts off or never touches, or the contact fraction jumps.
    """
    loaded = case.replace(**{"operation.load": (0.0, -load), "operation.eccentricity": (0.0, 0.0)})
    both = crossings(SpeedLine(loaded, (0.0, -load)), limit)
    speeds = dict(zip(("liftoff_speed", "touchdown_speed"), both, strict=True))
    found = [
        of_contacts(
            refined(name, SpeedLine(loaded, (0.0, -load), leads=False), (speed, limit), as_points), as_points=as_points
        )
        for name, speed in speeds.items()
        if 0.0 < speed < math.inf
    ]
    if not found:
        raise ConvergenceError(
            "no derivative: the journal never lifts off, or never touches, at any speed under this load",
            advice="ask `liftoff` for the speeds of other loads",
        )
    return found


def refined(name: str, line: SpeedLine, where: tuple[float, float], as_points: bool) -> CrossingDerivatives:
    """Derivatives at the crossing of a limit near a speed, `where` both, found by Newton's method.

    Where contact points travel on petals with continuous slopes their derivatives are exact, and lead there; else those
    of contacts at nodes do.
    """
    speed, limit = where

    def balance_at(omega: float) -> Derivatives:
        found = replace(line.at(omega), lines=None)  # in 3-D derivatives are those of contacts at nodes
        exact = as_points and found.elements is not None
        return derivatives_of(at(line.case, omega), found, fraction_of, as_points=exact)

    found = newton_to(name, (FRACTION, limit), speed, balance_at)
    if found is not None:
        return found
    raise ConvergenceError(
        f"no derivative of the {name.replace('_', ' ')}: the contact fraction does not pass through {limit:g} smoothly "
        f"near {speed:.6g} rad/s",
        advice="another contact fraction, or a finer grid, moves the crossing off the kink",
    )


def of_contacts(found: CrossingDerivatives, *, as_points: bool) -> CrossingDerivatives:
    """The derivatives with contacts as points, or at nodes as they are."""
    if not as_points or found.balance.as_points:
        return found
    balance = derivatives_of(found.balance.case, found.balance.solution, fraction_of, as_points=True)
    return replace(found, balance=balance, by_quantity=balance.by(SPEED))


def fraction_of(case: Case, solution: Solution) -> Results:
    """The contact fraction of a balance."""
    return {FRACTION: Evaluation.of(case, solution).contact_fraction}
