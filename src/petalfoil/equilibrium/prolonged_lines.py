"""Contact lines carried over from a coarse grid to a fine one of the same bearing.

Deflections are interpolated by the wall, pressures by monotone cubics of their logarithm. Points of neighbouring
stations that lie close to each other are a line: between its stations places and reactions over the length are
interpolated, and at its ends it goes on for half a cell. Contacts at nodes are carried to the nodes between them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_runs import runs
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.splines import monotone
from petalfoil.physics.contact import GapLines
from petalfoil.physics.line_points import LinePoints
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.unknowns import DEFLECTION, PRESSURE
from petalfoil.walls import wall_kind

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

REACH = 3.0
"""Farthest that a line goes round the shaft from one station to the next, in cells of the coarse grid."""

BEYOND = 0.5
"""How far a line goes on beyond the last station that has a point of it, in cells along the shaft."""

SAME_ANGLE = 1e-9
"""Difference of angles that are the same [rad]."""


@dataclass(frozen=True)
class ContactPiece:
    """A contact line from station to station of one petal.

    Attributes
    ----------
    kind, petal : int
        Kind of its gaps, and the petal.
    station : (k,) int array
        Stations, one after the other.
    phi : (k,) array
        Local angles there [rad].
    density : (k,) array
        Reactions over the length that each station represents [1/m].
    """

    kind: int
    petal: int
    station: NDArray[np.intp]
    phi: Array
    density: Array

    def reaches(self, coarse: AxialGrid, fine: AxialGrid) -> NDArray[np.intp]:
        """Numbers of the stations of a fine grid that it crosses."""
        first, last = self.station[0], self.station[-1]
        start, end = coarse.z[first], coarse.z[last]
        start -= BEYOND * (start - coarse.z[max(first - 1, 0)])
        end += BEYOND * (coarse.z[min(last + 1, len(coarse.z) - 1)] - end)
        rounding = SAME_ANGLE * coarse.length
        return np.flatnonzero((fine.z >= start - rounding) & (fine.z <= end + rounding))


def prolonged(known: LineContacts, problem: CoupledProblem, load: Array | None) -> LineContacts:
    """The state of contact lines on a coarse grid under the equations of a fine one, unsolved.

    Contacts at nodes are without reactions.
    """
    contacts, held = problem.layout.wall.contacts, carried_nodes(known, problem)
    coarse, fine = known.problem.layout.wall.film.axial, problem.layout.wall.film.axial
    force = known.problem.layout.scales.force / problem.layout.scales.force
    kind, line, phi, reaction = [], [], [], []
    for piece in pieces(known):
        at = piece.reaches(coarse, fine)
        z, here = coarse.z[piece.station], fine.z[at]
        kind.append(np.full(len(at), piece.kind))
        line.append(piece.petal * len(fine.z) + at)
        phi.append(np.interp(here, z, piece.phi))
        reaction.append(force * np.interp(here, z, piece.density) * fine.weight[at])
    points = LinePoints(contacts.lines, len(contacts.rest), number(kind), number(line), joined(phi))
    x = prolonged_unknowns(known, problem)
    return LineContacts(problem, x, points, joined(reaction), held, np.zeros(int(held.sum())), load)


def number(parts: Sequence[NDArray[np.intp]]) -> NDArray[np.intp]:
    """Integers one after the other; none of no parts."""
    return np.concatenate([np.zeros(0, dtype=np.intp), *parts])


def joined(parts: Sequence[Array]) -> Array:
    """Numbers one after the other; none of no parts."""
    return np.concatenate([np.zeros(0), *parts])


def prolonged_unknowns(known: LineContacts, problem: CoupledProblem) -> Array:
    """Deflections and pressures on another grid, (n,)."""
    before, here = known.problem.layout, problem.layout
    w = known.x[before.unknowns[DEFLECTION]] * (before.scales.length / here.scales.length)
    deflection = wall_kind(here.case).prolonged(before.case, here.case, w)
    coarse, film = before.wall.film, here.wall.film
    ln_P = np.log(known.problem.pressure(known.x))
    along = coarse.axial.whole(monotone(coarse.phi, ln_P, axis=1)(film.phi))
    along = monotone(coarse.axial.whole_z, along, axis=2)(film.axial.z)
    return here.unknowns.join({DEFLECTION: deflection, PRESSURE: film.at_unknowns(np.exp(along))})


def pieces(known: LineContacts) -> Iterator[ContactPiece]:
    """The contact lines of a state, petal by petal."""
    points, weight = known.points, known.problem.layout.wall.film.axial.weight
    stations = len(weight)
    for kind, lines in enumerate(points.lines):
        reach = REACH * float(np.mean(np.diff(lines.phi)))
        for petal in range(len(lines.number) // stations):
            mine = np.flatnonzero((points.kind == kind) & (points.line // stations == petal))
            at = points.line[mine] % stations
            for chain in chains([mine[at == station] for station in range(stations)], points.phi, reach):
                station = points.line[chain] % stations
                density = known.reaction[chain] / weight[station]
                yield ContactPiece(kind, petal, station, points.phi[chain], density)


def chains(numbers: Sequence[NDArray[np.intp]], phi: Array, reach: float) -> list[list[int]]:
    """Numbers of points that follow each other from station to station, each the nearest to the one before.

    Parameters
    ----------
    numbers : sequence of (k,) int arrays
        Numbers of the points of each station.
    phi : (n,) array
        Angles of all points [rad].
    reach : float
        Farthest from one to the next [rad].
    """
    found: list[list[int]] = []
    going: list[list[int]] = []
    for here in numbers:
        free, ahead = [int(point) for point in here], []
        for chain in going:
            near = min(free, key=lambda point: abs(phi[point] - phi[chain[-1]]), default=None)
            if near is not None and abs(phi[near] - phi[chain[-1]]) <= reach:
                free.remove(near)
                chain.append(near)
                ahead.append(chain)
        begun = [[point] for point in free]
        found += begun
        going = [*ahead, *begun]
    return found


def carried_nodes(known: LineContacts, problem: CoupledProblem) -> Mask:
    """Contacts at nodes of a fine grid: at and between those of the nearest station of the coarse one, (m,)."""
    held = np.zeros(len(problem.weight), dtype=np.bool_)
    coarse, fine = known.problem.layout.wall.film.axial.z, problem.layout.wall.film.axial.z
    nearest = np.argmin(np.abs(fine[:, None] - coarse), axis=1)
    for before, here in zip(known.points.lines, problem.layout.wall.contacts.lines, strict=True):
        own, other = known.held[before.number], len(fine)
        for line in np.flatnonzero(own.any(axis=1)):
            petal, station = divmod(int(line), len(coarse))
            for at in np.flatnonzero(nearest == station):
                held[here.number[petal * other + at][between(own[line], before, here)]] = True
    return held


def between(held: Mask, before: GapLines, here: GapLines) -> Mask:
    """Nodes of a line at and between the runs of contacts of the same line with other nodes; (node,) each."""
    out = np.zeros(len(here.phi), dtype=np.bool_)
    for run in runs(held):
        first, last = before.phi[run[0]] - SAME_ANGLE, before.phi[run[-1]] + SAME_ANGLE
        inside = (here.phi >= first) & (here.phi <= last)
        if not inside.any():
            inside[np.argmin(np.abs(here.phi - before.phi[run[0]]))] = True
        out |= inside
    return out
