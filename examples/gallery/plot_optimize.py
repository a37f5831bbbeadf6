"""
An optimum within limits
========================

``optimize`` finds the design whose results are best; here the largest force of a plain bearing within a power loss.
"""

import petalfoil
from petalfoil import plot
from petalfoil.studies.run import Execution

case = petalfoil.Case.load("../plain_journal.toml").replace(**{"model.kind": "2d", "model.cells_per_pitch": 24})
vary = {"operation.speed": "1000 rad/s : 9000 rad/s", "bearing.journal_radius": "24.95 mm : 24.97 mm"}
result = petalfoil.optimize(
    case,
    vary,
    maximize="bearing_force",
    subject=["power_loss < 30 W"],
    budget=40,
    execution=Execution(workers=0),
    eccentricity=(0.0, -10e-6),
)

fig = plot.optimum(result)
