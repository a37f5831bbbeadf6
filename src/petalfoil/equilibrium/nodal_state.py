"""Film, deflections and reactions of an equilibrium at the nodes of its grid, wherever its contacts are.

Contacts at nodes are there already. A contact point between two nodes is shared by them in proportion, which keeps its
force and its place. Deflections of Hermite elements are sampled at the nodes, with what point loads bend within their
own element (S7).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from petalfoil.equilibrium.small_motion import ElementEquilibrium, LineEquilibrium
from petalfoil.equilibrium.solution import RefinedState, Solution
from petalfoil.mesh import hermite
from petalfoil.physics.gap_curves import Facing
from petalfoil.physics.petal_elements import clamped_beam, clamped_beam_bend
from petalfoil.sparsity import add_up
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.film_rows import FilmState
from petalfoil.system.point_friction import RubbingEquations
from petalfoil.system.unknowns import DEFLECTION
from petalfoil.walls import PlacedContacts
from petalfoil.walls.element_pack import ElementLoads
from petalfoil.walls.pack_slip import membrane_of_pulls, stretched_along

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NodalState:
    """An equilibrium as results read it.

    Attributes
    ----------
    problem : CoupledProblem
        Speed, position and temperatures.
    film : FilmState
        Pressures and film thicknesses at all film nodes [1].
    deflection : (n_wall,) array
        Deflections [1].
    lam : (m,) array
        Reactions at the gaps, over the unit of nodal force [1].
    film_force, contact_force : (n_position,) array
        Forces on the journal over the unit of force [1].
    placed : PlacedContacts or None
        Contacts at their places, SI; None where they are at nodes.
    membrane : (petal, node) array or None
        Membrane force of petals that stretch by contacts between nodes in 2-D, over the width, SI.
    """

    problem: CoupledProblem
    film: FilmState
    deflection: Array
    lam: Array
    film_force: Array
    contact_force: Array
    placed: PlacedContacts | None = None
    membrane: Array | None = None

    @classmethod
    def of(cls, solution: Solution) -> NodalState:
        """The state that results are taken from: that with contacts between nodes, where the solution has it."""
        if solution.lines is not None:
            return cls.of_lines(solution.lines)
        return cls.at_nodes(solution) if solution.elements is None else cls.of_elements(solution.elements, solution)

    @classmethod
    def at_nodes(cls, solution: Solution) -> NodalState:
        """The state of an equilibrium with contacts at nodes; deflections to the last digit of each."""
        problem, x = solution.problem, solution.x
        film = problem.layout.film_rows.at(problem.pressure(x), problem.film(x), problem.film_number)
        deflection = solution.deflection + solution.state.low_order
        return cls(problem, film, deflection, solution.lam, problem.film_force(x), problem.contact_force(solution.lam))

    @classmethod
    def of_lines(cls, found: LineEquilibrium) -> NodalState:
        """The state of an equilibrium whose contact lines cross the stations between nodes."""
        problem, x = found.problem, found.x
        film = problem.layout.film_rows.at(problem.pressure(x), problem.film(x), problem.film_number)
        deflection = x[problem.layout.unknowns[DEFLECTION]]
        return cls(problem, film, deflection, found.shared, problem.film_force(x), problem.contact_force(found.lam))

    @classmethod
    def of_elements(cls, found: ElementEquilibrium, solution: Solution) -> NodalState:
        """The state of petals with continuous slopes, which a `solution` that is sampled from them has at its nodes."""
        equations = found.equations
        problem = equations.problem
        by_film = problem.layout.border.row_derivative @ (equations.pressures - 1.0)
        if solution.sampled is found:
            deflection, lam = solution.deflection[: found.pack.at_nodes.shape[0]], solution.lam
        else:
            deflection, lam = sampled_deflection(found), shared_reactions(found)
        by_contact, membrane = equations.force - by_film, membrane_of(found)
        return cls(problem, equations.film, deflection, lam, by_film, by_contact, placed_contacts(found), membrane)


FOLLOWED = "followed from a neighbour with contact points"
"""How a solution was reached whose state at the nodes is only sampled."""


def sampled_solution(found: ElementEquilibrium, load: Array | None) -> Solution:
    """The solution of an equilibrium with contact points, no equilibrium with contacts at nodes beside it.

    `load` (n_position,) is what it carries, if anything. The state at its nodes is that of its elements: a start for
    others.
    """
    problem = found.equations.problem
    nodal = RefinedState(unknowns_at_nodes(found), np.zeros(problem.layout.n_wall), shared_reactions(found))
    return Solution(
        problem, nodal, found.residual, FOLLOWED, load=load, elements=found, elements_sought=True, sampled=found
    )


def sampled_lines(found: LineEquilibrium, load: Array | None) -> Solution:
    """The solution of an equilibrium with contact lines, no equilibrium with contacts at nodes beside it."""
    nodal = RefinedState(found.x, np.zeros(found.problem.layout.n_wall), found.shared)
    return Solution(found.problem, nodal, found.residual, FOLLOWED, load=load, lines=found, elements_sought=True)


def with_motion_along(stiffness: sp.csr_array, deflection: Array) -> Array:
    """All unknowns of the petals (n_wall,) at a deflection.

    Behind the deflections are the displacements of petals that stretch in their own surface, on which nothing but the
    membrane acts (M5): what bending asks of them; none of petals that only bend.
    """
    n = len(deflection)
    if stiffness.shape[0] == n:
        return deflection
    own, by_deflection = stiffness[n:, n:], stiffness[n:, :n]
    return np.concatenate([deflection, spla.spsolve(sp.csc_array(own), -(by_deflection @ deflection))])


def unknowns_at_nodes(found: ElementEquilibrium) -> Array:
    """All unknowns (n,) of a state with contacts between nodes at the nodes [1]."""
    problem = found.equations.problem
    x = np.zeros(problem.layout.n)
    x[problem.layout.unknowns[DEFLECTION]], x[problem.positive] = wall_at_nodes(found), found.equations.pressures
    return x


def wall_at_nodes(found: ElementEquilibrium) -> Array:
    """All unknowns of the petals (n_wall,) at the nodes [1]: with what friction at contact points stretches them by."""
    equations, layout = found.equations, found.equations.problem.layout
    wall = with_motion_along(layout.stiffness, sampled_deflection(found))
    if isinstance(equations, RubbingEquations):
        scales = layout.scales
        along = stretched_along(found.pack, found.points, equations.friction_force * scales.force)
        wall[-along.size :] += along.ravel() / scales.length
    return wall


def membrane_of(found: ElementEquilibrium) -> Array | None:
    """Membrane force over the width at the nodes of petals that stretch, (petal, node) [N/m]; None of others.

    By friction between petals, which equilibria without a path do not have, and of a journal that drags them (D6).
    """
    equations, points = found.equations, found.friction_points
    layout = equations.problem.layout
    if layout.n_wall == found.pack.at_nodes.shape[0]:
        return None
    drag, unit = equations.journal_friction * points.reaction, layout.scales.force
    friction = equations.friction_force if isinstance(equations, RubbingEquations) else np.zeros(len(drag))
    return membrane_of_pulls(found.pack, points, friction * unit, drag * unit)


def shared_reactions(found: ElementEquilibrium) -> Array:
    """Reactions of contact points, each shared by the two nodes beside it, (m,) [1]."""
    points, pack, contacts = found.points, found.pack, found.equations.problem.layout.wall.contacts
    lam = np.zeros(len(contacts.rest))
    kinds, lines = np.divmod(points.every_curve, pack.mesh.count)
    for kind, nodes in enumerate(pack.nodes.values()):
        mine = kinds == kind
        gap_line, phi = contacts.lines[kind], pack.elements.phi[nodes]
        angle = np.interp(points.every_position[mine], np.arange(len(phi), dtype=np.float64), phi)
        cell, share = hermite.located(angle, gap_line.phi)
        numbers, reaction = gap_line.number[lines[mine]], points.reaction[mine]
        row = np.arange(len(cell))
        np.add.at(lam, numbers[row, cell], (1.0 - share) * reaction)
        np.add.at(lam, numbers[row, cell + 1], share * reaction)
    return lam


def sampled_deflection(found: ElementEquilibrium) -> Array:
    """Deflections at the nodes of the pack, (n_wall,) [1], bending by the loads within each element (S7) included."""
    pack, scales, (element, t) = found.pack, found.equations.problem.layout.scales, found.pack.node_places
    bent = (pack.bent_at_nodes @ pressing(found).ravel()).reshape(pack.mesh.count, -1)
    for loads in pack.contact_places(found.points):
        load, node = np.nonzero(loads.element[:, None] == element)
        bend = loads.force[load] * clamped_beam(t[node], loads.place[load])
        petal = loads.petal[load]
        np.add.at(bent, (petal, node), pack.compliance[petal, element[node]] * bend)
    return np.asarray(pack.at_nodes @ found.equations.deflection + (scales.force / scales.length) * bent.ravel())


def pressing(found: ElementEquilibrium) -> Array:
    """Forces of the film on the nodes of all petals, roots apart, (petal, node) [1]; none along the petals."""
    equations, mesh = found.equations, found.pack.mesh
    forces = equations.problem.layout.push @ (equations.pressures - 1.0)
    return np.asarray(forces[: mesh.count * (mesh.n_node - 1)].reshape(mesh.count, -1))


def nodal_deflection(found: ElementEquilibrium) -> Array:
    """(value, slope) at the nodes of all petals, (petal, 2 n_node) [1]."""
    return np.asarray((found.pack.nodal @ found.equations.deflection).reshape(found.pack.mesh.count, -1))


def placed_contacts(found: ElementEquilibrium) -> PlacedContacts:
    """Contact points at their places, with the curvature of the petals there, SI."""
    pack, points, scales = found.pack, found.points, found.equations.problem.layout.scales
    facing, petal = np.divmod(points.every_curve, pack.mesh.count)
    curvature = np.full((len(petal), 2), np.nan)
    own, below = pack.contact_places(points)
    angle = pack.elements.angle_at(own.element, own.place)
    lies = facing == list(pack.nodes).index(Facing.PETAL)
    curvature[:, 0], curvature[lies, 1] = curvatures(found, own), curvatures(found, below)
    return PlacedContacts(petal, facing, angle, points.reaction * scales.force, curvature)


def curvatures(found: ElementEquilibrium, at: ElementLoads) -> Array:
    """Change of curvature of petals (S6) at places within elements, (k,) [1/m], by all loads within an element."""
    pack, equations = found.pack, found.equations
    layout, angle = equations.problem.layout, pack.elements.element_angle[at.element]
    nodal = nodal_deflection(found)[at.petal[:, None], 2 * at.element[:, None] + np.arange(4)]
    nodal[:, 1::2] *= angle[:, None]
    value, second = (np.einsum("ki,ki->k", hermite.basis(at.place, k), nodal) for k in (0, 2))
    element, t = pack.node_places
    here, node = np.nonzero(at.element[:, None] == element)
    by_film = pressing(found)[at.petal[here], node] * clamped_beam_bend(at.place[here], t[node])
    bent = add_up(here, by_film, len(at.petal))
    for loads in pack.contact_places(found.points):
        here, load = np.nonzero((loads.petal == at.petal[:, None]) & (loads.element == at.element[:, None]))
        by_point = loads.force[load] * clamped_beam_bend(at.place[here], loads.place[load])
        bent += add_up(here, by_point, len(at.petal))
    C = pack.compliance[at.petal, at.element] * layout.scales.force
    r_m, R_p = (
        np.array([getattr(petal, name) for petal in pack.petals])[at.petal] for name in ("metric_radius", "bend_radius")
    )
    length = layout.scales.length
    return np.asarray((length * second + C * bent) / (r_m * angle) ** 2 + length * value / R_p**2)
