"""
Which parameter matters
=======================

Sobol' indices: the part of the variance of a result that each parameter explains, alone and with the others.
"""

import petalfoil
from petalfoil import plot
from petalfoil.studies.run import Execution

case = petalfoil.Case.load("../plain_journal.toml").replace(**{"model.kind": "2d", "model.cells_per_pitch": 16})
vary = {"bearing.journal_radius": "24.95 mm : 24.96 mm", "gas.viscosity": "± 10 %", "operation.speed": "± 10 %"}
result = petalfoil.sobol_indices(case, vary, samples=16, execution=Execution(workers=0))

fig = plot.sobol(result, ("bearing_force", "power_loss"))
