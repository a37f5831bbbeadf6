"""All parameters of the paper's method, with their reasons."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ClassicOptions:
    """Parameters of the method.

    The first four are the paper's. It states no values for the relaxation factors.
    """

    epsilon: float = 1e-5
    """The run ends when pressure and film change by less than this between outer iterations, relative (60)."""
    pressure_relaxation: float = 1.0
    """Relaxation factor `a` of the pressure (60). With relaxed deflections the pressure needs no relaxation."""
    deflection_relaxation: float = 0.1
    """Relaxation factor `alpha` of the deflections (61). A thin film is some hundred times stiffer than a petal."""
    time_step_fraction: float = 0.95
    """Time step over the largest stable one (59)."""

    descent_step_fraction: float = 1.9
    """Gradient step over the inverse bound of the stiffness. Every step below 2 lowers the energy."""
    momentum: bool = False
    """Accelerate the descent (Nesterov 1983, restarted by O'Donoghue and Candes 2015). Not in the paper."""

    patience: float = 10.0
    """`alpha` is halved after `patience / alpha` outer iterations without a smaller change: film and pack then
    oscillate against each other."""
    inner_tolerance_fraction: float = 0.01
    """Tolerance of film and pack over the last outer change. A tighter tolerance would be lost in the next change."""
    loosest_inner_tolerance: float = 1e-2
    """Upper limit of that tolerance."""

    max_outer: int = 5000
    max_film_steps: int = 10**8
    max_pack_steps: int = 10**8
    """Limits of a run; the paper states none. 1e8 steps take 15 minutes with 32 cells per pitch in 2-D."""

    def inner(self, change: float) -> float:
        """Tolerance of film and pack after an outer change of `change` [1]."""
        return min(self.loosest_inner_tolerance, self.inner_tolerance_fraction * max(change, self.epsilon))
