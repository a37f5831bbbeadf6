"""The inner loops in NumPy, to be read. `compiled_kernels.py` does the same node by node."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.columns import ContactColumns
from petalfoil.classic.film_cells import FilmCells
from petalfoil.classic.kernels import CHECK, REFRESH, Bands, DescentSettings, MarchSettings
from petalfoil.physics.reynolds import langevin

Array = NDArray[np.float64]

# ---------------------------------------------------------------------------------------------- film


@np.errstate(over="ignore", invalid="ignore")  # a march that diverges is told by its change, as in the compiled loop
def march(P: Array, cells: FilmCells, settings: MarchSettings) -> tuple[int, float]:
    """March the pressures `P` (n_node,) explicitly in time until they change by less than the tolerance (58).

    Returns
    -------
    (int, float)
        Steps taken; largest change of a pressure at its present rate in the time `settings.time` [1].
    """
    steps, change = 0, math.inf
    while steps < settings.max_steps and change > settings.tolerance:
        dt = settings.fraction / largest_rate(P, cells)  # (59)
        fit = exponential_fit(P, cells)
        for _ in range(REFRESH):
            rate = inflow(P, cells, fit) / cells.capacity  # (58): right side over h
            P += dt * rate
            excess = gas_inventory_error(P, cells)
            P *= 1.0 - dt / settings.time * excess
        steps += REFRESH
        change = max(float(np.max(np.abs(rate))) * settings.time, abs(excess))
    return steps, change


def inflow(P: Array, cells: FilmCells, fit: Array) -> Array:
    """Net flow into every cell (55), zero at ambient nodes, (n_node,) [1]."""
    n, n_z = len(P), cells.n_z
    P0, P1 = P[: n - n_z], P[n_z:]  # circumferential faces (56)
    here = slice(0, n - n_z)
    m0, m1 = cells.advection[here] * P0, cells.advection_ahead[here] * P1
    poiseuille = -cells.along[here] * (0.5 * (P0 + P1) + cells.slip[here]) * (P1 - P0)
    couette = m0 + m1
    upwinding = -fit[here] * (m1 - m0)
    U_phi = poiseuille + couette + upwinding

    P0, P1, here = P[:-1], P[1:], slice(0, n - 1)  # axial faces (57)
    U_z = -cells.across[here] * (0.5 * (P0 + P1) + cells.slip_across[here]) * (P1 - P0)

    gained = np.zeros(n)
    gained[: n - n_z] -= U_phi
    gained[n_z:] += U_phi
    gained[:-1] -= U_z
    gained[1:] += U_z
    gained[cells.first] = gained[cells.last] = gained[cells.first] + gained[cells.last]
    return gained * cells.is_unknown


def exponential_fit(P: Array, cells: FilmCells) -> Array:
    """`L(x)` of the circumferential faces after every node (F2), (n_node,) [1]."""
    mean_P = 0.5 * (P + np.append(P[cells.n_z :], P[: cells.n_z]))
    return langevin(cells.peclet / (mean_P + cells.slip))


def largest_rate(P: Array, cells: FilmCells) -> float:
    """Inverse of the largest stable time step: `max(2 p h^2 (1/dphi^2 + 1/dz^2) + Lam/dphi)` (59) [1].

    The maximum is over all cells. Advection adds `Lam/dphi` to the bound of the paper, which has `(p h^2)max` only.
    """
    n, n_z = len(P), cells.n_z
    ahead, beside = cells.along * (P + cells.slip), cells.across * (P + cells.slip_across)
    behind = cells.along[: n - n_z] * (P[n_z:] + cells.slip[: n - n_z])
    before = cells.across[:-1] * (P[1:] + cells.slip_across[:-1])
    total = ahead + beside + 2.0 * cells.advection
    total[n_z:] += behind
    total[1:] += before
    total[cells.first] = total[cells.last] = total[cells.first] + total[cells.last]
    return float(np.max(total / cells.capacity * cells.is_unknown))


def gas_inventory_error(P: Array, cells: FilmCells) -> float:
    """Relative excess of the gas inventory of a film without ambient nodes (F6); zero for any other film [1].

    The mass balances of such a film add up to zero. A march that lowers all pressures in proportion to this excess can
    only become steady where the excess is zero.
    """
    if not len(cells.inventory):
        return 0.0
    excess = np.sum(cells.inventory * (P**2 - 1.0) + cells.inventory_slip * (P - 1.0))
    slope = np.sum((2.0 * cells.inventory * P + cells.inventory_slip) * P)
    return float(excess / slope)


# ---------------------------------------------------------------------------------------------- pack


def descend(
    W: Array, load: Array, shell: Bands, columns: ContactColumns, settings: DescentSettings
) -> tuple[int, float]:
    """Descend the gradient of the energy of the pack from `W` (n,), projected onto the constraints (45)-(50).

    Returns
    -------
    (int, float)
        Steps taken; largest remaining nodal force over that of ambient pressure [1].
    """
    steps, left, theta = 0, math.inf, 1.0
    ahead = W.copy()
    while steps < settings.max_steps and left > settings.tolerance:
        for _ in range(CHECK):
            gradient = elastic_force(ahead, shell) - load  # (49), (50)
            last, trial = W.copy(), ahead - settings.step * gradient
            W[:] = project(trial, columns)  # (20)
            moved = W - ahead
            ahead = W.copy()
            if settings.momentum:
                theta, factor = momentum(theta, float(np.dot(moved, W - last)))
                ahead = W + factor * (W - last)
        steps += CHECK
        left = float(np.max(np.abs(moved))) / settings.step
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


def project(W: Array, columns: ContactColumns) -> Array:
    """The nearest deflections to `W` (n,) that satisfy the constraints (18)-(20), column by column.

    The ascending sequence nearest to `Z` is `max over a <= q of min over b >= q of mean(Z_a ... Z_b)` (isotonic
    regression). The bounds then clip it.
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
    """Next `theta` and momentum factor; both restart where the last step went against the force."""
    if against < 0.0:
        theta = 1.0
    larger = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * theta * theta))
    return larger, (theta - 1.0) / larger
