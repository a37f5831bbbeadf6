"""WHERE the equations live: one pitch of the package, repeated.

===============  ==========================================================================
`pitch.py`       one pitch divided at the fraction `f`; the nodes of a petal
`quadrature.py`  weights that turn values at nodes into integrals
`axial.py`       nodes and integration lengths along the shaft (one station, half, whole)
`package.py`     petals and exposed strips on those nodes; who touches whom
`strips.py`      the film's own view: strips, their control volumes, their pressure unknowns
===============  ==========================================================================

Axis order everywhere: ``(petal, node, axial)``; a strip holds the last pitch of its petal's nodes.
"""

from petalfoil.mesh.axial import AxialGrid
from petalfoil.mesh.package import PackageMesh
from petalfoil.mesh.strips import FilmMesh

__all__ = ["AxialGrid", "FilmMesh", "PackageMesh"]
