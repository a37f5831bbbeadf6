"""
Which grid is fine enough
=========================

``converge`` solves the case on finer and finer grids and gives each quantity its grid-converged value and error bar.
"""

import petalfoil
from petalfoil import plot

case = petalfoil.Case.load("../paper_n8.toml")
result = petalfoil.converge(case, levels=3, coarsest=16)

fig = plot.convergence(result)
