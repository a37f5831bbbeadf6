"""Film, petals and contact points of a stage in time in compiled loops: the numbers of `PointStepEquations`.

The equations are those of `point_equations.py` and `point_step.py`, with the flux of `physics/reynolds.py`, written
node by node. A test compares both.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from petalfoil.compiled import compiled
from petalfoil.physics.reynolds import DRAIN, ROUNDING
from petalfoil.system.coupled import ROUNDED
from petalfoil.system.point_tables import (
    CurveTables,
    EntriesByRow,
    FilmTables,
    Moves,
    PointPlaces,
    PointRows,
    PointTables,
    PointValues,
    StepNumbers,
    WallTables,
)

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@compiled
def point_rows(tables: PointTables, w: Array, P: Array, points: PointPlaces, at: StepNumbers) -> PointRows:
    """The equations at deflections `w` (n_wall,), pressures `P` (n_film,) and contacts."""
    curves, film = tables.curves, tables.film
    gaps = nodal_gaps(curves, w, at)
    thickness = times(film.by_gaps, gaps).reshape(film.unknown.shape)
    thickness += film.floor
    outflow, flow_scale, mass = film_rows(film, P, thickness, at)
    value, contacts = point_gaps(curves, gaps, points)
    slope = contacts.slope[points.ends] * contacts.travels
    wall, wall_scale = wall_rows(tables.wall, w, P)
    take(wall, curves.by_w, contacts.loads)
    none = np.zeros(0)
    opening = max(largest(value, none), largest(slope, none))
    imbalance = (largest(wall, wall_scale), largest(outflow, flow_scale), opening)
    return PointRows(gaps, thickness, wall, outflow, value, slope, imbalance, contacts, mass, wall_scale, flow_scale)


@compiled
def largest(residual: Array, scale: Array) -> float:
    """Largest magnitude of a residual over its scale; over 1 where that is empty."""
    most = 0.0
    for k in range(len(residual)):
        most = max(most, abs(residual[k]) / (scale[k] if len(scale) else 1.0))
    return most


@compiled
def times(matrix: EntriesByRow, x: Array) -> Array:
    """The product with a vector."""
    out = np.zeros(len(matrix.start) - 1)
    for row in range(len(out)):
        total = 0.0
        for k in range(matrix.start[row], matrix.start[row + 1]):
            total += matrix.value[k] * x[matrix.column[k]]
        out[row] = total
    return out


@compiled
def take(out: Array, matrix: EntriesByRow, x: Array) -> None:
    """Take the product of the transpose with `x` from `out`; most of `x` is zero."""
    for row in range(len(x)):
        if x[row] != 0.0:
            for k in range(matrix.start[row], matrix.start[row + 1]):
                out[matrix.column[k]] -= matrix.value[k] * x[row]


@compiled
def nodal_gaps(curves: CurveTables, w: Array, at: StepNumbers) -> Array:
    """Nodal (value, slope) of all gaps (K10), (2 n_node,)."""
    gaps = times(curves.by_w, w)
    for k in range(len(gaps)):
        gaps[k] += curves.rest[k]
    for k in range(curves.journal):
        for d in range(len(at.displacement)):
            gaps[k] += curves.by_e[k, d] * at.displacement[d]
    for k in range(0, curves.journal, 2):
        gaps[k] -= at.closing
    return gaps


# ---------------------------------------------------------------------------------------------- film


@compiled
def film_rows(film: FilmTables, P: Array, H: Array, at: StepNumbers) -> tuple[Array, Array, Array]:
    """Net outflow of the cells with what they store (O2), sums of its flows, and gas in the cells; (n_film,) each."""
    out, size, mass = np.zeros(len(P)), np.zeros(len(P)), np.zeros(len(P))
    for strip in range(H.shape[0]):
        pressure, number = at_nodes(film, P, strip), film.unknown[strip]
        for node in range(H.shape[1] - 1):
            flow, scale = face(film, pressure, H[strip], node, at.film_number)
            for cell, sign in ((number[node], 1.0), (number[node + 1], -1.0)):
                if cell >= 0:
                    out[cell] += sign * flow
                    size[cell] += scale
        for node in range(H.shape[1]):
            if number[node] >= 0:
                mass[number[node]] += 2.0 * at.time_number * pressure[node] * H[strip, node] * film.area[node]
    if film.filling > 0.0:
        out[0], size[0] = inventory(film, P, H)
        mass[0] = film.filling * np.sum(mass)
    if at.rate > 0.0:
        for cell in range(len(out)):
            out[cell] += at.rate * (mass[cell] - at.start[cell])
    return out, size, mass


@compiled
def at_nodes(film: FilmTables, P: Array, strip: int) -> Array:
    """Pressures at the nodes of a strip, 1 at ambient ones."""
    out = np.ones(film.unknown.shape[1])
    for node in range(len(out)):
        if film.unknown[strip, node] >= 0:
            out[node] = P[film.unknown[strip, node]]
    return out


@compiled
def face(film: FilmTables, P: Array, H: Array, node: int, Lam: float) -> tuple[float, float]:
    """Flow from a node to the next one (F2), limited (F2b), and the sum of the magnitudes of its terms."""
    P0, P1, H0, H1, dphi = P[node], P[node + 1], H[node], H[node + 1], film.dphi[node]
    cube, mean_P = 2.0 * (H0 * H1) ** 2 / (H0 + H1), 0.5 * (P0 + P1)
    slip = 3.0 * film.knudsen * (1.0 / H0 + 1.0 / H1) if film.knudsen > 0.0 else 0.0
    conductance = cube * (mean_P + slip) / dphi
    x, behind, ahead = 0.25 * Lam * (H0 + H1) / conductance, P0 * H0, P1 * H1
    poiseuille, couette = conductance * (P0 - P1), 0.5 * Lam * (behind + ahead)
    upwinding = 0.5 * Lam * langevin(x) * (behind - ahead)
    value, bound = poiseuille + couette + upwinding, DRAIN * (Lam * H0 + conductance) * P0
    if value > bound:
        value = bound * (2.0 - bound / value)
    size = abs(poiseuille) + couette + abs(upwinding) + ROUNDING * conductance * mean_P
    return value * film.width, size * film.width


@compiled
def langevin(x: float) -> float:
    """`coth x - 1/x`."""
    if x >= 0.03:
        return -2.0 / math.expm1(-2.0 * x) - 1.0 - 1.0 / x
    square = x * x
    return x * (1.0 / 3.0 - square * (1.0 / 45.0 - square * (2.0 / 945.0)))


@compiled
def inventory(film: FilmTables, P: Array, H: Array) -> tuple[float, float]:
    """Residual of the gas inventory (F6), and the sum of the magnitudes of its terms."""
    value, size = 0.0, 0.0
    for strip in range(H.shape[0]):
        pressure = at_nodes(film, P, strip)
        for node in range(H.shape[1]):
            p, h = pressure[node], H[strip, node]
            cube, slip = film.area[node] * h**3, 12.0 * film.knudsen * film.area[node] * h**2
            value += cube * (p * p - 1.0) + slip * (p - 1.0)
            size += cube * (p * p + 1.0) + slip * (p + 1.0)
    return value, size


# ---------------------------------------------------------------------------------- petals and contacts


@compiled
def wall_rows(wall: WallTables, w: Array, P: Array) -> tuple[Array, Array]:
    """Forces on the petals but those of contacts (C6), and what they are compared with; (n_wall,) each."""
    bent, over = times(wall.bending, w), P - 1.0
    out = np.zeros(len(w))
    take(out, wall.bending, -bent)
    pushed, size = times(wall.push, over), times(wall.size, np.abs(w))
    for k in range(len(w)):
        out[k] -= pushed[k]
        size[k] = max(1.0, ROUNDED * size[k])
    return out, size


@compiled
def point_gaps(curves: CurveTables, gaps: Array, points: PointPlaces) -> tuple[Array, PointValues]:
    """EntriesByRow of all points (C7), and what there is at them."""
    count = len(points.curve)
    value, slope, idle, loads = np.zeros(count), np.zeros(count), np.zeros(count), np.zeros(len(gaps))
    (element, place), weights = located(curves, points), np.empty(4)
    for j in range(count):
        first = 2 * element[j]
        shapes(place[j], curves.angle[element[j]], 0, weights)
        for i in range(4):
            value[j] += weights[i] * gaps[first + i]
            loads[first + i] += weights[i] * points.reaction[j]
        shapes(place[j], curves.angle[element[j]], 1, weights)
        for i in range(4):
            slope[j] += weights[i] * gaps[first + i]
        for d in range(count):
            if element[d] == element[j]:
                bend, turn = clamped_beam(place[j], place[d])
                load = curves.compliance[element[j]] * points.reaction[d]
                value[j] += bend * load
                slope[j] += turn * load
        if points.position[j] <= 0.0 and points.curve[j] // curves.petals == 1:
            idle[j], value[j] = 1.0, points.reaction[j]
    return value, PointValues(slope, travelling(curves, points), idle, loads)


@compiled
def located(curves: CurveTables, points: PointPlaces) -> tuple[Index, Array]:
    """Element of each point and place in it, (j,) each."""
    element, place = np.empty(len(points.curve), np.int64), np.empty(len(points.curve))
    for j in range(len(element)):
        curve = points.curve[j]
        inside = max(min(math.floor(points.position[j]), curves.elements[curve] - 1), 0)
        element[j], place[j] = curves.first[curve] + inside, points.position[j] - inside
    return element, place


@compiled
def travelling(curves: CurveTables, points: PointPlaces) -> Array:
    """1 for the travelling points, 0 for those at an end of their curve, (k,)."""
    out = np.zeros(len(points.ends))
    for k in range(len(out)):
        j = points.ends[k]
        if 0.0 < points.position[j] < curves.elements[points.curve[j]]:
            out[k] = 1.0
    return out


@compiled
def shapes(t: float, angle: float, derivative: int, out: Array) -> None:
    """Weights of the nodal (value, slope) of an element (S5), or their derivatives by `t`, (4,)."""
    if derivative:
        out[0], out[1] = 6.0 * t * (t - 1.0), 1.0 + t * (3.0 * t - 4.0)
        out[2], out[3] = 6.0 * t * (1.0 - t), t * (3.0 * t - 2.0)
    else:
        square = t * t
        out[0], out[1] = 1.0 + square * (2.0 * t - 3.0), t + square * (t - 2.0)
        out[2], out[3] = square * (3.0 - 2.0 * t), square * (t - 1.0)
    out[1] *= angle
    out[3] *= angle


@compiled
def clamped_beam(s: float, t: float) -> tuple[float, float]:
    """`b(s, t)` (S7) and its derivative by `s`."""
    a, c = min(s, t), max(s, t)
    value = a**2 * (1.0 - c) ** 2 * (3.0 * c - a - 2.0 * a * c) / 6.0
    if s <= t:
        return value, a * (1.0 - c) ** 2 * (2.0 * c - a - 2.0 * a * c) / 2.0
    behind = -(a**2) * (1.0 - c) * (3.0 * c - 1.0 - 2.0 * a * c) / 2.0
    return value, behind


# ---------------------------------------------------------------------------------- steps, and signs of gaps


@compiled
def relative_changes(moves: Moves, P: Array, thickness: Array, change: Array, move: Array) -> tuple[float, float]:
    """As `PointEquations.relative_changes`."""
    falls, grows, first = 0.0, 0.0, len(change) - len(P)
    for k in range(len(P)):
        growth = change[first + k] / P[k]
        falls, grows = max(falls, -growth), max(grows, growth)
    opened, films = times(moves.film_by_w, change), thickness.ravel()
    for k in range(len(films)):
        for d in range(len(move)):
            opened[k] += moves.film_by_e[k, d] * move[d]
        falls = max(falls, -opened[k] / films[k])
    return falls, grows


@compiled
def overlaps(curves: CurveTables, gaps: Array, points: PointPlaces, depth: float, per_element: int) -> bool:
    """Whether a gap, sampled `per_element` times on each element, is below zero by `depth`, roots on the bushing apart.

    A cubic is above the least of its control points, and reactions that push open the gap of their own elements.
    """
    element, place = located(curves, points)
    pulls = len(points.reaction) > 0 and np.min(points.reaction) < 0.0
    weights = np.empty(4)
    for curve in range(len(curves.first)):
        from_root = 0.5 if curve // curves.petals == 1 else 0.0
        for inside in range(curves.elements[curve]):
            at = curves.first[curve] + inside
            if least_control(gaps, at, curves.angle[at]) >= -depth and not pulls:
                continue
            for sample in range(per_element):
                t = (sample + 0.5) / per_element
                if inside + t < from_root:
                    continue
                shapes(t, curves.angle[at], 0, weights)
                gap = 0.0
                for i in range(4):
                    gap += weights[i] * gaps[2 * at + i]
                for j in range(len(element)):
                    if element[j] == at:
                        gap += clamped_beam(t, place[j])[0] * curves.compliance[at] * points.reaction[j]
                if gap < -depth:
                    return True
    return False


@compiled
def least_control(gaps: Array, element: int, angle: float) -> float:
    """The least of the control points of the cubic on an element."""
    before, behind = float(gaps[2 * element]), float(gaps[2 * element + 2])
    ahead, back = before + angle * gaps[2 * element + 1] / 3.0, behind - angle * gaps[2 * element + 3] / 3.0
    return float(min(min(before, behind), min(ahead, back)))
