"""The inner loops in NumPy: the form to read. `numba_kernels.py` does the same, node by node."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.columns import Columns
from petalfoil.classic.film_cells import FilmCells
from petalfoil.classic.kernels import CHECK, REFRESH, Bands, Descent, March
from petalfoil.physics.reynolds import langevin

Array = NDArray[np.float64]

# ---------------------------------------------------------------------------------------------- film


def march(P: Array, cells: FilmCells, drive: March) -> tuple[int, float]:
    """March the pressures `P` (n_node,) explicitly in time until they change by less than the tolerance (58).

    Returns
    -------
    (int, float)
        Steps taken; largest change of a pressure at the present rate over the time that counts [1].
    """
    steps, change = 0, math.inf
    while steps < drive.max_steps and change > drive.tolerance:
        dt = drive.share / largest_rate(P, cells)  # (59)
        fit = exponential_fit(P, cells)
        for _ in range(REFRESH):
            rate = inflow(P, cells, fit) / cells.hold  # (58): right side over h
            P += dt * rate
            leak = content_defect(P, cells)
            P *= 1.0 - dt / drive.time * leak
        steps += REFRESH
        change = max(float(np.max(np.abs(rate))) * drive.time, abs(leak))
    return steps, change


def inflow(P: Array, cells: FilmCells, fit: Array) -> Array:
    """Net flow into every cell (55), zero at ambient nodes, (n_node,) [1]."""
    n, n_z = len(P), cells.n_z
    P0, P1 = P[: n - n_z], P[n_z:]  # the face ahead along the rotation (56)
    here = slice(0, n - n_z)
    m0, m1 = cells.carried[here] * P0, cells.carried_on[here] * P1
    poiseuille = -cells.along[here] * (0.5 * (P0 + P1) + cells.slip[here]) * (P1 - P0)
    couette = m0 + m1
    upwinding = -fit[here] * (m1 - m0)
    U_phi = poiseuille + couette + upwinding

    P0, P1, here = P[:-1], P[1:], slice(0, n - 1)  # the face ahead along the shaft (57)
    U_z = -cells.across[here] * (0.5 * (P0 + P1) + cells.slip_across[here]) * (P1 - P0)

    gained = np.zeros(n)
    gained[: n - n_z] -= U_phi
    gained[n_z:] += U_phi
    gained[:-1] -= U_z
    gained[1:] += U_z
    gained[cells.first] = gained[cells.last] = gained[cells.first] + gained[cells.last]
    return gained * cells.moves


def exponential_fit(P: Array, cells: FilmCells) -> Array:
    """`L(x)` of the faces ahead along the rotation (F2), (n_node,) [1]."""
    mean_P = 0.5 * (P + np.append(P[cells.n_z :], P[: cells.n_z]))
    return langevin(cells.peclet / (mean_P + cells.slip))[0]


def largest_rate(P: Array, cells: FilmCells) -> float:
    """Inverse of the largest stable time step: `max(2 p h^2 (1/dphi^2 + 1/dz^2) + Lam/dphi)` (59) [1].

    The paper's `(p h^2)max` is the largest of the product, over all cells, and advection adds its own bound.
    """
    n, n_z = len(P), cells.n_z
    ahead, beside = cells.along * (P + cells.slip), cells.across * (P + cells.slip_across)
    behind = cells.along[: n - n_z] * (P[n_z:] + cells.slip[: n - n_z])
    before = cells.across[:-1] * (P[1:] + cells.slip_across[:-1])
    total = ahead + beside + 2.0 * cells.carried
    total[n_z:] += behind
    total[1:] += before
    total[cells.first] = total[cells.last] = total[cells.first] + total[cells.last]
    return float(np.max(total / cells.hold * cells.moves))


def content_defect(P: Array, cells: FilmCells) -> float:
    """Share of its gas that a film without ends holds too much (F6); zero for a film with ends [1].

    Its balances add up to nothing, so a march in which all cells give way in proportion to this defect comes to rest
    only where the defect is zero.
    """
    if not len(cells.spread):
        return 0.0
    excess = np.sum(cells.spread * (P**2 - 1.0) + cells.spread_slip * (P - 1.0))
    slope = np.sum((2.0 * cells.spread * P + cells.spread_slip) * P)
    return float(excess / slope)


# ---------------------------------------------------------------------------------------------- package


def descend(W: Array, load: Array, shell: Bands, columns: Columns, drive: Descent) -> tuple[int, float]:
    """Descend the gradient of the package's energy from `W` (n,), projected onto its restrictions (45)-(50).

    Returns
    -------
    (int, float)
        Steps taken; largest force left on a node, over ambient pressure on it [1].
    """
    steps, left, theta = 0, math.inf, 1.0
    ahead = W.copy()
    while steps < drive.max_steps and left > drive.tolerance:
        for _ in range(CHECK):
            gradient = elastic_force(ahead, shell) - load  # (49), (50)
            last, trial = W.copy(), ahead - drive.step * gradient
            W[:] = project(trial, columns)  # (20)
            moved = W - ahead
            ahead = W.copy()
            if drive.momentum:
                theta, share = momentum(theta, float(np.dot(moved, W - last)))
                ahead = W + share * (W - last)
        steps += CHECK
        left = float(np.max(np.abs(moved))) / drive.step
    return steps, left


def elastic_force(W: Array, shell: Bands) -> Array:
    """Nodal forces `K W` of the petals' bending, (n,) [1]."""
    n = shell.values.shape[1]
    by_petal = W.reshape(-1, n)
    out = np.zeros_like(by_petal)
    for values, offset in zip(shell.values, shell.offset, strict=True):
        rows = slice(max(0, -offset), min(n, n - offset))
        out[:, rows] += values[rows] * by_petal[:, rows.start + offset : rows.stop + offset]
    return out.ravel()


def project(W: Array, columns: Columns) -> Array:
    """The nearest deflections to `W` (n,) that keep the restrictions (18)-(20), column by column.

    An ascending sequence nearest to `Z` is `max over a <= q of min over b >= q of mean(Z_a ... Z_b)`; bounds clip it.
    """
    Z = W[columns.node] + columns.shift
    count = len(Z)
    nearest = np.full_like(Z, -np.inf)
    for a in range(count):
        means = np.cumsum(Z[a:], axis=0) / np.arange(1, count - a + 1)[:, None]
        least_from = np.minimum.accumulate(means[::-1], axis=0)[::-1]  # over b >= q
        nearest[a:] = np.maximum(nearest[a:], least_from)
    kept = np.minimum(np.maximum(nearest, columns.low), columns.high)
    inside = columns.node >= 0
    out = W.copy()
    out[columns.node[inside]] = (kept - np.where(inside, columns.shift, 0.0))[inside]
    return out


def momentum(theta: float, against: float) -> tuple[float, float]:
    """Next `theta` and share of the last step to go ahead by; from anew where the step went against the force."""
    if against < 0.0:
        theta = 1.0
    larger = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * theta * theta))
    return larger, (theta - 1.0) / larger
