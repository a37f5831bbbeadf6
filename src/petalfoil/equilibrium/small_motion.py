"""What is asked of the linear response of film, wall and contacts to a small motion of the journal.

Two kinds answer: contacts at nodes (`linear_response.py`) and contact points with places of their own
(`point_response.py`).
"""

from __future__ import annotations

from typing import Any, Protocol, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.physics.dry_friction import Friction
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.reduced_model import MovedSystem
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.film_rows import FilmState
from petalfoil.system.point_layout import PointLayout
from petalfoil.walls.element_pack import ElementPack

Array = NDArray[np.float64]
Values = NDArray[Any]
"""Real at zero frequency, complex otherwise."""

AT_POINTS = "contact points on petals with continuous slopes"
AT_ASPERITIES = "contact pressures over asperities of 5 nm, petals with continuous slopes"
AT_NODES = "contacts at nodes, isolated ones moved between them"
"""Where the contacts of a linear response are."""

ON_LINES = "contact lines that cross axial stations between nodes"
HELD_AT_NODES = "contacts at nodes"
"""Where those of an equilibrium are that has no elements."""


class TangentEquations(Protocol):
    """Equations of film and petals at an equilibrium, and their tangent in all unknowns, deflections first."""

    def with_film(self, thickness: Array) -> TangentEquations:
        """The same at a given film thickness (strip, node, axial) [1], which does not follow petals and journal."""

    @property
    def n(self) -> int:
        """All unknowns."""

    @property
    def problem(self) -> CoupledProblem:
        """Speed and position."""

    @property
    def whole(self) -> PointLayout:
        """What stays the same."""

    @property
    def nodal_gaps(self) -> Array:
        """Nodal (value, slope) of all gap curves, (2 n_node,) [1]."""

    @property
    def film_thickness(self) -> Array:
        """Film over the reference length [1]."""

    @property
    def steady(self) -> sp.csc_array:
        """The tangent, (n, n)."""

    @property
    def stored(self) -> sp.csc_array:
        """Derivative of what the film stores, (n, n)."""

    def forcing(self, rate: float = 0.0) -> Array:
        """Derivative of the rows by the journal's displacement, with `rate` times that of what the film stores."""

    @property
    def force_rows(self) -> Array:
        """Derivative of the force on the journal by the unknowns, (n_position, n)."""

    @property
    def force_direct(self) -> Array:
        """Derivative of the force on the journal by its displacement, unknowns held, (n_position, n_position)."""

    @property
    def force(self) -> Array:
        """Force of film and contacts on the journal over the unit of force, (n_position,) [1]."""

    @property
    def film(self) -> FilmState:
        """The film's rows."""

    @property
    def deflection(self) -> Array:
        """Unknowns of the petals, (n_wall,) [1]."""

    @property
    def pressures(self) -> Array:
        """Pressure unknowns, (n_film,) [1]."""

    @property
    def journal_friction(self) -> float:
        """Coefficient of friction of a journal that turns and drags petals along; 0 where it does not [1]."""

    @property
    def newton_residual(self) -> Array:
        """Residual of Newton's method, (n,)."""

    @property
    def newton_force(self) -> Array:
        """Force on the journal that Newton's method balances, (n_position,) [1]: with reactions that are to follow."""

    @property
    def wall_forces(self) -> tuple[Array, Array, Array]:
        """Generalised forces on the petals: elastic, by pressure and contacts, and magnitudes of these, (n_wall,)."""


class ElementEquilibrium(Protocol):
    """An equilibrium of petals with continuous slopes."""

    @property
    def equations(self) -> TangentEquations:
        """The equations at its state."""

    @property
    def pack(self) -> ElementPack:
        """Its petals."""

    @property
    def points(self) -> ContactPoints:
        """Its contacts, as points."""

    @property
    def friction_points(self) -> ContactPoints:
        """Points at which friction between petals acts."""

    @property
    def residual(self) -> float:
        """Largest scaled residual."""

    @property
    def gradient(self) -> Array | None:
        """Force by the journal's position under a load, (n_position, n_position); None where it was not asked for."""

    @property
    def contact_model(self) -> str:
        """Where its contacts are, for people."""

    def at(self, problem: CoupledProblem, load: Array | None = None) -> ElementEquilibrium:
        """The equilibrium of a neighbouring problem; under a load from there."""

    @property
    def gaps(self) -> tuple[Array, NDArray[np.bool_]]:
        """Gaps along all curves over the reference length [1], and which of them are beside a contact, (sample,)."""

    def under(self, whole: PointLayout, problem: CoupledProblem) -> ElementEquilibrium:
        """The same state under other equations with as many elements, unsolved."""

    def moved(self, problem: CoupledProblem, change: Array) -> ElementEquilibrium:
        """The state after a small `change` (n,) of the unknowns, under the equations of `problem`, unsolved."""

    def nonlinearity(self, moved: Self) -> float:
        """How far contacts leave their tangent on the way to a state `moved`; 1 is far [1]."""


