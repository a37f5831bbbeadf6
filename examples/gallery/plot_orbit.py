"""
A rotor in time
===============

``orbit`` releases an unbalanced rotor and follows it, with film, petals and contacts.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../orbit_n8.toml").replace(**{"model.cells_per_pitch": 16})
result = petalfoil.orbit(case, revolutions=8, tolerance=1e-2)

fig = plot.orbit(result)

# %%
# Its parts: the path of the journal's centre, histories, energy balance, spectrum, spectrum over time.

path = plot.orbit_path(result)

# %%

histories = plot.orbit_histories(result)

# %%

energy = plot.orbit_energy(result)

# %%

spectrum = plot.orbit_spectrum(result)

# %%

waterfall = plot.orbit_waterfall(result)
