"""States of a path with friction handed over from contacts at nodes to contact lines in 3-D, and back.

Friction forces stay, and the petals go to where these hold them with the other contacts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.line_friction_path import slide_on_lines
from petalfoil.equilibrium.pack_at_rest import resting
from petalfoil.equilibrium.rubbing_lines import RubbingLines, places
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.travelling_contacts import turning_compliance
from petalfoil.physics.contact_points import IsolatedContacts
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.constraints import constrain
from petalfoil.system.foil_pack import FoilPackProblem
from petalfoil.system.friction import FrictionState, against_slip, slips

Array = NDArray[np.float64]


def on_lines(friction: Friction, pack: FoilPackProblem, nodal: FrictionResult) -> RubbingLines | None:
    """A state with contacts at nodes with contact lines that keep its friction forces; None where none are near it."""
    if not constrain(pack.G, nodal.active).determinate:
        return None
    begin = placed_on_lines(friction, pack, nodal)
    found = slide_on_lines(pack, begin, current_run().pack_solver, rubs=False)
    return None if found is None else replace(found, lost=nodal.lost)


def placed_on_lines(friction: Friction, pack: FoilPackProblem, nodal: FrictionResult) -> RubbingLines:
    """A state with contacts at nodes, its isolated ones at the points where they are (K8)."""
    contacts, none = pack.layout.wall.contacts, np.zeros(0, dtype=np.intp)
    isolated = IsolatedContacts.of(contacts, pack.gaps(nodal.x), nodal.lam, nodal.active)
    matrix = pack.linearize(nodal.x).matrix(np.zeros(len(nodal.active)))
    placed = isolated.placed(turning_compliance(pack.G, matrix, isolated, pack.elimination_key))
    groups, held = list(enumerate(placed.groups)), placed.at_nodes
    points = LinePoints(
        contacts.lines,
        len(contacts.rest),
        np.concatenate([none, *(np.full(len(group.line), kind) for kind, group in groups)]),
        np.concatenate([none, *(group.line for _, group in groups)]),
        np.concatenate([np.zeros(0), *(group.position for _, group in groups)]),
    )
    reaction = np.concatenate([np.zeros(0), *(group.reaction for _, group in groups)])
    force = np.zeros((friction.directions, np.count_nonzero(held) + len(reaction)))
    own = nodal.x, points, reaction, held, nodal.lam[held]
    state = RubbingLines(pack.coupled, *own, load=None, pack=pack, friction=friction, force=force)
    return replace(state, force=at_nearest_contacts(state, forces_at_gaps(friction, nodal.friction.force)))


def forces_at_gaps(friction: Friction, force: Array) -> Array:
    """Friction forces of the sliding cells (k,) on the gaps that load them, (directions, m)."""
    count = len(force) // friction.directions
    share = friction.reaction_share[:count]
    return np.stack([share.T @ part for part in force.reshape(friction.directions, count)])


def at_nearest_contacts(state: RubbingLines, forces: Array) -> Array:
    """Forces at the gaps (2, m) at the contacts nearest to them on their lines, (2, j + k)."""
    pulled = np.any(forces != 0.0, axis=0)
    count = np.count_nonzero(pulled)
    every, (own, place) = places(replace(state, held=pulled, held_reaction=np.zeros(count))), places(state)
    line, phi = (part[:count] for part in every)
    out = np.zeros((len(forces), len(own)))
    if not len(own) or not count:
        return out
    apart = np.abs(phi[:, None] - place)
    apart[line[:, None] != own] = np.inf
    near = np.argmin(apart, axis=1)
    known = np.isfinite(apart[np.arange(count), near])
    for each, force in zip(out, forces[:, pulled], strict=True):
        np.add.at(each, near[known], force[known])
    return out


def lines_at_nodes(friction: Friction, state: RubbingLines, pack: FoilPackProblem) -> FrictionResult | None:
    """A state on contact lines at the nodes of its `pack`, under the same friction forces; None if none was found."""
    share = friction.reaction_share[: friction.reaction_share.shape[0] // friction.directions]
    force = np.concatenate([share @ state.at_gaps(part) for part in state.force])
    contacts = resting(replace(pack, load=-against_slip(friction, force, pack.layout.n_wall)))
    if contacts is None:
        return None
    x, lam = contacts.x, contacts.lam
    kept = FrictionState(slips(friction, x), force, friction.coefficient * friction.normal(lam))
    return FrictionResult(x, lam, contacts.active, contacts.state.residual, kept, state.lost)
