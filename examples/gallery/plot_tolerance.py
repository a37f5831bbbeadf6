"""
Scatter of manufacture
======================

``tolerance`` draws bearings that scatter about the case and tells how likely they keep a limit.
"""

import petalfoil
from petalfoil import plot
from petalfoil.studies.run import Execution

case = petalfoil.Case.load("../plain_journal.toml").replace(**{"model.kind": "2d", "model.cells_per_pitch": 24})
scatter = {"bearing.journal_radius": "normal 0.5 um", "gas.viscosity": "± 2 %", "operation.speed": "± 5 %"}
limits = ["bearing_force > 165 N"]
result = petalfoil.tolerance(case, scatter, limits=limits, samples=64, execution=Execution(workers=0))

fig = plot.tolerance(result)
