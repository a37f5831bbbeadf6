"""Balances of a solution, computed from its state alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.rubbing_lines import RubbingLines
from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.reynolds import Flux
from petalfoil.system.friction import friction_of
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]
Fluxes = tuple[Flux, Flux]


def mass_balance(answer: Solution, fluxes: Fluxes) -> float:
    """Largest mass-balance error of a strip over the flow that passes through it [1].

    Inflow over the leading edge, outflow over the trailing edge and leakage at the sides are the balances of the
    cells at the strip's border; they must add up to nothing.
    """
    balance = answer.problem.layout.balance
    gained = balance.outflow(fluxes)
    inside = balance.mesh.unknown >= 0
    inside[:, [0, -1]] = False  # a shared edge belongs to two strips
    stored = np.where(inside, gained, 0.0).sum(axis=(1, 2))
    passing = np.abs(fluxes[0].scale[:, [0, -1]]).sum(axis=(1, 2)) + np.abs(fluxes[1].scale[..., :1]).sum(axis=(1, 2))
    return float(np.max(np.abs(stored) / passing))


def reaction_balance(answer: Solution) -> float:
    """Largest error of a petal's loads against its support, in motions that bend nothing (S4), over the loads [1]."""
    if answer.elements is not None:
        return balance_on_elements(answer.elements)
    if answer.friction is not None:
        return balance_with_friction(answer)
    layout, lines = answer.problem.layout, answer.lines
    x, lam, rest = (answer.x, answer.lam, answer.state.low_order) if lines is None else (lines.x, lines.lam, 0.0)
    w, P = x[layout.unknowns[DEFLECTION]], x[answer.problem.positive]
    wall, unit = layout.wall, layout.scales.length / layout.scales.force
    H = answer.problem.wall_acting
    loads = layout.push @ (P - 1.0) + H.T @ lam
    parts = layout.push @ np.abs(P - 1.0) + abs(H.T) @ np.abs(lam)
    error = wall.free_motions.T @ loads + unit * (wall.support @ w + wall.support @ (rest + np.zeros_like(w)))
    return largest(error, abs(wall.free_motions.T) @ parts)


def balance_with_friction(answer: Solution) -> float:
    """The same where friction forces load the petals, and their membranes carry some of it [1]."""
    problem, friction = answer.problem, friction_of(answer.case, answer.problem.layout)
    if answer.friction is None or friction is None:
        raise ValueError("an equilibrium without friction forces")
    wall, layout, x, lam = problem.layout.wall, problem.layout, answer.x, answer.lam
    B, rubbing = friction.slip, answer.friction.state.force
    if isinstance(answer.lines, RubbingLines):
        x, lam = answer.lines.x, answer.lines.lam
        B, rubbing = answer.lines.law.slip, answer.lines.friction_force.ravel()
    w, P, H = x[layout.unknowns[DEFLECTION]], x[problem.positive], problem.wall_acting
    loads = layout.push @ (P - 1.0) + H.T @ lam - B.T @ rubbing - layout.elastic_force(w)
    parts = layout.push @ np.abs(P - 1.0) + abs(H.T) @ np.abs(lam) + abs(B.T) @ np.abs(rubbing)
    return largest(wall.free_motions.T @ loads, abs(wall.free_motions.T) @ parts)


def balance_on_elements(found: ElementEquilibrium) -> float:
    """The same of petals with continuous slopes: the work of pressure, reactions and bending in these motions [1]."""
    motions = found.pack.free_motions
    elastic, loads, size = found.equations.wall_forces
    return largest(motions.T @ (loads - elastic), np.abs(motions.T) @ size)


def largest(error: Array, scale: Array) -> float:
    """Largest error over its scale."""
    return float(np.max(np.abs(error) / np.maximum(scale, np.finfo(float).tiny), initial=0.0))
