"""States of a path with friction handed over from contacts at nodes to contact lines in 3-D, and back.

Friction forces stay, and the petals go to where these hold them with the other contacts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.equilibrium.line_friction_path import slide_on_lines
from petalfoil.equilibrium.line_sets import points_on_lines
from petalfoil.equilibrium.pack_on_lines import PackOnLines
from petalfoil.equilibrium.rubbing_line_tangent import OnPath
from petalfoil.equilibrium.rubbing_lines import RubbingLines, distances, places
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.travelling_contacts import turning_compliance
from petalfoil.physics.contact_points import IsolatedContacts
from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.line_points import LinePoints
from petalfoil.solvers.constraints import constrain
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.foil_pack import FoilPackProblem

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

OnLines = tuple[LinePoints, Array, Mask, Array]
"""Points and their reactions, contacts at nodes and theirs."""


def on_lines(friction: Friction, pack: FoilPackProblem, nodal: FrictionResult) -> PackOnLines | None:
    """A state with contacts at nodes with contact lines that keep its friction forces; None where none are near it."""
    if not constrain(pack.G, nodal.active).determinate:
        return None
    own = contacts_on_lines(pack, nodal)
    none_yet = np.zeros((friction.directions, len(own[1]) + len(own[3])))
    state = PackOnLines(pack.coupled, nodal.x, *own, None, pack=pack, friction=friction, friction_force=none_yet)
    begin = with_forces(state, nodal)
    found = slide_on_lines(begin, begin, current_run().pack_solver, rubs=False)
    return None if found is None else replace(found, lost=nodal.lost)


def on_lines_in_film(friction: Friction, problem: CoupledProblem, nodal: FrictionResult) -> RubbingLines | None:
    """The same under a film, the journal held where `problem` has it."""
    if not constrain(problem.G, nodal.active).determinate:
        return None
    own = contacts_on_lines(problem, nodal)
    none_yet = np.zeros((friction.directions, len(own[1]) + len(own[3])))
    begin = with_forces(RubbingLines(problem, nodal.x, *own, None, friction=friction, friction_force=none_yet), nodal)
    found = slide_on_lines(begin, begin, current_run().film_solver, rubs=False)
    return None if found is None else replace(found, lost=nodal.lost)


def contacts_on_lines(equations: FoilPackProblem | CoupledProblem, nodal: FrictionResult) -> OnLines:
    """Contacts of a state with contacts at nodes, its isolated ones at the points where they are (K8)."""
    contacts = equations.layout.wall.contacts
    isolated = IsolatedContacts.of(contacts, equations.gaps(nodal.x), nodal.lam, nodal.active)
    matrix = equations.linearize(nodal.x).matrix(np.zeros(len(nodal.active)))
    placed = isolated.placed(turning_compliance(equations.G, matrix, isolated, equations.elimination_key))
    (points, reaction), held = points_on_lines(contacts, placed), placed.at_nodes
    return points, reaction, held, nodal.lam[held]


def with_forces(state: OnPath, nodal: FrictionResult) -> OnPath:
    """A state with contact lines with the friction forces of one with contacts at nodes."""
    return replace(
        state, friction_force=at_nearest_contacts(state, forces_at_gaps(state.friction, nodal.friction.force))
    )


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
    line, phi = every[0][:count], every[1][:count]
    out = np.zeros((len(forces), len(own)))
    if not len(own) or not count:
        return out
    apart = distances((line, phi), (own, place))
    near = np.argmin(apart, axis=1)
    known = np.isfinite(apart[np.arange(count), near])
    for each, force in zip(out, forces[:, pulled], strict=True):
        np.add.at(each, near[known], force[known])
    return out


def forces_at_nodes(friction: Friction, state: RubbingLines) -> Array:
    """Friction forces of contacts on lines, each shared by the nodes beside it as its reaction is, (k,) [1]."""
    share = friction.reaction_share[: friction.reaction_share.shape[0] // friction.directions]
    return np.concatenate([share @ state.at_gaps(part) for part in state.friction_force])
