"""
From zero speed to full speed and back
======================================

``runup`` follows the loaded journal through its speeds: friction torque, contact fraction, film thickness, position.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 16})
result = petalfoil.runup(case, "10 N", to="40000 rpm", points=8)

fig = plot.runup(result)
