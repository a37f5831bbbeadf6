"""Weights that turn values at nodes into integrals over them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def trapezoid(nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights of the trapezoidal rule on `nodes`, shape (n,)."""
    weight = np.zeros(len(nodes))
    cell = np.diff(nodes)
    weight[:-1] += 0.5 * cell
    weight[1:] += 0.5 * cell
    return weight


def cubic_weights(nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights that integrate, cell by cell, the polynomial through the nearest four of `nodes` (or all, if fewer)."""
    count, cell = min(4, len(nodes)), np.diff(nodes)
    order = np.arange(count)
    near = np.clip(np.arange(len(cell)) - 1, 0, len(nodes) - count)[:, None] + order
    share = (nodes[near] - nodes[:-1, None]) / cell[:, None]
    moments, exact = share[:, None, :] ** order[:, None], np.broadcast_to(1.0 / (1.0 + order), share.shape)
    weight = np.zeros(len(nodes))
    np.add.at(weight, near, cell[:, None] * np.linalg.solve(moments, exact[..., None])[..., 0])
    return weight