class LineEquilibrium(Protocol):
    """An equilibrium in 3-D whose contact lines cross the axial stations between nodes."""

    @property
    def problem(self) -> CoupledProblem:
        """Speed and position."""

    @property
    def x(self) -> Array:
        """Unknowns, (n,) [1]."""

    @property
    def lam(self) -> Array:
        """Reactions at the nodes that do the same work, (m,) [1]."""

    @property
    def shared(self) -> Array:
        """Reactions shared by the nodes beside each point, none of them below zero, (m,) [1]."""

    @property
    def active(self) -> NDArray[np.bool_]:
        """Contacts at nodes that are nearest to these, (m,)."""

    @property
    def force(self) -> Array:
        """Force of film and contacts on the journal over the unit of force, (n_position,) [1]."""

    @property
    def residual(self) -> float:
        """Largest scaled residual."""

    @property
    def motion(self) -> Motion:
        """Small motions about it."""

    def under(self, problem: CoupledProblem, load: Array | None) -> LineEquilibrium:
        """The same state under other equations on a grid of the same shape, unsolved."""

    def foretold(self, more: Array, faster: float = 0.0) -> LineEquilibrium:
        """The state under `more` load (n_position,) and a part `faster`, by the tangent alone; one factorisation."""


class ForceGradient(Protocol):
    """Response of the bearing, or of both bearings of a shaft, at one rate of change."""

    @property
    def force_gradient(self) -> Values:
        """`dF/de` of film and contacts on the journal, (n_position, n_position), over unit of force and length [1]."""

    def slope(self) -> Values:
        """Derivative of `dF/de` by `s` [1]."""


class Response(ForceGradient, Protocol):
    """Response to the journal's displacement at one state and frequency."""

    @property
    def units(self) -> Values:
        """Change of the unknowns, deflections first, by a unit of each coordinate of the journal, (n, n_position)."""

    def moved(self, forces: Values) -> Values:
        """Change of the unknowns by forces on them, the journal held in place; (n, k) each."""

    def forced(self, force: Values) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and force on the journal held in place (n_position,), by forces (n,) on them."""


class JournalMotion(Protocol):
    """Small motions of a journal in its bearing, or of a shaft in two: what an impedance is of."""

    @property
    def problem(self) -> CoupledProblem:
        """Speed and position, those of the first of two bearings, whose units hold."""

    @property
    def contact_model(self) -> str:
        """Where the contacts are, for people."""

    @property
    def film_thickness(self) -> Array:
        """Film over the reference length [1]."""

    @property
    def loss(self) -> sp.csc_array | None:
        """What a wall that loses energy adds to the tangent, times `i`, (n, n); None of others."""

    def moved_system(self, solver: LinearSolver) -> MovedSystem:
        """The same for a reduced model; one factorisation for each bearing."""

    def growing(self, s: complex, solver: LinearSolver) -> ForceGradient:
        """The response to a motion in `exp(s tau)`; one factorisation for each bearing."""


class Motion(JournalMotion, Protocol):
    """The system about one equilibrium, whatever the frequency."""

    @property
    def stuck(self) -> Friction | None:
        """Friction in contacts that carry load and stick; None without any."""

    @property
    def frictionless(self) -> Self:
        """The same, petals sliding freely on each other."""

    def respond(self, nu: float, solver: LinearSolver) -> Response:
        """The response at whirl ratio `nu`; one factorisation."""

    def growing(self, s: complex, solver: LinearSolver) -> Response:
        """The response to a motion in `exp(s tau)`; one factorisation."""
