"""Sparse matrices of one pattern.

==============  ========================================================
`pattern.py`    where their entries go
`ordering.py`   in which order they are best eliminated
`products.py`   products with vectors at the cost of their sums
==============  ========================================================
"""

from petalfoil.sparsity.ordering import Elimination, Order, TiedOrder, postorder
from petalfoil.sparsity.pattern import Pattern, add_up
from petalfoil.sparsity.products import SparseRows

__all__ = ["Elimination", "Order", "Pattern", "SparseRows", "TiedOrder", "add_up", "postorder"]
