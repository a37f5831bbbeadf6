"""States of a path with friction handed over from contact points to nodes, and back.

Friction forces stay, and the petals go to where these hold them on the other grid: contacts that stick are so stiff
that places which differ by what two grids differ by would change the forces up to their limit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.contact_runs import at_nearest_points, from_active_nodes
from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.line_handover import forces_at_nodes
from petalfoil.equilibrium.nodal_state import shared_reactions
from petalfoil.equilibrium.pack_at_rest import resting
from petalfoil.equilibrium.pack_on_lines import PackOnLines
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.point_friction_path import RubbingPoints
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionState, against_slip, slips
from petalfoil.system.point_equations import PointState
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]

PathState = FrictionResult | RubbingPoints | PackOnLines
"""A state of a path, wherever its contacts are."""


def at_nodes(friction: Friction, reached: RubbingPoints | PackOnLines, pack: FoilPackProblem) -> FrictionResult | None:
    """A state with contact points at the nodes of its `pack`, under the same friction forces; None if none was found.

    Forces are shared by the nodes beside each point as reactions are.
    """
    if isinstance(reached, PackOnLines):
        force = forces_at_nodes(friction, reached)
    else:
        force = shared_friction(friction, reached)
    contacts = resting(replace(pack, load=-against_slip(friction, force, pack.layout.n_wall)))
    if contacts is None:
        return None
    x, lam = contacts.x, contacts.lam
    kept = FrictionState(slips(friction, x), force, friction.coefficient * friction.normal(lam))
    return FrictionResult(x, lam, contacts.active, contacts.state.residual, kept, reached.lost)


def shared_friction(friction: Friction, reached: RubbingPoints) -> Array:
    """Friction forces of contact points, each shared by the two nodes beside it, (k,) [1]."""
    state = reached.state
    pulls = replace(state, points=replace(state.points, reaction=reached.force))
    found = PointContacts(replace(reached.equations, state=pulls), reached.residual)
    return np.asarray(friction.reaction_share @ shared_reactions(found))


def at_points(whole: PointLayout, friction: Friction, nodal: FrictionResult) -> tuple[PointState, Array]:
    """A state with contacts at nodes with its active nodes as points, under a film at rest; friction forces (j,)."""
    wall = nodal.x[: whole.layout.n_wall]
    points = from_active_nodes(whole, nodal.lam, nodal.active)
    state = PointState(whole.pack.from_nodes(wall), np.ones(whole.n_film), points)
    return state, at_nearest_points(whole, points, friction.reaction_share.T @ nodal.friction.force)
