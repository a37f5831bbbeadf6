"""A step of Newton's method with Coulomb friction at contact points: contacts stick or slip as the linear rows ask for.

Columns of one factor tell what unit friction forces do to film, petals and journal, reactions and slips among it. The
law of all contacts is then a small dense problem (M6), whose contacts do not open: a reaction that pulls limits
friction to zero, which is (M6) of a contact whose opening is its pull. It leaves by its sign once the stage has
settled (`contact_sets.revised`).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Self

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError, unbalanced
from petalfoil.solvers.coulomb import ContactForces, ContactSpace, KnownForces, States, contact_forces
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.friction import slips_forward
from petalfoil.system.point_friction import PointFriction, RubbingEquations

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class RubbingTangent(ElementTangent):
    """The tangent, and what unit friction forces of the contacts do.

    Attributes
    ----------
    changes : (n, j) array
        Changes of the unknowns, the journal following.
    moves : (d, j) array
        Changes of the journal's position.
    """

    changes: Array
    moves: Array

    @classmethod
    def about(cls, equations: RubbingEquations, load: Array | None, solver: LinearSolver) -> Self:
        """Factorise at a state; without a load the journal stays where it is.

        Raises
        ------
        NoPointsError
            The contacts do not determine the petals, or the load not the journal's position.
        """
        plain = ElementTangent.at(equations, load, solver)
        forces = np.zeros((equations.n, len(equations.friction_force)))
        forces[: equations.whole.n_wall] = equations.rubbed.T.toarray()
        own = plain.factor.solve(-forces)
        parts = {each.name: getattr(plain, each.name) for each in fields(ElementTangent)}
        if load is None:
            return cls(**parts, changes=own, moves=np.zeros((len(equations.problem.displacement), own.shape[1])))
        try:
            moves = np.linalg.solve(plain.gradient, -plain.rows @ own)
        except np.linalg.LinAlgError:
            raise NoPointsError("the load does not determine the journal's position") from None
        return cls(**parts, changes=own + plain.units @ moves, moves=moves)

    def step(
        self, equations: RubbingEquations, friction: PointFriction, load: Array | None
    ) -> tuple[tuple[Array, Array], Array]:
        """Changes of unknowns and position at a state, and the friction forces (j,) that go with them.

        Raises
        ------
        NoPointsError
            No state of the contacts, sticking or slipping, is consistent.
        """
        change, move = self.correction(equations.newton_residual, unbalanced(equations, load))
        rubs = friction.rubs(equations.state.points)
        force = equations.friction_force.copy()
        if len(rubs):
            force[rubs] = self.settled(equations, friction, change, rubs).friction
        more = force - equations.friction_force
        return (change + self.changes @ more, move + self.moves @ more), force

    def settled(
        self, equations: RubbingEquations, friction: PointFriction, change: Array, rubs: Index
    ) -> ContactForces:
        """Friction forces of the contacts `rubs` (k,) after a `change` (n,) that their forces add to.

        Raises
        ------
        NoPointsError
            They are not found.
        """
        whole, state, force = equations.whole, equations.state, equations.friction_force[rubs]
        first, slip = whole.n_wall + whole.n_film, friction.slip(state, equations.friction_force)
        places = (slip.by_place @ state.points.spread) * equations.travels

        def slipped(changes: Array) -> Array:
            """Change of all slips, (j, ...), by changes of the unknowns."""
            return np.asarray(slip.rows @ changes[: whole.n_wall] + places @ changes[equations.n - len(places.T) :])

        by_force = (slipped(self.changes) - slip.compliance)[np.ix_(rubs, rubs)]
        grip, none = self.changes[np.ix_(first + rubs, rubs)], np.zeros((len(rubs), len(rubs)))
        held = np.ones(len(rubs), dtype=bool)
        answer, slides = np.hstack([np.eye(len(rubs)), grip]), np.hstack([none, by_force])
        space = ContactSpace(held, answer, slides, np.arange(len(rubs)), friction.coefficient)
        reaction = state.points.reaction[rubs]
        without = (
            reaction + change[first + rubs] - grip @ force,
            (slip.value + slipped(change))[rubs] - by_force @ force,
        )
        # A contact that pulls is known as open by its pull: closed without a reaction it would be at the margins of
        # three states at once, and the way from what is known would try them one after another.
        states = States(reaction > 0.0, slips_forward(force, friction.limit(state.points)[rubs]))
        normal, tangential = (-reaction, reaction), (force, slip.value[rubs])
        found = contact_forces(space, without, KnownForces.of(space, states, normal, tangential))
        if found is None:
            raise NoPointsError("no contacts, sticking or slipping, carry the friction of a stage")
        return found
