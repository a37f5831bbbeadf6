"""Equilibria with contact pressures over low asperities, where none with contact points is found.

Newton's method on deflections, film and logarithms of the contact pressures starts from the equilibrium at nodes with
asperities of a micrometre, and follows them down to a few nanometres (K13). It needs no set of contacts, and finds the
stiff packs in which contacts of points keep changing.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.point_contacts import MOST_GROWTH, diverged
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import AT_ASPERITIES
from petalfoil.physics.asperity_contact import FULL_PRESSURE, ContactSamples
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.problem import POSITIVE_FRACTION, RESIDUAL_TOLERANCE, fraction_to_boundary
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.asperity_equations import AsperityEquations
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointLayout, PointState
from petalfoil.walls.element_pack import ElementPack

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

LEAST = 1e-9
"""Least pressure that is iterated on, over that at a gap of zero."""


@dataclass(frozen=True)
class AsperityContacts:
    """An equilibrium with contact pressures; its equations at the state and their largest scaled residual."""

    equations: AsperityEquations
    residual: float

    @property
    def pack(self) -> ElementPack:
        """Its petals."""
        return self.equations.smooth.whole.pack

    @property
    def points(self) -> ContactPoints:
        """One point for the contact in each element."""
        return self.equations.points

    @property
    def contact_slopes(self) -> str:
        """Where its contacts are, for people."""
        return AT_ASPERITIES


def with_asperities(whole: PointLayout, problem: CoupledProblem, state: PointState) -> AsperityContacts | None:
    """The equilibrium of `problem` near a state, whose points are not used; None where none is found."""
    mesh = whole.pack.mesh
    samples = ContactSamples(whole.curves, SAMPLES, 2.0 * np.pi / (mesh.count * mesh.cells))
    smooth = PointEquations(whole, problem, replace(state, points=ContactPoints.none()))
    gaps = samples.gaps(smooth.nodal_gaps, np.zeros((len(samples.element), SAMPLES)))
    pressure = FULL_PRESSURE * np.exp(-np.clip(gaps / HEIGHTS[0], -6.0, 80.0))
    equations = AsperityEquations(smooth, samples, pressure, HEIGHTS[0])
    for height in HEIGHTS:
        last = height == HEIGHTS[-1]
        found, steps = newton(replace(equations, height=height), RESIDUAL_TOLERANCE if last else ROUGH)
        current_run().note("asperities", height=height, steps=steps)
        if found is None:
            return None
        equations = found
    return AsperityContacts(equations, float(np.max(np.abs(equations.scaled))))


def newton(equations: AsperityEquations, tolerance: float) -> tuple[AsperityEquations | None, int]:
    """Newton's method with one height, and its steps; None where they run out."""
    for steps in range(STEPS):
        equations = renewed(equations)
        if np.max(np.abs(equations.scaled)) <= tolerance:
            return equations, steps
        if diverged(equations.smooth.state):
            return None, steps
        try:
            factor = current_run().film_solver.factor(equations.steady)
        except SingularMatrixError:
            return None, steps
        equations = stepped(equations, factor.solve(-equations.newton_residual))
    return None, STEPS


def renewed(equations: AsperityEquations) -> AsperityEquations:
    """Open gaps have the pressure of the law; others keep theirs, which is never nothing."""
    pressure = np.where(equations.bears, np.maximum(equations.pressure, LEAST * FULL_PRESSURE), equations.law)
    return replace(equations, pressure=pressure)


def stepped(equations: AsperityEquations, change: Array) -> AsperityEquations:
    """The equations after as much of `change` as film, pressures and contact pressures allow."""
    smooth, samples, pressure = equations.smooth, equations.samples, equations.pressure
    state, whole = smooth.state, smooth.whole
    dw, dP = change[: whole.n_wall], change[whole.n_wall :]
    reaction = equations.contact.change(whole.curves.by_w @ dw)
    grown = np.where(equations.bears, reaction / (samples.weight * pressure), 0.0)
    farthest = float(np.max(np.abs(grown) * (pressure > MATTERS), initial=0.0))
    length = min(
        1.0,
        POSITIVE_FRACTION * fraction_to_boundary(state.P, dP),
        fraction_to_boundary(MOST_GROWTH * state.P, -dP),
        POSITIVE_FRACTION * fraction_to_boundary(smooth.film_thickness.ravel(), whole.film_by_w @ dw),
        max(FARTHEST / max(farthest, FARTHEST), SHORTEST),
    )
    ahead = PointState(state.w + length * dw, state.P + length * dP, state.points)
    factor = np.exp(np.clip(length * grown, -2.0 * FARTHEST, 2.0 * FARTHEST))
    return replace(equations, smooth=replace(smooth, state=ahead), pressure=pressure * factor)
