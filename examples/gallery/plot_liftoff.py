"""
Lift-off and touchdown
======================

``liftoff`` finds the speeds at which solid contact ceases to carry the journal, over the load.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 16})
result = petalfoil.liftoff(case, "5 N, 10 N")

fig = plot.liftoff(result)
