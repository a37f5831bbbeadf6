"""
A bearing of finite length
==========================

In the 3-D model pressure and film thickness vary along the axis, and gas leaves at the ends.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8_spatial.toml").replace(**{"model.cells_per_pitch": 16, "model.axial_cells": 8})
result = petalfoil.solve(case)

fig = plot.maps(result)

# %%
# One petal of the centred bearing at the mid-plane, as the paper draws it (its Figures 6 and 7).

centred = petalfoil.solve(case.replace(**{"operation.eccentricity": ["0 um", "0 um"]}))
profiles = plot.petal_profiles([("8 petals", centred)])
