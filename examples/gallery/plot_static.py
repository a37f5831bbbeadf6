"""
The foil pack at zero speed
===========================

``static`` gives preload, force and starting torque without a film.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 16})
result = petalfoil.static(case, "0 um : 200 um : 5")

fig = plot.static(result)

# %%
# With friction between the petals, loading and unloading differ: the loop is the energy that is lost.

rough = {"surface.petal_friction": 0.3, "model.cells_per_pitch": 8}
six = petalfoil.Case.load("../paper_n6.toml").replace(**rough)
loop = petalfoil.static(six, "0 um : 100 um : 3", loop=True)
hysteresis = plot.hysteresis(loop)
