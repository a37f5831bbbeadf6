"""Sparse matrices of one pattern.

==============  ========================================================
`blocks.py`     from blocks along the diagonal
`compressed.py` from arrays that are known to fit
`pattern.py`    where their entries go
`ordering.py`   in which order they are best eliminated
`products.py`   products with vectors, and matrices from blocks, at the cost of their sums
==============  ========================================================
"""

from petalfoil.sparsity.blocks import at_stations, block_diagonal, repeated
from petalfoil.sparsity.compressed import compressed
from petalfoil.sparsity.ordering import Elimination, Order, TiedOrder, postorder
from petalfoil.sparsity.pattern import Pattern, add_up
from petalfoil.sparsity.products import SparseRows, SummedEntries, Triplets, added_blocks, rows_of_blocks

__all__ = [
    "Elimination",
    "Order",
    "Pattern",
    "SparseRows",
    "SummedEntries",
    "TiedOrder",
    "Triplets",
    "add_up",
    "added_blocks",
    "at_stations",
    "block_diagonal",
    "compressed",
    "postorder",
    "repeated",
    "rows_of_blocks",
]
