"""Two bearings on one shaft: numbers of unknowns and gaps, units, and how the shaft moves the journals."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.problem import Border
from petalfoil.sparsity import SparseRows
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.friction import friction_of
from petalfoil.system.scales import Scales
from petalfoil.system.unknowns import DEFLECTION, PRESSURE, Unknowns

Array = NDArray[np.float64]
Index = NDArray[np.intp]
T = TypeVar("T", bound=np.generic)


@dataclass(frozen=True, eq=False)
class ShaftLayout:
    """What stays the same while the shaft moves and turns.

    Attributes
    ----------
    parts : pair of BearingLayout
        The bearings; lengths and forces of both in the units of the first.
    arms : pair of (n_position, 4) array
        Position of each journal by that of the shaft [1].
    askew : pair of (n_position,) array
        Position of each journal under a shaft at the origin [1].
    """

    parts: tuple[BearingLayout, BearingLayout]
    arms: tuple[Array, Array]
    askew: tuple[Array, Array]

    @property
    def case(self) -> Case:
        """The first bearing."""
        return self.parts[0].case

    @property
    def scales(self) -> Scales:
        """Units of the first bearing."""
        return self.parts[0].scales

    @cached_property
    def unknowns(self) -> Unknowns:
        """Deflections of both, then pressures of both."""
        sizes = [part.unknowns.sizes for part in self.parts]
        return Unknowns({name: sum(one[name] for one in sizes) for name in (DEFLECTION, PRESSURE)})

    @cached_property
    def numbers(self) -> tuple[Index, ...]:
        """Among all unknowns, those of each bearing."""
        return tuple(apart([[part.n_wall, part.n - part.n_wall] for part in self.parts]))

    @cached_property
    def gap_numbers(self) -> tuple[Index, ...]:
        """Among all gaps, those of each bearing."""
        return tuple(apart([kinds(part) for part in self.parts]))

    @cached_property
    def stored_numbers(self) -> tuple[Index, ...]:
        """Among all that is stored, what each bearing stores."""
        lost = [0 if part.loss is None else part.n_wall for part in self.parts]
        return tuple(apart([[part.n - part.n_wall, n] for part, n in zip(self.parts, lost, strict=True)]))

    @cached_property
    def journal(self) -> slice:
        """Gaps on both journals."""
        return slice(0, sum(kinds(part)[0] for part in self.parts))

    @cached_property
    def rates(self) -> tuple[float, ...]:
        """Bearing number of each bearing over that of the first [1]."""
        first = self.parts[0].bearing_number(1.0)
        return tuple(part.bearing_number(1.0) / first for part in self.parts)

    @cached_property
    def G(self) -> SparseRows:
        """Derivative of the gaps by the unknowns."""
        return self._gap_rows([part.G for part in self.parts])

    @cached_property
    def acting(self) -> SparseRows:
        """Forces of unit reactions where the shaft turns (D6)."""
        if all(part.rubbing is None for part in self.parts):
            return self.G
        return self._gap_rows([part.acting for part in self.parts])

    def _gap_rows(self, own: list[SparseRows]) -> SparseRows:
        """Rows of the gaps of each bearing among all."""
        held = [rows.tocoo() for rows in own]
        rows = np.concatenate([gaps[one.row] for gaps, one in zip(self.gap_numbers, held, strict=True)])
        cols = np.concatenate([own[one.col] for own, one in zip(self.numbers, held, strict=True)])
        values, shape = np.concatenate([one.data for one in held]), (sum(map(len, self.gap_numbers)), self.unknowns.n)
        return SparseRows(sp.coo_array((values, (rows, cols)), shape=shape))

    @cached_property
    def weight(self) -> Array:
        """Weights of the gaps."""
        return joined(self.gap_numbers, [part.weight for part in self.parts])

    @cached_property
    def border(self) -> Border:
        """How the shaft's position enters."""
        return self._joined_border([part.border for part in self.parts])

    @cached_property
    def rubbed_border(self) -> Border:
        """The same where the shaft turns (D7)."""
        if all(part.rubbing is None for part in self.parts):
            return self.border
        borders = [part.rubbed_border for part in self.parts]
        by_reactions = np.zeros((self.arms[0].shape[1], len(self.weight)))
        for numbers, one, arm in zip(self.gap_numbers, borders, self.arms, strict=True):
            by_reactions[:, numbers] = arm.T @ one.by_reactions
        return replace(self._joined_border(borders), reaction_derivative=by_reactions)

    def _joined_border(self, borders: list[Border]) -> Border:
        by_q = [one.gap_derivative @ arm for one, arm in zip(borders, self.arms, strict=True)]
        force = [arm.T @ one.row_derivative for one, arm in zip(borders, self.arms, strict=True)]
        gaps = np.zeros((len(self.weight), by_q[0].shape[1]))
        for numbers, rows in zip(self.gap_numbers, by_q, strict=True):
            gaps[numbers] = rows
        return Border(gaps, np.hstack(force), self.unknowns[PRESSURE])


