"""
Sensitivity
===========

``sensitivity`` tells how far 1 % of each parameter moves a result, from exact derivatives.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 16})
result = petalfoil.sensitivity(case, ask="balance", load="20 N")

fig = plot.tornado(result)
