"""Balances of a solution, computed from its state alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.solution import Solution
from petalfoil.physics.reynolds import Flux

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
    layout = answer.problem.layout
    w, P = answer.deflection, answer.x[answer.problem.positive]
    wall, unit = layout.wall, layout.scales.length / layout.scales.force
    loads = layout.push @ (P - 1.0) + wall.contacts.G.T @ answer.lam
    parts = layout.push @ np.abs(P - 1.0) + abs(wall.contacts.G.T) @ answer.lam
    error = wall.free_motions.T @ loads + unit * (wall.support @ w + wall.support @ answer.state.low_order)
    scale = abs(wall.free_motions.T) @ parts
    return float(np.max(np.abs(error) / np.maximum(scale, np.finfo(float).tiny), initial=0.0))
