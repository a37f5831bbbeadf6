"""The vector of unknowns in named blocks, and the tangent assembled from blocks.

A further field on the film, or a few unknowns beside it, is an `ExtraField` in a file of its own that is named where
the problem is built (`build.discretised`). Nothing else changes: blocks are addressed by name everywhere.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.sparsity import Pattern

Array = NDArray[np.float64]
Index = NDArray[np.intp]

DEFLECTION, PRESSURE, POSITION = "deflection", "pressure", "position"


@dataclass(frozen=True)
class Unknowns:
    """Blocks of a vector, one after the other.

    Attributes
    ----------
    sizes : dict
        Number of unknowns of each block, in their order.
    """

    sizes: Mapping[str, int]

    @cached_property
    def _blocks(self) -> dict[str, slice]:
        ends = np.cumsum([0, *self.sizes.values()])
        return {name: slice(int(a), int(b)) for name, a, b in zip(self.sizes, ends[:-1], ends[1:], strict=True)}

    @cached_property
    def n(self) -> int:
        """All unknowns."""
        return sum(self.sizes.values())

    def __getitem__(self, name: str) -> slice:
        """Place of a block."""
        return self._blocks[name]

    def join(self, blocks: Mapping[str, Array | float]) -> Array:
        """The vector (n,) of all blocks; a number fills its block."""
        return np.concatenate([np.broadcast_to(blocks[name], size) for name, size in self.sizes.items()])

    def zeros(self) -> Array:
        """A vector of zeros, (n,)."""
        return np.zeros(self.n)

    def extended(self, **sizes: int) -> Unknowns:
        """The same with further blocks at the end."""
        return Unknowns({**self.sizes, **sizes})


@dataclass(frozen=True)
class BlockEntries:
    """Places of entries in one block of a matrix: numbers of row and column within the blocks named, (k,) each."""

    row_block: str
    column_block: str
    rows: Index
    cols: Index


@dataclass(frozen=True)
class BlockPattern:
    """Sparsity of a matrix over named blocks.

    Attributes
    ----------
    unknowns : Unknowns
        The blocks.
    entries : sequence of BlockEntries
        Places, in the order in which values are given. A place that occurs several times adds up.
    """

    unknowns: Unknowns
    entries: Sequence[BlockEntries]

    def _places(self, entries: Sequence[BlockEntries]) -> tuple[Index, Index]:
        first = {name: self.unknowns[name].start for name in self.unknowns.sizes}
        rows = [first[e.row_block] + e.rows for e in entries]
        cols = [first[e.column_block] + e.cols for e in entries]
        return np.concatenate(rows).astype(np.intp), np.concatenate(cols).astype(np.intp)

    @cached_property
    def _pattern(self) -> Pattern:
        return Pattern.of(*self._places(self.entries), self.unknowns.n)

    def assemble(self, values: Sequence[Array]) -> sp.csc_array:
        """The matrix (n, n) with `values` at the entries, in their order."""
        return self._pattern.assemble(np.concatenate(values))

    def assemble_part(self, entries: slice, values: Sequence[Array]) -> sp.csc_array:
        """The matrix (n, n) of some of the entries alone."""
        places, n = self._places(self.entries[entries]), self.unknowns.n
        return sp.coo_array((np.concatenate(values), places), shape=(n, n)).tocsc()


@dataclass(frozen=True)
class FieldRows:
    """Rows of an extra field at one state.

    Attributes
    ----------
    residual : dict
        What the field adds to the residual of each block, its own included.
    row_scale : array
        What its own residual is compared with.
    values : sequence of arrays
        Derivatives, in the order of `ExtraField.entries`.
    by_film : array
        Derivative of its own rows by the film thickness, summed over the nodes that a row reads, if it reads any:
        (size, film nodes).
    """

    residual: Mapping[str, Array]
    row_scale: Array
    values: Sequence[Array]
    by_film: sp.csr_array | None = None


class ExtraField(Protocol):
    """Unknowns beside deflection and pressure, with as many equations."""

    @property
    def name(self) -> str:
        """Name of the block."""

    @property
    def size(self) -> int:
        """Number of unknowns."""

    @property
    def initial(self) -> float:
        """Their value where a solution starts from nothing."""

    @property
    def entries(self) -> Sequence[BlockEntries]:
        """Places of its derivatives, in its own rows and in those of others."""

    def at(self, blocks: Mapping[str, Array], film: Array) -> FieldRows:
        """Rows at the unknowns of all blocks and the film thickness at all nodes [1]."""
