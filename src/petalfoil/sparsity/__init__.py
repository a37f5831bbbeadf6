"""Sparse matrices of one pattern.

==============  ========================================================
`pattern.py`    where their entries go
`ordering.py`   in which order they are best eliminated
==============  ========================================================
"""

from petalfoil.sparsity.ordering import Elimination, Order, TiedOrder, postorder
from petalfoil.sparsity.pattern import Pattern, add_up

__all__ = ["Elimination", "Order", "Pattern", "TiedOrder", "add_up", "postorder"]
