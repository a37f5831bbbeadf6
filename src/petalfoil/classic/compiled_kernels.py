"""The inner loops node by node, compiled by numba. They give the numbers of `numpy_kernels.py`, many times faster."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from petalfoil.classic.columns import ContactColumns
from petalfoil.classic.film_cells import FilmCells
from petalfoil.classic.kernels import CHECK, REFRESH, Bands, DescentSettings, MarchSettings
from petalfoil.compiled import compiled

Array = NDArray[np.float64]

# ---------------------------------------------------------------------------------------------- film


@compiled
def march(P: Array, cells: FilmCells, settings: MarchSettings) -> tuple[int, float]:
    """As `numpy_kernels.march`."""
    n, n_z = len(P), cells.n_z
    fit, gained = np.zeros(n), np.zeros(n)
    # at index k the flow through the face before node k; at k + n_z (U_z: k + 1) that through the face after it
    U_phi, U_z = np.zeros(n + n_z), np.zeros(n + 1)
    per_capacity = cells.is_unknown / cells.capacity
    steps, change, excess = 0, np.inf, 0.0
    while steps < settings.max_steps and change > settings.tolerance:
        dt = settings.fraction / largest_rate(P, cells, per_capacity)  # (59)
        renew_fit(P, cells, fit)
        for _ in range(REFRESH):
            flows(P, cells, fit, U_phi, U_z)
            gather(U_phi, U_z, cells, gained)
            for k in range(n):
                P[k] += dt * per_capacity[k] * gained[k]  # (58)
            if len(cells.inventory):
                excess = gas_inventory_error(P, cells)
                for k in range(n):
                    P[k] *= 1.0 - dt / settings.time * excess
        steps += REFRESH
        change = max(np.max(np.abs(per_capacity * gained)) * settings.time, abs(excess))
    return steps, change


@compiled
def flows(P: Array, cells: FilmCells, fit: Array, U_phi: Array, U_z: Array) -> None:
    """Flows through the faces after every node (56), (57), stored at the index of the next node."""
    n, n_z = len(P), cells.n_z
    advection, advection_ahead, along, slip = cells.advection, cells.advection_ahead, cells.along, cells.slip
    onward = U_phi[n_z:]
    P_ahead = P[n_z:]
    for k in range(n - n_z):
        m0, m1 = advection[k] * P[k], advection_ahead[k] * P_ahead[k]
        poiseuille = -along[k] * (0.5 * (P[k] + P_ahead[k]) + slip[k]) * (P_ahead[k] - P[k])
        onward[k] = poiseuille + m0 + m1 - fit[k] * (m1 - m0)
    if n_z > 1:
        across, slip_across, beside, P_beside = cells.across, cells.slip_across, U_z[1:], P[1:]
        for k in range(n - 1):
            beside[k] = -across[k] * (0.5 * (P[k] + P_beside[k]) + slip_across[k]) * (P_beside[k] - P[k])


@compiled
def gather(U_phi: Array, U_z: Array, cells: FilmCells, gained: Array) -> None:
    """Net flow into every cell (55); nodes that share a pressure have the sum of theirs."""
    onward, beside = U_phi[cells.n_z :], U_z[1:]
    for k in range(len(gained)):
        gained[k] = U_phi[k] - onward[k] + U_z[k] - beside[k]
    for pair in range(len(cells.first)):
        both = gained[cells.first[pair]] + gained[cells.last[pair]]
        gained[cells.first[pair]] = gained[cells.last[pair]] = both


@compiled
def renew_fit(P: Array, cells: FilmCells, fit: Array) -> None:
    """`L(x)` of the circumferential faces after every node (F2)."""
    for k in range(len(P) - cells.n_z):
        x = cells.peclet[k] / (0.5 * (P[k] + P[k + cells.n_z]) + cells.slip[k])
        if x < 0.03:
            square = x * x
            fit[k] = x * (1.0 / 3.0 - square * (1.0 / 45.0 - square * (2.0 / 945.0)))
        else:
            decay = math.exp(-2.0 * x)
            fit[k] = (1.0 + decay) / (1.0 - decay) - 1.0 / x


@compiled
def largest_rate(P: Array, cells: FilmCells, per_capacity: Array) -> float:
    """Inverse of the largest stable time step (59) [1]."""
    n, n_z = len(P), cells.n_z
    total = np.empty(n)
    for k in range(n):
        total[k] = cells.along[k] * (P[k] + cells.slip[k]) + cells.across[k] * (P[k] + cells.slip_across[k])
        total[k] += 2.0 * cells.advection[k]
        if k >= n_z:
            total[k] += cells.along[k - n_z] * (P[k] + cells.slip[k - n_z])
        if k >= 1:
            total[k] += cells.across[k - 1] * (P[k] + cells.slip_across[k - 1])
    for pair in range(len(cells.first)):
        a, b = cells.first[pair], cells.last[pair]
        total[a] += total[b]
        total[b] = total[a]
    return float(np.max(total * per_capacity))


@compiled
def gas_inventory_error(P: Array, cells: FilmCells) -> float:
    """Relative excess of the gas inventory of a film without ambient nodes (F6), (Q5) [1]."""
    excess, slope = 0.0, 0.0
    for k in range(len(cells.inventory)):
        excess += cells.inventory[k] * (P[k] * P[k] - 1.0) + cells.inventory_slip[k] * (P[k] - 1.0)
        slope += (2.0 * cells.inventory[k] * P[k] + cells.inventory_slip[k]) * P[k]
    return excess / slope


# ---------------------------------------------------------------------------------------------- pack


@compiled
def descend(
    W: Array, load: Array, shell: Bands, columns: ContactColumns, settings: DescentSettings
) -> tuple[int, float]:
    """As `numpy_kernels.descend`."""
    n = len(W)
    ahead, last, force = W.copy(), W.copy(), np.empty(n)
    steps, left, theta = 0, np.inf, 1.0
    while steps < settings.max_steps and left > settings.tolerance:
        left = 0.0
        for turn in range(CHECK):
            last[:] = W
            elastic_force(ahead, shell, force)
            for i in range(n):
                W[i] = ahead[i] - settings.step * (force[i] - load[i])  # (49), (50)
            project(W, columns)  # (20)
            if turn == CHECK - 1:
                left = np.max(np.abs(W - ahead)) / settings.step
            if settings.momentum:
                theta = go_ahead(ahead, W, last, theta)
            else:
                ahead[:] = W
        steps += CHECK
    return steps, left


@compiled
def elastic_force(W: Array, shell: Bands, force: Array) -> None:
    """Nodal forces `K W` of the petals' bending."""
    n = shell.values.shape[1]
    force[:] = 0.0
    for petal in range(len(W) // n):
        out, W_here = force[petal * n : (petal + 1) * n], W[petal * n : (petal + 1) * n]
        for band in range(len(shell.offset)):
            offset = shell.offset[band]
            start, stop = max(0, -offset), min(n, n - offset)
            values, rows, beside = shell.values[band, start:stop], out[start:stop], W_here[start + offset :]
            for i in range(stop - start):
                rows[i] += values[i] * beside[i]


@compiled
def project(W: Array, columns: ContactColumns) -> None:
    """The nearest deflections that satisfy the constraints (18)-(20); up to three layers are written out."""
    node, shift = columns.node, columns.shift
    for c in range(len(columns.layers)):
        layers, low, high = columns.layers[c], columns.low[c], columns.high[c]
        if layers == 1:
            i = node[0, c]
            W[i] = clip(W[i], low, high)
        elif layers == 2:
            i, j = node[0, c], node[1, c]
            z0, z1 = W[i], W[j] + shift[1, c]
            mean = 0.5 * (z0 + z1)
            W[i] = clip(min(z0, mean), low, high)
            W[j] = clip(max(z1, mean), low, high) - shift[1, c]
        elif layers == 3:
            i, j, k = node[0, c], node[1, c], node[2, c]
            z0, z1, z2 = W[i], W[j] + shift[1, c], W[k] + shift[2, c]
            inner, outer, all_three = 0.5 * (z0 + z1), 0.5 * (z1 + z2), (z0 + z1 + z2) / 3.0
            W[i] = clip(min(z0, min(inner, all_three)), low, high)
            W[j] = clip(max(min(inner, all_three), min(z1, outer)), low, high) - shift[1, c]
            W[k] = clip(max(z2, max(outer, all_three)), low, high) - shift[2, c]
        else:
            pool(W, columns, c)


@compiled
def pool(W: Array, columns: ContactColumns, c: int) -> None:
    """Project one column of any number of layers: neighbours out of order take their mean (pool adjacent violators)."""
    layers = columns.layers[c]
    mean, count, blocks = np.empty(layers), np.empty(layers, dtype=np.int64), 0
    for q in range(layers):
        mean[blocks], count[blocks] = W[columns.node[q, c]] + columns.shift[q, c], 1
        blocks += 1
        while blocks > 1 and mean[blocks - 2] > mean[blocks - 1]:
            a, b = count[blocks - 2], count[blocks - 1]
            mean[blocks - 2] = (a * mean[blocks - 2] + b * mean[blocks - 1]) / (a + b)
            count[blocks - 2] = a + b
            blocks -= 1
    q = 0
    for block in range(blocks):
        for _ in range(count[block]):
            W[columns.node[q, c]] = clip(mean[block], columns.low[c], columns.high[c]) - columns.shift[q, c]
            q += 1


@compiled
def clip(z: float, low: float, high: float) -> float:
    """`z` between its bounds."""
    return min(max(z, low), high)


@compiled
def go_ahead(ahead: Array, W: Array, last: Array, theta: float) -> float:
    """Extrapolate `ahead` from the deflections by momentum; the next `theta`."""
    against = 0.0
    for i in range(len(W)):
        against += (W[i] - ahead[i]) * (W[i] - last[i])
    if against < 0.0:
        theta = 1.0
    larger = 0.5 * (1.0 + math.sqrt(1.0 + 4.0 * theta * theta))
    factor = (theta - 1.0) / larger
    for i in range(len(W)):
        ahead[i] = W[i] + factor * (W[i] - last[i])
    return larger