def friction_on_shaft(layout: ShaftLayout) -> Friction | None:
    """Friction between the petals of both bearings; None without any.

    Raises
    ------
    UsageError
        Both rub by different laws.
    """
    every = [friction_of(part.case, part) for part in layout.parts]
    rubbing = [(k, one) for k, one in enumerate(every) if one is not None]
    if not rubbing:
        return None
    first = rubbing[0][1]
    if any(
        (one.width, one.exact, one.directions) != (first.width, first.exact, first.directions) for _, one in rubbing
    ):
        raise UsageError(
            "petals of both bearings rub by different laws: give them the same petals.theory and surface.friction_width"
        )
    places = apart([[one.slip.shape[0] // one.directions] * one.directions for _, one in rubbing])
    slips, shares = [], []
    for (k, one), rows in zip(rubbing, places, strict=True):
        slip, share = one.slip.tocoo(), one.reaction_share.tocoo()
        slips.append((slip.data, rows[slip.row], layout.numbers[k][slip.col]))
        weight = one.coefficient / first.coefficient  # limits are the first coefficient times the normal force
        shares.append((weight * share.data, rows[share.row], layout.gap_numbers[k][share.col]))
    count, gaps, walls = sum(map(len, places)), len(layout.weight), layout.unknowns.sizes[DEFLECTION]
    slip, share = (
        sp.coo_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(cols))), shape=shape).tocsr()
        for (data, rows, cols), shape in (
            (zip(*slips, strict=True), (count, walls)),
            (zip(*shares, strict=True), (count, gaps)),
        )
    )
    return replace(first, slip=slip, reaction_share=share, stiffness=np.zeros(count))


def kinds(part: BearingLayout) -> list[int]:
    """Number of gaps on the journal, on the bushing and between petals."""
    contacts = part.wall.contacts
    every = np.arange(len(contacts.rest))
    return [len(every[rows]) for rows in (contacts.journal, contacts.bushing, contacts.petals)]


def apart(blocks: list[list[int]]) -> list[Index]:
    """Numbers of the items of each bearing, where the first blocks of all come first, then their second ones.

    Parameters
    ----------
    blocks : list of list of int
        Sizes of the blocks of each bearing.
    """
    sizes = np.array(blocks)
    starts = np.concatenate([[0], np.cumsum(sizes.T)[:-1]]).reshape(sizes.T.shape).T
    return [
        np.concatenate([np.arange(start, start + size) for start, size in zip(*own, strict=True)])
        for own in zip(starts, sizes, strict=True)
    ]


def joined(numbers: tuple[Index, ...], values: list[NDArray[T]]) -> NDArray[T]:
    """One vector from those of all bearings."""
    out = np.empty(sum(map(len, numbers)), dtype=values[0].dtype)
    for places, own in zip(numbers, values, strict=True):
        out[places] = own
    return out
