"""Contact pressures over asperities from nothing, along a central path (K13b): first the petals alone, then the film.

The foil pack without film is convex, so that its path leads in from the free shape. At `FILM_JOINS` the film joins, and
the barrier falls until the asperities bear. No equilibrium with contacts at nodes is needed, and no set of contacts.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.asperity_contacts import HEIGHTS, AsperityContacts, samples_of, settled
from petalfoil.equilibrium.element_tangent import ElementTangent, NoPointsError
from petalfoil.equilibrium.point_contacts import refuse_closed
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.gap_curves import ContactPoints
from petalfoil.solvers.problem import POSITIVE_FRACTION, fraction_to_boundary
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.system.asperity_equations import AsperityEquations
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.point_equations import PointEquations, PointState
from petalfoil.system.point_layout import PointLayout
from petalfoil.system.softened_asperities import SoftenedAsperities

Array = NDArray[np.float64]

FIRST_PRODUCT = 100.0
"""First products of pressure and slack over the deepest penetration of the free shape, as of contacts at nodes."""

FILM_JOINS = 3.0
"""Barrier at which the film joins, in ambient pressure times the reference film."""

BEARS = 1e-6
"""Barrier at which the asperities bear: past it (K13) holds to a few thousandths of their height."""

STEPS = 60
"""Most steps of the petals alone, and of film and petals."""

BOUNDARY = 0.98
"""Part of the way to zero that pressures and slacks may go in a step."""

FEASIBLE = 1e-3
"""Distance of slacks from gaps up to which the film may join."""

SHARES = ((0.9, 0.1), (0.5, 0.3), (0.0, 0.8))
"""Length of the last step from which on the barrier is to fall to this part of itself."""


def share(length: float) -> float:
    """The part of the barrier that the next step aims at."""
    return next(part for least, part in SHARES if length >= least)


def from_free_petals(whole: PointLayout, problem: CoupledProblem) -> AsperityContacts:
    """The equilibrium of `problem` that its path leads to from the free shape.

    Raises
    ------
    NoPointsError
        It leads nowhere.
    """
    run = current_run()
    try:
        path, steps = petals_alone(free_petals(whole, problem))
        run.note("asperities", barrier=path.barrier, petals_steps=steps)
        path, steps, shortest = with_film(path)
    except SingularMatrixError as failure:
        raise NoPointsError(f"asperities: {failure}") from None
    run.note("asperities", barrier=path.barrier, steps=steps, shortest=shortest)
    found = settled(AsperityEquations(path.smooth, path.samples, path.pressure, path.height), None)
    return replace(found, shortest_step=shortest)


def free_petals(whole: PointLayout, problem: CoupledProblem) -> SoftenedAsperities:
    """The free shape under ambient pressure: slacks as wide as it penetrates, pressures to match."""
    samples = samples_of(whole)
    state = PointState(np.zeros(whole.n_wall), np.ones(whole.n_film), ContactPoints.none())
    smooth = PointEquations(whole, problem, state)
    gaps = samples.at_samples(smooth.nodal_gaps)
    depth = max(1.0, -float(np.min(gaps)))
    slack = np.maximum(gaps, depth)
    pressure = FIRST_PRODUCT * depth / slack
    return SoftenedAsperities(smooth, samples, pressure, HEIGHTS[-1], slack=slack, product=slack * pressure)


def petals_alone(path: SoftenedAsperities) -> tuple[SoftenedAsperities, int]:
    """The petals under ambient pressure on their central path where the film joins, and the steps to there.

    Raises
    ------
    NoPointsError
        Too many steps.
    """
    length, by_w = 1.0, path.whole.curves.by_w
    for steps in range(STEPS):
        barrier = path.barrier
        if barrier <= 2.0 * FILM_JOINS and float(np.max(np.abs(path.open_by))) <= FEASIBLE:
            return path, steps
        path = replace(path, product=np.full_like(path.slack, max(share(length) * barrier, FILM_JOINS)))
        reactions = path.samples.weight * path.pressure - path.contact.every(path.contact.left)
        residual = path.whole.elastic(path.deflection) - path.samples.on_petals(reactions)
        matrix = sp.csc_array(path.whole.stiffness + path.contact.on_petals @ by_w)
        factor = current_run().pack_solver.factor(matrix)
        film = np.zeros(path.whole.n_film)
        path, length = moved(path, np.concatenate([factor.solve(-residual), film]), 1.0)
    raise NoPointsError(f"asperities: the petals alone take more than {STEPS} steps")


def with_film(path: SoftenedAsperities) -> tuple[SoftenedAsperities, int, float]:
    """Film and petals on their central path where the asperities bear, the steps to there and the shortest of them.

    Raises
    ------
    NoPointsError
        Too many steps, or the film closes.
    """
    length, shortest, still = 1.0, 1.0, np.zeros(len(path.problem.displacement))
    for steps in range(STEPS):
        barrier = path.barrier
        if barrier <= BEARS and length >= SHARES[0][0]:
            return path, steps, shortest
        refuse_closed(path.smooth)
        path = replace(path, product=np.full_like(path.slack, share(length) * barrier))
        tangent = ElementTangent.at(path, None, current_run().film_solver)
        change, _ = tangent.correction(path.newton_residual, still)
        closing = path.whole.film_by_w @ change[: path.whole.n_wall]
        opens = POSITIVE_FRACTION * fraction_to_boundary(path.film_thickness.ravel(), closing)
        path, length = moved(path, change, min(1.0, opens))
        shortest = min(length, shortest)
    raise NoPointsError(f"asperities: film and petals take more than {STEPS} steps")


def moved(path: SoftenedAsperities, change: Array, most: float) -> tuple[SoftenedAsperities, float]:
    """The state after as much of a change of the unknowns (n,) as pressures and slacks allow, and that part of it.

    A film pressure goes a fraction of the way to zero at most, by itself.
    """
    smooth, n_wall = path.smooth, path.whole.n_wall
    pressure, slack = path.change(path.whole.curves.by_w @ change[:n_wall])
    length = min(most, BOUNDARY * fraction_to_boundary(path.pressure.ravel(), pressure.ravel()))
    length = min(length, BOUNDARY * fraction_to_boundary(path.slack.ravel(), slack.ravel()))
    state = smooth.state
    film = np.maximum(state.P + length * change[n_wall:], (1.0 - POSITIVE_FRACTION) * state.P)
    ahead = PointState(state.w + length * change[:n_wall], film, state.points)
    return replace(
        path,
        smooth=replace(smooth, state=ahead),
        pressure=path.pressure + length * pressure,
        slack=path.slack + length * slack,
    ), length
