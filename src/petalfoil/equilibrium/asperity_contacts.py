"""Equilibria with contact pressures over low asperities, where none with contact points is found.

Newton's method on deflections, film and logarithms of the contact pressures starts from the equilibrium at nodes with
asperities of a micrometre, and follows them down to a few nanometres (K13). It needs no set of contacts, and finds the
stiff packs in which contacts of points keep changing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError, scaled_force, unbalanced
from petalfoil.equilibrium.point_contacts import FARTHEST_MOVE, refuse_closed
from petalfoil.equilibrium.point_contacts import admitted as film_admits
from petalfoil.equilibrium.point_prospects import diverged
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import AT_ASPERITIES
from petalfoil.physics.asperity_contact import FULL_PRESSURE, ContactSamples
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.system.asperity_equations import NO_PRESSURE, AsperityEquations
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.walls.element_pack import ElementPack
from petalfoil.walls.pack_slip import dragged_samples

Array = NDArray[np.float64]

HEIGHTS = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 5e-4)
"""Mean heights of the asperities, one after the other, in units of the reference film: 1 um to 5 nm."""

SAMPLES = 48
"""Samples per element. A contact of the last height is a pressure over a normal distribution; two petals of usual
curvature have a sample for each of its standard deviations, with which sums are integrals to 1e-8."""

STEPS = 60
"""Most Newton steps with one height: 5 are typical, 20 in stiff packs."""

ROUGH = 1e-1
"""Residual below which the next height follows."""

FARTHEST = 3.0
"""Largest change of the logarithm of a pressure that matters in a step."""

SHORTEST = 0.05
"""Shortest step over Newton's that this may ask for."""

MATTERS = 1e-6
"""A contact pressure below this, over ambient pressure, does not limit the step."""

BESIDE_A_CHANGE = 1e-10
"""A contact pressure below this, over ambient pressure, is nothing beside small changes of others."""

LEAST = 1e-9
"""Least pressure that is iterated on, over that at a gap of zero."""


@dataclass(frozen=True)
class AsperityContacts:
    """An equilibrium with contact pressures; further attributes are those of `PointContacts`.

    Attributes
    ----------
    shortest_step : float or None
        Shortest step over Newton's of the path that led to it from the free shape; None where another state did [1].
    """

    equations: AsperityEquations
    residual: float
    gradient: Array | None = None
    shortest_step: float | None = None

    @property
    def pack(self) -> ElementPack:
        """Its petals."""
        return self.equations.smooth.whole.pack

    @property
    def points(self) -> ContactPoints:
        """One point for the contact in each element."""
        return self.equations.points

    @property
    def friction_points(self) -> ContactPoints:
        """Points at which friction between petals acts."""
        return self.equations.friction_points

    @property
    def contact_model(self) -> str:
        """Where its contacts are, for people."""
        return AT_ASPERITIES

    def at(self, problem: CoupledProblem, load: Array | None = None) -> AsperityContacts:
        """The equilibrium of a neighbouring problem, with these asperities; under a load from there.

        Raises
        ------
        NoPointsError
            None was found.
        """
        start = replace(self.equations, smooth=replace(self.equations.smooth, problem=problem))
        return settled(start, load)

    @property
    def gaps(self) -> tuple[Array, NDArray[np.bool_]]:
        """No gap closes: contact pressures are everywhere."""
        return np.zeros(0), np.zeros(0, dtype=bool)

    def under(self, whole: PointLayout, problem: CoupledProblem) -> AsperityContacts:
        """The same state under other equations with as many elements, unsolved."""
        equations = self.equations
        smooth = PointEquations(whole, problem, equations.smooth.state)
        equations = replace(equations, smooth=smooth, samples=samples_of(whole), followed=NO_PRESSURE)
        return replace(self, equations=equations)

    def moved(self, problem: CoupledProblem, change: Array) -> AsperityContacts:
        """The state after a small `change` (n,) of the unknowns, under the equations of `problem`, unsolved."""
        equations = self.equations
        move = problem.displacement - equations.problem.displacement
        ahead = changed(replace(equations, followed=NO_PRESSURE), change, move, 1.0)
        return replace(self, equations=replace(ahead, smooth=replace(ahead.smooth, problem=problem)))

    def nonlinearity(self, moved: AsperityContacts) -> float:
        """Largest change of the logarithm of a contact pressure to the state `moved` [1]."""
        before, after = self.equations.pressure, moved.equations.pressure
        return float(np.max(np.abs(np.log(after / before)) * (before > BESIDE_A_CHANGE), initial=0.0))


