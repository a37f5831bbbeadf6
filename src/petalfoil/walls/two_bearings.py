"""Two equal bearings on one shaft that tilts: one wall with twice the unknowns and a position of four coordinates.

The shaft's axis is at `(x, y) + z (a_x, a_y)`, `z` from the mass centre. With the lever `l`, half the distance of the
bearings, the position is `q = (x, y, l a_x, l a_y)`, and a node at `z` along the shaft sees `(x, y) + z / l (l a)`.
Each bearing may stand askew by slopes of its own.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.contact import Contacts, GapLines
from petalfoil.sparsity import SparseRows
from petalfoil.walls.base import Wall
from petalfoil.walls.elasticity import Elasticity

Array = NDArray[np.float64]
Index = NDArray[np.intp]


def paired(walls: tuple[Wall, Wall], places: tuple[float, float]) -> Wall:
    """A wall twice, the middles of both at `places` [m] from the mass centre; they may differ in how they stand askew.

    Raises
    ------
    ValueError
        The wall is that of half a length, which cannot tilt.
    """
    wall, other = walls
    if wall.film.axial.half:
        raise ValueError("half a length cannot tilt")
    order = by_kind(wall.contacts)
    n = wall.n_unknown
    film = FilmMesh(
        wall.film.phi,
        np.vstack([wall.film.theta, wall.film.theta]),
        wall.film.axial,
        twice_numbered(wall.film.unknown, wall.film.n_unknown),
    )
    return replace(
        wall,
        film=film,
        elasticity=Elasticity(
            twice(wall.elasticity.difference), twice(wall.elasticity.strain), twice(wall.elasticity.rigidity)
        ),
        film_unknown=twice_numbered(wall.film_unknown, n),
        load_area=np.concatenate([wall.load_area, wall.load_area]),
        rest_film=np.concatenate([wall.rest_film, other.rest_film]),
        contacts=paired_contacts(walls, places, order),
        free_motions=twice(wall.free_motions),
        support=twice(wall.support),
        slip=twice(wall.slip),
        reaction_share=sp.csr_array(twice(wall.reaction_share)[:, order]),
        n_bearings=2,
        loss=None if wall.loss is None else twice(wall.loss),
    )


def twice(matrix: sp.csr_array) -> sp.csr_array:
    """Block diagonal of a matrix with itself."""
    return sp.csr_array(sp.block_diag([matrix, matrix], format="csr"))


def twice_numbered(numbers: Index, count: int) -> Index:
    """Numbers of both bearings' unknowns, -1 where there is none."""
    both: Index = np.concatenate([numbers, np.where(numbers >= 0, numbers + count, -1)])
    return both


def by_kind(contacts: Contacts) -> Index:
    """Gaps of both bearings, all on the journal first, then on the bushing, then between petals."""
    m = len(contacts.rest)
    every = np.arange(m)
    kinds = [every[rows] for rows in (contacts.journal, contacts.bushing, contacts.petals)]
    return np.concatenate([part + first for part in kinds for first in (0, m)])


def paired_contacts(walls: tuple[Wall, Wall], places: tuple[float, float], order: Index) -> Contacts:
    """Gaps of both bearings, with the part of each that the tilt of the shaft moves."""
    (wall, other), lever = walls, 0.5 * (places[1] - places[0])
    contacts, film = wall.contacts, wall.film
    m = len(contacts.rest)
    along = np.broadcast_to((film.axial.z - 0.5 * film.axial.length) / lever, film.shape).ravel()
    sides = []
    for place in places:
        arm = np.zeros(m)
        arm[contacts.journal] = place / lever + along
        sides.append(np.hstack([contacts.by_e, arm[:, None] * contacts.by_e]))
    sizes = [2 * len(np.arange(m)[rows]) for rows in (contacts.journal, contacts.bushing, contacts.petals)]
    ends = np.concatenate([[0], np.cumsum(sizes)])
    journal, bushing, petals = (slice(int(a), int(b)) for a, b in pairwise(ends))
    return Contacts(
        SparseRows(twice(contacts.G)[order]),
        np.concatenate([contacts.rest, other.contacts.rest])[order],
        np.vstack(sides)[order],
        np.concatenate([contacts.area, contacts.area])[order],
        journal,
        bushing,
        petals,
        paired_lines(contacts.lines, order),
    )


def paired_lines(lines: tuple[GapLines, ...], order: Index) -> tuple[GapLines, ...]:
    """The lines of both bearings, with the numbers that their gaps have in `order`."""
    place = np.argsort(order)
    m = len(order) // 2
    both = ((np.vstack([place[line.number], place[line.number + m]]), line) for line in lines)
    return tuple(GapLines(number, line.phi, line.stations) for number, line in both)
