"""
Bearing force over displacement
===============================

``curve`` follows the equilibrium while the journal is displaced.
"""

import petalfoil
from petalfoil import plot

coarse = {"model.cells_per_pitch": 32}
cases = {n: petalfoil.Case.load(f"../paper_n{n}.toml").replace(**coarse) for n in (8, 10)}
result = petalfoil.curve(cases[8], "0 um : 240 um : 5")

fig = plot.curve(result)

# %%
# Several bearings in one diagram.

other = petalfoil.curve(cases[10], "0 um : 240 um : 5")
characteristics = plot.load_characteristic([("8 petals", result), ("10 petals", other)])