def with_asperities(
    whole: PointLayout, problem: CoupledProblem, state: PointState, load: Array | None = None
) -> AsperityContacts:
    """The equilibrium of `problem` near a state, whose points are not used.

    Under a load it is at the position that carries it, which is followed at the last height alone.

    Raises
    ------
    NoPointsError
        None was found.
    """
    samples = samples_of(whole)
    smooth = PointEquations(whole, problem, replace(state, points=ContactPoints.none()))
    gaps = samples.gaps(smooth.nodal_gaps, np.zeros((len(samples.element), SAMPLES)))
    pressure = FULL_PRESSURE * np.exp(-np.clip(gaps / HEIGHTS[0], -6.0, 80.0))
    equations = AsperityEquations(smooth, samples, pressure, HEIGHTS[0])
    for height in HEIGHTS:
        equations, steps, _ = newton(replace(equations, height=height), ROUGH)
        current_run().note("asperities", height=height, steps=steps)
    return settled(equations, load)


def samples_of(whole: PointLayout) -> ContactSamples:
    """Where contact pressures are."""
    mesh, friction = whole.pack.mesh, whole.journal_friction
    samples = ContactSamples(whole.curves, SAMPLES, 2.0 * np.pi / (mesh.count * mesh.cells))
    return replace(samples, dragged=dragged_samples(whole.pack, samples, friction)) if friction else samples


def settled(equations: AsperityEquations, load: Array | None) -> AsperityContacts:
    """The equilibrium with the height of `equations`, near their state.

    Raises
    ------
    NoPointsError
        None was found.
    """
    equations, steps, gradient = newton(equations, RESIDUAL_TOLERANCE, load)
    current_run().note("asperities", height=equations.height, steps=steps)
    residual = float(np.max(np.abs(equations.scaled)))
    return AsperityContacts(equations, residual, None if load is None else gradient)


def newton(
    equations: AsperityEquations, tolerance: float, load: Array | None = None
) -> tuple[AsperityEquations, int, Array]:
    """Newton's method with one height: the equations, its steps, the last gradient of the force by the position.

    Raises
    ------
    NoPointsError
        It does not converge.
    """
    refuse_closed(equations.smooth)
    gradient = np.zeros((0, 0))
    for steps in range(STEPS):
        equations = renewed(equations)
        left = np.concatenate([equations.scaled, scaled_force(equations, load)])
        if np.max(np.abs(left)) <= tolerance:
            return equations, steps, gradient
        if diverged(equations.smooth.state):
            raise NoPointsError(f"Newton's method with asperities of {equations.height:g} reference films diverges")
        tangent = ElementTangent.at(equations, load, current_run().film_solver)
        gradient = tangent.gradient
        step = tangent.correction(equations.newton_residual, unbalanced(equations, load))
        equations = stepped(equations, step)
    raise NoPointsError(f"asperities of {equations.height:g} reference films: more than {STEPS} steps")


def renewed(equations: AsperityEquations) -> AsperityEquations:
    """Open gaps have the pressure of the law; others keep theirs, which is never nothing."""
    pressure = np.where(equations.bears, np.maximum(equations.pressure, LEAST * FULL_PRESSURE), equations.law)
    return replace(equations, pressure=pressure)


def stepped(equations: AsperityEquations, change: tuple[Array, Array]) -> AsperityEquations:
    """The equations after as much of `change` (of unknowns and position) as film and contact pressures allow."""
    return changed(equations, *change, admitted(equations, change, FARTHEST_MOVE))


def admitted(equations: AsperityEquations, change: tuple[Array, Array], most: float) -> float:
    """The part of a change (of unknowns and position) that film and contact pressures allow [1].

    The journal moves by `most` reference films at most.
    """
    smooth, (dX, move) = equations.smooth, change
    grown = growth(equations, dX[: smooth.whole.n_wall], move)
    farthest = float(np.max(np.abs(grown) * (equations.pressure > MATTERS), initial=0.0))
    return min(film_admits(smooth, change, most), max(FARTHEST / max(farthest, FARTHEST), SHORTEST))


def growth(equations: AsperityEquations, dw: Array, move: Array) -> Array:
    """Change of the contact pressures over these by changes of deflections and position, (E, S)."""
    curves = equations.smooth.whole.curves
    reaction = equations.contact.change(curves.by_w @ dw + curves.by_e @ move)
    return np.where(equations.bears, reaction / (equations.samples.weight * equations.pressure), 0.0)


def changed(equations: AsperityEquations, change: Array, move: Array, length: float) -> AsperityEquations:
    """The equations after a part `length` of a change of the unknowns (n,) and a move of the journal."""
    smooth = equations.smooth
    state, whole, problem = smooth.state, smooth.whole, smooth.problem
    dw, dP = change[: whole.n_wall], change[whole.n_wall :]
    factor = np.exp(np.clip(length * growth(equations, dw, move), -2.0 * FARTHEST, 2.0 * FARTHEST))
    there = problem.at(displacement=problem.displacement + length * move)
    ahead = replace(smooth, problem=there, state=PointState(state.w + length * dw, state.P + length * dP, state.points))
    return replace(equations, smooth=ahead, pressure=equations.pressure * factor)
