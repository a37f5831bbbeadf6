"""An equilibrium of film, wall and contacts: its state, its operating state, and how it was reached."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.equilibrium.small_motion import HELD_AT_NODES, ON_LINES, ElementEquilibrium, LineEquilibrium
from petalfoil.solvers.contact_newton import ActiveContacts
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE, Linearized, PrimalDualPoint, scaled_residual
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.friction import FrictionState
from petalfoil.system.loaded import load_scale
from petalfoil.system.unknowns import DEFLECTION

Array = NDArray[np.float64]

REFINEMENTS = 8
"""Corrections below the last digit: one usually ends them. At 4096 cells per pitch, with a tangent from some steps
before, five were needed."""

WORTH = 0.5
"""A correction that leaves more than this of a residual below `SPARE` is the last."""

SPARE = 0.1 * RESIDUAL_TOLERANCE
"""Residual above which corrections go on, as many as there may be: on the finest grids a node goes up and down by the
last digit from one to the next, and some of them leave a tenth of what those before and after leave."""


@dataclass(frozen=True)
class RefinedState:
    """Unknowns, with the part of the deflections below the last digit of `x`.

    Attributes
    ----------
    x : (n,) array
        Unknowns [1].
    low_order : (n_wall,) array
        Rest of the deflections, smaller than the last digit of `x` [1].
    lam : (m,) array
        Contact reactions over the unit of nodal force [1].
    """

    x: Array
    low_order: Array
    lam: Array


@dataclass(frozen=True)
class OperatingState:
    """Speed [rad/s], journal displacement [m], and load [N] where one is balanced."""

    speed: float
    displacement: Array
    load: Array | None


@dataclass(frozen=True)
class FrictionPath:
    """What petals with friction keep of the path that they have gone.

    Attributes
    ----------
    state : FrictionState
        Slips and friction forces.
    active : (m,) bool array
        Contacts that carry load.
    lost : float
        Energy lost to friction since the pack was assembled, over the units of force and length [1].
    """

    state: FrictionState
    active: NDArray[np.bool_]
    lost: float


@dataclass(frozen=True)
class Solution:
    """A converged state.

    Attributes
    ----------
    problem : CoupledProblem
        The equations at its speed and journal position.
    state : RefinedState
        Unknowns and reactions.
    residual : float
        Largest scaled residual: wall rows by ambient pressure, film rows by their flows, complementarity by
        `|min(g, lam)|`.
    solution_path : str
        How it was reached, for people.
    contacts : ActiveContacts or None
        Active contacts and last tangent; None where the interior point had the last word.
    load : (n_position,) array or None
        The load that it balances, over the unit of force [1]; None at a fixed position.
    elements : ElementEquilibrium or None
        The equilibrium of petals with continuous slopes near this one, whose contacts are not at nodes: results are
        those of it. None where there is none, or none was looked for.
    elements_sought : bool
        Whether it was looked for.
    lines : LineEquilibrium or None
        The same in 3-D: the equilibrium whose contact lines cross the stations between nodes.
    nodal_force_difference : float or None
        Difference of its force from that with contacts at nodes, over that force; None without it [1].
    other : Solution or None
        The state of the other bearing of a rotor whose bearings do not share the load evenly.
    shaft_residual : float or None
        Force and moment left over on that rotor, over its load [1].
    friction : FrictionPath or None
        Friction forces between petals, where they were followed along a path; None of equilibria without them.
    sampled : ElementEquilibrium or None
        What its state at the nodes is sampled from; None of an equilibrium with contacts at nodes.
    shortest_step : float or None
        Shortest step of the interior point that led to it, over Newton's [1]; None of solutions reached otherwise.
    step_count : int or None
        Number of these steps; None likewise.
    on_few_cells : Solution or None
        The equilibrium on few cells that led to it.
    coarse_rate : float
        Growth rate of the equilibrium under a coarse film that led to it, 0 where none did [1].
    """

    problem: CoupledProblem
    state: RefinedState
    residual: float
    solution_path: str
    contacts: ActiveContacts | None = field(default=None, repr=False)
    load: Array | None = None
    other: Solution | None = field(default=None, repr=False)
    shaft_residual: float | None = None
    elements: ElementEquilibrium | None = field(default=None, repr=False)
    elements_sought: bool = False
    nodal_force_difference: float | None = None
    lines: LineEquilibrium | None = field(default=None, repr=False)
    friction: FrictionPath | None = field(default=None, repr=False)
    shortest_step: float | None = None
    step_count: int | None = None
    sampled: ElementEquilibrium | None = field(default=None, repr=False)
    on_few_cells: Solution | None = field(default=None, repr=False)
    coarse_rate: float = 0.0

    @property
    def position(self) -> Array:
        """Displacement of the journal over the reference length, (n_position,) [1]: that of results."""
        if self.lines is not None:
            return self.lines.problem.displacement
        problem = self.problem if self.elements is None else self.elements.equations.problem
        return problem.displacement

    @property
    def contact_model(self) -> str:
        """Where the contacts of results are, for people."""
        if self.lines is not None:
            return ON_LINES
        return HELD_AT_NODES if self.elements is None else self.elements.contact_model

    @property
    def reported_residual(self) -> float:
        """Largest scaled residual of the equilibrium that results are taken from."""
        smooth = self.elements or self.lines
        return self.residual if smooth is None else smooth.residual

    @property
    def x(self) -> Array:
        """Unknowns, (n,) [1]."""
        return self.state.x

    @property
    def lam(self) -> Array:
        """Contact reactions, (m,) [1]."""
        return self.state.lam

    @property
    def deflection(self) -> Array:
        """Deflections of the wall, (n_wall,) [1]."""
        return self.x[self.problem.layout.unknowns[DEFLECTION]]

    @property
    def active(self) -> NDArray[np.bool_]:
        """Contacts that carry load, (m,)."""
        if self.contacts is not None:
            return self.contacts.active
        if self.lines is not None:
            return self.lines.active
        if self.friction is not None:
            return self.friction.active
        return self.lam / self.problem.weight > self.problem.gaps(self.x)

    @property
    def bottomed_out(self) -> bool:
        """Whether active contacts chain the journal to the bushing, or to a held root, at one angle.

        Such a pack is at its solid height there, and no contact set determines its reactions.
        """
        contacts, G = self.problem.layout.wall.contacts, self.problem.G
        closed = self.active & (self.problem.gaps(self.x) <= RESIDUAL_TOLERANCE)
        rows = np.flatnonzero(closed & (np.diff(G.indptr) > 0))
        if not len(rows):
            return False
        journal, bushing = G.shape[1], G.shape[1] + 1
        on_journal = np.zeros(len(closed), dtype=np.bool_)
        on_journal[contacts.journal] = True
        first, last = G.indices[G.indptr[rows]], G.indices[G.indptr[rows + 1] - 1]
        other = np.where(first != last, last, np.where(on_journal[rows], journal, bushing))
        if not (np.any(other == journal) and np.any(other == bushing)):
            return False
        chains = sp.coo_array((np.ones(len(rows)), (first, other)), shape=(bushing + 1, bushing + 1))
        _, label = sp.csgraph.connected_components(chains, directed=False)
        return bool(label[journal] == label[bushing])

    @property
    def case(self) -> Case:
        """The bearing. Speed and eccentricity of the solution are those of `operating_state`."""
        return self.problem.layout.case

    @property
    def operating_state(self) -> OperatingState:
        """Speed, displacement and load, SI."""
        layout = self.problem.layout
        speed, scales = layout.speed(self.problem.bearing_number), layout.scales
        load = None if self.load is None else self.load * scales.force
        return OperatingState(speed, self.position * scales.length, load)

    @property
    def unbalanced(self) -> Array:
        """Force of film, contacts and load on the journal over the unit of force, (n_position,) [1]."""
        if self.elements is not None:
            force = self.elements.equations.force
        elif self.lines is not None:
            force = self.lines.force
        else:
            force = self.problem.journal_force(self.x, self.lam)
        return force if self.load is None else force + self.load

    @property
    def force_residual(self) -> float:
        """The unbalanced force over the load; nan without a load [1]."""
        if self.shaft_residual is not None:
            return self.shaft_residual
        return float("nan") if self.load is None else float(np.linalg.norm(self.unbalanced)) / load_scale(self.load)


def total_residual(problem: CoupledProblem, state: RefinedState, linearized: Linearized | None = None) -> float:
    """Largest scaled residual of a state, from the state alone; `linearized` are its equations, if they are at hand.

    Rows of wall and film by their scales; gaps and reactions (over their weight) by `|min(g, lam)|`, which is zero
    exactly when both are non-negative and one of them vanishes.
    """
    linearized = linearized or problem.linearize(state.x, low_order=state.low_order)
    rows = scaled_residual(linearized, problem.acting.T @ state.lam)
    mismatch = np.minimum(problem.gaps(state.x), state.lam / problem.weight)
    return max(rows, float(np.max(np.abs(mismatch), initial=0.0)))


def from_contacts(problem: CoupledProblem, contacts: ActiveContacts | None, path: str) -> Solution | None:
    """The solution on active contacts, refined below the last digit of its deflections; None if it is none."""
    if contacts is None:
        return None
    return accepted(Solution(problem, *refine(problem, contacts), path, contacts))


def from_point(problem: CoupledProblem, point: PrimalDualPoint, path: str) -> Solution | None:
    """The solution of the interior point, its slacks dropped; None if it is none."""
    return accepted(unrefined(problem, point.x, point.lam, path))


def unrefined(problem: CoupledProblem, x: Array, lam: Array, path: str) -> Solution:
    """A state as it is, whatever its residual."""
    state = RefinedState(x, np.zeros(problem.layout.n_wall), lam)
    return Solution(problem, state, total_residual(problem, state), path)


def accepted(solution: Solution) -> Solution | None:
    """`solution`, if its residual makes it one."""
    return solution if solution.residual <= RESIDUAL_TOLERANCE else None


def evenly_rounded(w: Array) -> Array:
    """Deflections as multiples of the last digit of the largest, whose differences are then free of rounding.

    Where deflections change sign, neighbours have more digits than their difference can hold. That alone made `K w`
    miss the tolerance from 1024 cells per pitch on.
    """
    digit = np.spacing(np.max(np.abs(w), initial=0.0))
    rounded: Array = np.round(w / digit) * digit
    return rounded


def refine(problem: CoupledProblem, contacts: ActiveContacts) -> tuple[RefinedState, float]:
    """The state after iterative refinement with the tangent at hand (R1), and its residual; no factorisation.

    Deflections are corrected below their last digit, so that the wall's rows, which lose it as `dphi^-4`, balance.
    """
    wall, constraints = problem.layout.unknowns[DEFLECTION], contacts.constraints
    state = RefinedState(contacts.state.x, np.zeros(problem.layout.n_wall), contacts.state.lam)
    if not problem.layout.n_wall:
        return state, total_residual(problem, state, contacts.state.linearized)
    linearized = problem.linearize(state.x, low_order=state.low_order)
    best, least = state, total_residual(problem, state, linearized)
    for _ in range(REFINEMENTS):
        change = contacts.tangent.tangent.step(linearized.residual)
        change[wall] += state.low_order
        x = state.x + change
        x[wall] = evenly_rounded(x[wall])
        low_order = change[wall] - (x[wall] - state.x[wall])  # exactly what the sum has lost
        linearized = problem.linearize(x, low_order=low_order)
        lam = np.zeros(len(contacts.active))
        lam[constraints.held] = constraints.reactions(linearized.residual)
        state = RefinedState(x, low_order, lam)
        before, residual = least, total_residual(problem, state, linearized)
        if residual < least:
            best, least = state, residual
        if residual > WORTH * before and least <= SPARE:
            break
    return best, least
