"""Every number of the paper's method, with its reason."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ClassicOptions:
    """Numbers of the method.

    The first four are the paper's; it gives no values for the relaxation.
    """

    epsilon: float = 1e-5
    """Relative change of pressure and film from one outer iteration to the next at which it ends (60)."""
    pressure_share: float = 1.0
    """`a`, share of the new pressure (60); with relaxed deflections the whole of it serves."""
    deflection_share: float = 0.1
    """`alpha`, share of the new deflections (61): a thin film is some hundred times stiffer than a petal."""
    time_share: float = 0.95
    """Share of the largest stable time step (59)."""

    descent_share: float = 1.9
    """Gradient step over the inverse bound of the stiffness; below 2 each step lowers the energy."""
    momentum: bool = False
    """Accelerate the descent (Nesterov 1983, restarted by O'Donoghue and Candes 2015). Not in the paper."""

    patience: float = 10.0
    """`alpha` is halved after `patience / alpha` outer iterations without a smaller change: film and package take turns
    then."""
    inner_share: float = 0.01
    """Film and package are settled to this share of the last outer change: closer would be wasted."""
    loosest: float = 1e-2
    """At least to this."""

    max_outer: int = 5000
    max_film_steps: int = 10**8
    max_package_steps: int = 10**8
    """Steps of a run; the paper states none. 1e8 take a quarter of an hour on 32 cells a pitch, flat."""

    def inner(self, change: float) -> float:
        """Tolerance of film and package after an outer change of `change` [1]."""
        return min(self.loosest, self.inner_share * max(change, self.epsilon))
