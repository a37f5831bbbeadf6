"""Exact derivatives of the load capacity by the parameters of a case.

The load capacity `W` is where a result of the loaded journal has its limit, `q(W, p) = q*`, with the load in a fixed
direction. Hence

    dW/dp = -(dq/dp) / (dq/dW)                                                                         (V8)

with both derivatives at the balance under that load.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from petalfoil.analysis.capacity_search import FIRST
from petalfoil.analysis.crossing_derivatives import AlongWith, CrossingDerivatives
from petalfoil.analysis.derivatives import Derivative, equilibrium_results
from petalfoil.analysis.heated_derivatives import Derivatives, derivatives_of
from petalfoil.analysis.load_limit import largest_load
from petalfoil.analysis.load_ray import Limits, LoadRay
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError

NAME = "load_capacity"


def capacity_derivatives(
    case: Case, limits: Limits, direction: tuple[float, float], *, as_points: bool = False
) -> list[CrossingDerivatives]:
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
            advice="run `capacity` to see what bounds the load, and give limits that a smaller load reaches",
        )
    size = found.at.size
    load = (size * direction[0], size * direction[1])
    loaded = case.replace(**{"operation.load": load, "operation.eccentricity": (0.0, 0.0)})
    balance = derivatives_of(loaded, found.at.found.answer, equilibrium_results, as_points=as_points)
    paths = {f"operation.load.{axis}": part for axis, part in zip("xy", direction, strict=True)}
    by_load = along_load(balance, paths)
    return [CrossingDerivatives(NAME, size, balance, found.at.limit, paths, by_load)]


def along_load(balance: Derivatives, paths: Mapping[str, float]) -> Derivative:
    """Derivatives by the size of a load whose direction stays: `paths` are its components over the size."""
    path = max(paths, key=lambda one: abs(paths[one]))
    part = paths[path]
    others = {other: share / part for other, share in paths.items() if other != path and share}
    found = balance.along(AlongWith.of(balance.variation(path), others))
    below, above = ({name: part * value for name, value in side.items()} for side in (found.below, found.above))
    return replace(found, below=below, above=above) if part > 0.0 else replace(found, below=above, above=below)
