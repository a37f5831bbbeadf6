"""Quadrature weights on arbitrary nodes."""

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
    """Weights that integrate, in each cell, the cubic through the nearest four `nodes`; shape (n,).

    With fewer than four nodes the polynomial goes through all of them.
    """
    count, cell = min(4, len(nodes)), np.diff(nodes)
    order = np.arange(count)
    near = np.clip(np.arange(len(cell)) - 1, 0, len(nodes) - count)[:, None] + order
    # in the coordinate s of a cell, 0 <= s <= 1: the weights integrate 1, s, s^2, s^3 exactly
    s = (nodes[near] - nodes[:-1, None]) / cell[:, None]
    moments, exact = s[:, None, :] ** order[:, None], np.broadcast_to(1.0 / (1.0 + order), s.shape)
    weight = np.zeros(len(nodes))
    np.add.at(weight, near, cell[:, None] * np.linalg.solve(moments, exact[..., None])[..., 0])
    return weight


def accumulated(values: NDArray[np.float64], nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integral of values (n,) from the first node to each of the `nodes` by the trapezoidal rule, (n,)."""
    return np.concatenate([[0.0], np.cumsum(np.diff(nodes) * (values[1:] + values[:-1]) / 2.0)])
