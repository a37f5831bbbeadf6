"""
Campbell diagram of a rotor in two bearings
===========================================

``stability`` with several speeds and a mass gives the natural modes over speed: cylindrical and conical, forward and
backward, with their damping. Crossings with the speed are marked.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../plain_journal.toml").replace(
    **{
        "model.cells_per_pitch": 32,
        "model.axial_cells": 8,
        "rotor": {"mass": "6 kg", "span": "0.3 m", "transverse_inertia": "0.2 kg*m^2", "polar_inertia": "0.01 kg*m^2"},
    }
)
result = petalfoil.stability(case, load="60 N", mass="6 kg", speeds="2000 rpm : 20000 rpm : 10")

fig = plot.campbell(result)
