"""
Film and petals at one position
===============================

``solve`` finds film, bending and contacts with the journal held: pressure and film thickness around the bearing.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 64})
result = petalfoil.solve(case.replace(**{"operation.eccentricity": ["0 um", "-200 um"]}))

fig = plot.summary(result)

# %%
# The deformed petals alone, with the film stretched so that it can be seen.

section = plot.cross_section(result)

# %%
# Section, pressure and film thickness in one figure.

point = plot.operating_point(result)

# %%
# Pressure and film thickness alone, for a paper.

lines = plot.pressure_and_film(result)
