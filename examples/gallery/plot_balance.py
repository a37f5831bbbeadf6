"""
The operating point under a load
================================

``balance`` finds the position at which a load is carried.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 32})
result = petalfoil.balance(case, "20 N")

fig = plot.operating_point(result)
