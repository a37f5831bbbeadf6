"""
The assembled foil pack
=======================

``check`` derives the geometry of a case and assembles the petals around the journal at zero speed.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 32})
result = petalfoil.check(case)

fig = plot.pack(result)

# %%
# Any result can be drawn as a table of its quantities.

quantities = plot.quantities(result)
