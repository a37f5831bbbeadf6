"""
A study over two parameters
===========================

``sweep`` asks an analysis of many cases. Results have the parameters as dimensions.
"""

import petalfoil
from petalfoil import plot
from petalfoil.studies.run import Execution

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 16})
vary = {"petals.thickness": "0.14 mm : 0.22 mm : 4", "petals.count": [6, 10]}
result = petalfoil.sweep(case, vary, "balance", load="20 N", execution=Execution(workers=0))

fig = plot.sweep(result)
