"""WHAT bounds the film. Each wall is one file that fills one small protocol.

===================  ============================================================================
`kind.py`            the protocol of a kind of wall: how it is built, what it has and can do
`base.py`            a discretised wall: unknowns, film over the wall, contacts
`elasticity.py`      elastic forces from deflections
`petals.py`          a leaf pack
`between_grids.py`   its displacements on another grid
`element_pack.py`    the same in cubic elements, 2-D
`pack_slip.py`       slip at its contact points
`sliding.py`         a leaf pack whose petals move in their own surface and stretch, on nodes
`bump_foil.py`       a bump foil under a smooth top foil
`backing.py`         backing springs behind petals
`rigid.py`           a rigid bore: plain gas journal bearing
`tilting.py`         a wall under a journal whose axis is not parallel to it
`registry.py`        case -> wall; other kinds are registered at run time
===================  ============================================================================
"""

from petalfoil.walls.base import PlacedContacts, Wall, WallState
from petalfoil.walls.kind import Capability, WallKind
from petalfoil.walls.registry import build_wall, register, required, unregister, wall_kind, wall_kinds

__all__ = [
    "Capability",
    "PlacedContacts",
    "Wall",
    "WallKind",
    "WallState",
    "build_wall",
    "register",
    "required",
    "unregister",
    "wall_kind",
    "wall_kinds",
]
