"""
Stiffness and damping over whirl frequency
==========================================

``coefficients`` linearises film, petals and contacts about the equilibrium.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 32})
result = petalfoil.coefficients(case, "500 rad/s : 16000 rad/s : 24", load="20 N")

fig = plot.coefficients(result)
