"""WHAT bounds the film. Each wall is one file that fills one small protocol.

=============  =====================================================================
`wall.py`      the protocol: unknowns, stiffness, film over the wall, contacts
`petals.py`    a package of petals
`rigid.py`     a rigid bore: plain gas journal bearing
`registry.py`  case -> wall
=============  =====================================================================
"""

from petalfoil.structure.registry import build_wall
from petalfoil.structure.wall import Wall

__all__ = ["Wall", "build_wall"]
