"""
A sample of several parameters
==============================

A Latin hypercube of a plain bearing: each line is a case, and a panel for each pair of parameter and result.
"""

import petalfoil
from petalfoil import plot
from petalfoil.studies.run import Execution

case = petalfoil.Case.load("../plain_journal.toml").replace(**{"model.kind": "2d", "model.cells_per_pitch": 32})
vary = {
    "bearing.journal_radius": "24.95 mm : 24.97 mm",
    "operation.speed": "20000 rpm : 60000 rpm",
    "operation.eccentricity.y": "-25 um : -5 um",
}
result = petalfoil.sweep(case, vary, sample="lhs 40", execution=Execution(workers=0))

fig = plot.parallel_coordinates(result)

# %%
# Which parameter moves which result.

matrix = plot.scatter_matrix(result, ("bearing_force", "min_film_thickness"))
