"""WHAT bounds the film. Each wall is one file that fills one small protocol.

=============  =====================================================================
`wall.py`      the protocol: unknowns, stiffness, film over the wall, contacts
`petals.py`    a package of petals
`rigid.py`     a rigid bore: plain gas journal bearing
`registry.py`  case -> wall
=============  =====================================================================
"""

from petalfoil.walls.base import Wall
from petalfoil.walls.registry import build_wall

__all__ = ["Wall", "build_wall"]
