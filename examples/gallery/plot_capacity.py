"""
Load capacity
=============

``capacity`` finds the largest load that keeps to a minimum film thickness, over speed and over
the direction of the load to the petals.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml").replace(**{"model.cells_per_pitch": 16})
result = petalfoil.capacity(case, min_film_thickness="4 um", speeds="60000 rpm : 80000 rpm : 3", orientations=4)

fig = plot.capacity(result)
