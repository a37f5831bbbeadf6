"""How many steps per turn a motion may take, told before they are taken."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.system.point_equations import PointEquations
from petalfoil.system.time_step import StepProblem

Array = NDArray[np.float64]

STEPS_A_SWING = 16.0
"""Steps in which a swing of the rotor is followed at the default tolerance: 12 to 28 were counted on solid contacts."""

MANY = 1000.0
"""Steps of a turn from which on they are told beforehand: usual motions take 25 to 200."""


def steps_ahead(bearing: RotorBearing, start: Instant) -> Iterator[str]:
    """Yield a warning where a turn may take very many steps.

    Parameters
    ----------
    bearing : RotorBearing
        The bearing and its rotor.
    start : Instant
        Where the motion begins.
    """
    rate, speed = bearing.rotor.clock.rate, bearing.rotor.schedule.top
    swing = max(fastest_swing(bearing, start), hardest_landing(bearing, start))
    if not speed > 0.0 or not swing > 0.0:
        return
    steps = STEPS_A_SWING * swing * rate / speed
    if steps > MANY:
        hertz, turn = swing * rate / (2.0 * math.pi), 2.0 * math.pi / speed
        yield (
            f"a turn of {turn:.3g} s may take {steps:.0f} steps of {1e6 * turn / steps:.3g} us: from where it is "
            f"released the rotor swings on film and contacts at up to {hertz:.3g} Hz; use a shorter duration, a higher "
            "speed or a larger tolerance"
        )


def hardest_landing(bearing: RotorBearing, start: Instant) -> float:
    """Frequency at which the rotor bounces on solid contact, which stops it within a contact film thickness [1].

    ``sqrt(a / h_c)`` with the acceleration `a` with which it is released; zero from a balance.
    """
    parts, length = bearing.problem.each(start.x, start.lam), bearing.problem.layout.scales.length
    thickness = min(part.layout.case.surface.contact_film_thickness for part, _, _ in parts) / length
    return float(np.sqrt(np.linalg.norm(start.change.v) / thickness))


def fastest_swing(bearing: RotorBearing, start: Instant) -> float:
    """Highest natural frequency of the rotor on the stiffness at `start` over the unit of time, film at rest [1].

    Zero where the contacts there do not determine the stiffness. One factorisation.
    """
    problem = bearing.problem.at(displacement=start.e, bearing_number=bearing.rotor.bearing_number(start.tau))
    if start.points is not None and bearing.points is not None and isinstance(problem, StepProblem):
        return swing_of(bearing, -gradient_at_points(PointEquations(bearing.points, problem, start.points)))
    if start.lines is not None:
        return swing_of(bearing, -gradient_on_lines(start.lines))
    constraints = constrain(problem.G, start.active, acting=problem.acting)
    if not constraints.determinate:
        return 0.0
    linearized = problem.linearize(start.x)
    matrix = linearized.matrix(np.zeros(len(problem.weight)))
    try:
        factor = constraints.factor(matrix, current_run().probe_solver, problem.elimination_key)
    except SingularMatrixError:
        return 0.0
    stiffness = -BorderedTangent.at(Tangent(matrix, constraints, factor), problem.border, linearized).gradient
    return swing_of(bearing, stiffness)


def gradient_at_points(equations: PointEquations) -> Array:
    """Force by the journal's position with contact points, (d, d) [1]; zero where they do not determine the petals."""
    still = np.zeros_like(equations.problem.displacement)
    try:
        return ElementTangent.at(equations, still, current_run().probe_solver).gradient
    except NoPointsError:
        return np.zeros((len(still), len(still)))


def gradient_on_lines(lines: LineContacts) -> Array:
    """The same with contact lines."""
    nothing = np.zeros((len(lines.force), len(lines.force)))
    if not lines.contacts.constraints.determinate:
        return nothing
    try:
        return np.asarray(lines.motion.growing(0.0, current_run().probe_solver).force_gradient)
    except SingularMatrixError:
        return nothing


def swing_of(bearing: RotorBearing, stiffness: Array) -> float:
    """Highest natural frequency of the rotor on a stiffness (d, d), over the unit of time [1]."""
    squares = np.linalg.eigvals(np.linalg.solve(bearing.rotor.inertia, stiffness))
    return float(np.sqrt(np.max(squares.real, initial=0.0)))
