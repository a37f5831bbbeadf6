"""The foil pack alone, from nothing: a convex programme with one solution, whatever the start."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.contact_equations import ContactOptions
from petalfoil.solvers.contact_newton import ActiveContacts, solve_contacts
from petalfoil.solvers.interior_point import InteriorOptions, InteriorStep, contact_set, interior_point
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackProblem

Array = NDArray[np.float64]

FIRST_PRODUCT = 100.0
"""First reactions times slacks over the deepest penetration of the free shape. 100 to 1000 serve alike; 10 and less
stay short of the boundary for long (up to 58 steps where 20 serve)."""

CONVEX = InteriorOptions(near=np.inf, calm=np.inf, boundary=0.995, correctors=5)
"""The pack alone is convex: Mehrotra's steps serve from the start, close to the boundary."""

SEARCHING = ContactOptions(patience=0)
"""Its active contacts are searched for at once: changing all of them saves nothing here."""

REST_GOALS = (1e-6, 1e-9, 1e-12, 1e-15)
"""Barriers at which the active contacts of the pack alone are read and tried. The last is for contacts that hardly
carry: of hinged petals that overlap by a third of a cell, reactions and gaps are told apart there only."""


def unloaded(problem: CoupledProblem, withdrawn: float = 0.0, *, still: bool = False) -> FoilPackProblem:
    """The pack without film pressure, round a journal that is `withdrawn` reference lengths thinner than its own.

    The journal is about to turn, or it is `still`: that makes a difference where it drags petals along.
    """
    return FoilPackProblem(problem, np.zeros(problem.layout.n_wall), withdrawn, still)


def free_start(pack: FoilPackProblem) -> PrimalDualPoint:
    """A start from the free shape: slacks as wide as it penetrates, reactions to match."""
    x = np.zeros(pack.layout.n_wall)
    gaps = pack.gaps(x)
    depth = max(1.0, -float(np.min(gaps, initial=0.0)))
    s = np.maximum(gaps, depth)
    return PrimalDualPoint(x, s, FIRST_PRODUCT * depth * pack.weight / s)


def assembled(problem: CoupledProblem, barrier: float) -> PrimalDualPoint:
    """The assembled pack on its central path at `barrier`, extended by ambient pressures: a start for the film."""
    if not problem.layout.n_wall:
        pack = unloaded(problem)
        s = pack.gaps(np.zeros(0))
        return PrimalDualPoint(problem.layout.ambient(np.zeros(0)), s, barrier * pack.weight / s)
    return with_ambient(problem, central_point(problem, barrier))


def with_ambient(problem: CoupledProblem, point: PrimalDualPoint) -> PrimalDualPoint:
    """A point of the pack alone, extended by ambient pressures."""
    return replace(point, x=problem.layout.ambient(point.x))


def central_point(problem: CoupledProblem, barrier: float, start: PrimalDualPoint | None = None) -> PrimalDualPoint:
    """The assembled pack on its central path at `barrier`, from a point with a larger one or from the free shape."""
    pack, options = unloaded(problem), replace(CONVEX, least_barrier=barrier)

    def finished(step: InteriorStep) -> bool:
        return step.barrier < 2.0 * barrier and step.infeasibility < 1e-3 and step.residual < 1e-2

    watch = current_run().watch("pack", finished)
    point, _ = interior_point(pack, start or free_start(pack), current_run().pack_solver, options, watch)
    return point


def at_rest(problem: CoupledProblem, withdrawn: float = 0.0, *, still: bool = False) -> ActiveContacts | None:
    """Deflections and active contacts of the assembled pack; None if not found."""
    return resting(unloaded(problem, withdrawn, still=still))


def resting(pack: FoilPackProblem) -> ActiveContacts | None:
    """Deflections and active contacts of a pack under its load; None if not found."""
    start = free_start(pack)
    for goal in REST_GOALS:
        watch = current_run().watch("pack", settled(goal))
        start, found = interior_point(pack, start, current_run().pack_solver, CONVEX, watch)
        if not found:
            return None
        x, touching = contact_set(pack, start, current_run().pack_solver)
        contacts, outcome = solve_contacts(pack, (x, touching), current_run().pack_solver, SEARCHING)
        current_run().note("pack contacts", outcome=outcome.value)
        if contacts is not None:
            return contacts
    return None


def settled(goal: float) -> Callable[[InteriorStep], bool]:
    """A stopping criterion: the barrier `goal`, equations and gaps met well enough to read the active contacts."""
    return lambda step: step.barrier < goal and max(step.residual, step.infeasibility) < 1e-4
