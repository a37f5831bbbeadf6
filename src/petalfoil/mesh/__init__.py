"""The grids: nodes of the petals and of the film, around the circle and along the shaft.

===============  ======================================================================================
`pitch.py`       division of one pitch, and the nodes of a petal
`quadrature.py`  weights that turn nodal values into integrals
`axial.py`       axial nodes: one station (2-D), half the length or the whole length (3-D)
`hermite.py`     cubic elements with continuous slopes
`splines.py`     cubic curves through values at nodes
`pack.py`        nodes of all petals; which nodes face the film, the bushing and the neighbouring petal
`strips.py`      film strips and their pressure unknowns
===============  ======================================================================================

The axes of every nodal array are ``(petal, node, axial)``. A film strip holds the nodes of the last pitch of its petal.
"""

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.pack import PackMesh
from petalfoil.mesh.strips import FilmMesh

__all__ = ["AxialGrid", "FilmMesh", "PackMesh"]
