"""Linear response of film and petals about an equilibrium of Hermite elements (model, question 6).

The unknowns are those of the equilibrium, reactions and places of its contact points included. With its tangent `J`,
what the film stores `S`, and the derivatives `F_e`, `S_e` by the journal's position,

    (J + s S) dX = -(F_e + s S_e) de ,     dF = R dX + R_e de                                          (E16)

in `exp(s tau)`. Contacts stay closed while their points travel. Where petals stick to each other, the changes `dT` of
their friction forces are unknowns too. With the slips `B w` and the flexibility `F` of contacts and membranes (M4),

    J dX + B^T dT = ... ,     B dw - F dT = 0                                                          (E17)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.small_motion import ElementEquilibrium
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.reduced_model import MovedSystem
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
Values = NDArray[Any]
"""Real at zero frequency, complex otherwise."""


@dataclass(frozen=True)
class ElementMotion:
    """The system about one equilibrium, whatever the frequency.

    Attributes
    ----------
    contacts : ElementEquilibrium
        The equilibrium.
    stuck : Friction or None
        Friction in contacts that stick: its forces are unknowns behind all others (E17).
    """

    contacts: ElementEquilibrium
    stuck: Friction | None = None

    @property
    def problem(self) -> CoupledProblem:
        """Speed and position."""
        return self.contacts.equations.problem

    @property
    def contact_model(self) -> str:
        """Where its contacts are, for people."""
        return self.contacts.contact_model

    @property
    def film_thickness(self) -> Array:
        """Film over the reference length [1]."""
        return self.contacts.equations.film_thickness

    @property
    def loss(self) -> None:
        """Petals lose energy by friction alone."""
        return

    @property
    def frictionless(self) -> Self:
        """The same, petals sliding freely on each other."""
        return replace(self, stuck=None)

    @property
    def _n_stuck(self) -> int:
        """Friction forces among the unknowns."""
        return 0 if self.stuck is None else len(self.stuck.stiffness)

    @cached_property
    def steady(self) -> sp.csc_array:
        """`J`, friction included."""
        tangent = self.contacts.equations.steady
        if self.stuck is None:
            return tangent
        held = sp.csr_array((self._n_stuck, tangent.shape[0] - self.stuck.slip.shape[1]))
        slip = sp.hstack([self.stuck.slip, held], format="csr")
        return sp.csc_array(sp.block_array([[tangent, slip.T], [slip, sp.csr_array(-self.stuck.flexibility)]]))

    @cached_property
    def stored(self) -> sp.csc_array:
        """`S`; friction stores nothing."""
        stored = self.contacts.equations.stored
        if self.stuck is None:
            return stored
        return sp.csc_array(sp.block_diag([stored, sp.csc_array((self._n_stuck, self._n_stuck))]))

    @cached_property
    def forcing(self) -> tuple[Array, Array]:
        """`F_e` and `S_e`, (n, n_position) each."""
        equations, below = self.contacts.equations, ((0, self._n_stuck), (0, 0))
        steady = np.pad(equations.forcing(), below)
        return steady, np.pad(equations.forcing(1.0), below) - steady

    @cached_property
    def force_rows(self) -> Array:
        """Derivative of the force on the journal by the unknowns, (n_position, n)."""
        return np.pad(self.contacts.equations.force_rows, ((0, 0), (0, self._n_stuck)))

    def moved_system(self, solver: LinearSolver) -> MovedSystem:
        """The same for a reduced model; one factorisation."""
        rows = self.force_rows
        direct = self.contacts.equations.force_direct
        return MovedSystem(
            solve=solver.factor(self.steady).solve,
            S=self.stored,
            forcing=self.forcing,
            force=(rows.T, np.zeros_like(rows.T)),
            direct=(direct, np.zeros_like(direct)),
        )

    def respond(self, nu: float, solver: LinearSolver) -> ElementResponse:
        """The response at whirl ratio `nu`; one factorisation."""
        return self.growing(1j * nu, solver)

    def growing(self, s: complex, solver: LinearSolver) -> ElementResponse:
        """The response to a motion in `exp(s tau)`; one factorisation."""
        steady, stored = self.forcing
        matrix = sp.csc_array(self.steady + s * self.stored) if s else self.steady
        solve = solver.factor(matrix).solve
        return ElementResponse(self, solve, solve(-(steady + s * stored) if s else -steady))


@dataclass(frozen=True)
class ElementResponse:
    """Response to the journal's displacement at one state and frequency.

    Attributes
    ----------
    motion : ElementMotion
        The state.
    solve : callable
        Unknowns from right sides, (n,) or (n, k).
    units : (n, n_position) array
        Change of the unknowns by a unit of each coordinate of the journal.
    """

    motion: ElementMotion
    solve: Callable[[Values], Values]
    units: Values

    @property
    def force_gradient(self) -> Values:
        """`dF/de` of film and contacts on the journal, (n_position, n_position), over unit of force and length [1]."""
        direct = self.motion.contacts.equations.force_direct
        return np.asarray(self.motion.force_rows @ self.units + direct)

    def moved(self, forces: Values) -> Values:
        """Change of the unknowns by forces on them, the journal held in place; (n, k) each."""
        return self.solve(forces.astype(self.units.dtype))

    def forced(self, force: Values) -> tuple[Values, Values]:
        """Change of the unknowns (n,) and force on the journal held in place (n_position,), by forces (n,) on them."""
        change = self.solve(force)
        return change, np.asarray(self.motion.force_rows @ change)

    def slope(self) -> Values:
        """Derivative of `dF/de` by `s` [1]: with the same factor, from (E16) differentiated."""
        rates = self.motion.stored @ self.units + self.motion.forcing[1]
        return np.asarray(self.motion.force_rows @ self.solve(-rates))
