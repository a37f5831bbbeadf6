"""
Stability of a rigid rotor
==========================

``stability`` gives critical mass, whirl ratio and threshold speed; of a rotor of given mass also its natural modes.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../plain_journal.toml").replace(**{"model.cells_per_pitch": 32, "model.axial_cells": 8})
result = petalfoil.stability(case, load="30 N", mass="3 kg")

fig = plot.stability(result)
