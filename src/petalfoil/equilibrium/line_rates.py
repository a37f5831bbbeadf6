"""How an equilibrium with contact lines follows a parameter of its case (V9).

Its unknowns `x`, reactions, angles of contact points and, under a load, the journal's position satisfy (C11) and (C12),
which are smooth as long as no contact begins or ends and no point leaves its cell. Their rates follow from the rates of
the equations at a fixed state by the tangent of Newton's method (E12), one solve for each parameter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.element_rates import falling
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.line_tangent import LineChange, LineResiduals, LineTangent
from petalfoil.equilibrium.linear_response import LinearResponse
from petalfoil.equilibrium.parameter_response import Equations
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.problem import RESIDUAL_TOLERANCE
from petalfoil.solvers.sparse_lu import SingularMatrixError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LineRates:
    """Derivatives of the equations by a parameter at a fixed state.

    Attributes
    ----------
    left : LineResiduals
        Of their residuals.
    displacement : (d,) array
        Of the journal's displacement where it is given.
    gaps : (m,) array
        Of the gaps at all nodes.
    """

    left: LineResiduals
    displacement: Array
    gaps: Array

    @classmethod
    def of(cls, found: LineContacts, there: Sequence[Equations], weights: Sequence[float]) -> LineRates | None:
        """From the equations at several values of the parameter; None where their grids differ."""
        states = [found.under(equations.problem, equations.load) for equations in there]
        if any(state.problem.layout.n != found.problem.layout.n for state in states):
            return None

        def rate(of: Callable[[LineContacts], Array]) -> Array:
            return np.asarray(sum(weight * of(state) for weight, state in zip(weights, states, strict=True)))

        left = LineResiduals(
            rate(lambda state: state.rows),
            rate(lambda state: state.closed),
            rate(lambda state: state.slopes),
            rate(lambda state: state.unbalanced),
        )
        return cls(left, rate(lambda state: state.problem.displacement), rate(lambda state: state.gaps))


@dataclass(frozen=True)
class LineRate:
    """Derivative of an equilibrium by a parameter.

    Attributes
    ----------
    change : LineChange
        Of unknowns, reactions, displacement and angles.
    reach : (float, float)
        How far the parameter can decrease and increase until a contact begins or ends; infinite for never.
    """

    change: LineChange
    reach: tuple[float, float]

    def moved(self, solution: Solution, change: float, there: Equations) -> Solution | None:
        """The equilibrium after a change of the parameter, under the equations `there`; None without lines."""
        found = solution.lines
        if not isinstance(found, LineContacts):
            return None
        own = found.under(there.problem.at(displacement=found.problem.displacement), there.load)
        return replace(
            solution, problem=there.problem, lines=own.moved(self.change, change, own.problem), load=there.load
        )


def line_response(found: LineContacts) -> LinearResponse | None:
    """The tangent at an equilibrium, factorised.

    None where the contacts do not determine it, or where the gap hardly curves at a point: the tangent is then not the
    derivative (`LEAST_CURVATURE`).
    """
    if np.any(found.curvature < found.bending):
        return None
    try:
        return found.motion.growing(0.0, current_run().probe_solver)
    except SingularMatrixError:
        return None


def line_rate(found: LineContacts, response: LinearResponse, rates: LineRates) -> LineRate:
    """The derivative from the rates of the equations at a fixed state; one solve, two under a load."""
    under_load = found.load is not None
    way = None if under_load else np.zeros_like(rates.displacement)
    change = LineTangent.of(found, response).correction(found, rates.left, way)
    if not under_load:
        change = replace(change, displacement=rates.displacement)
    problem = found.problem
    gap_by_e = problem.layout.wall.contacts.by_e
    gaps = rates.gaps + problem.G @ change.x
    if under_load:
        gaps = gaps + gap_by_e @ change.displacement
    return LineRate(change, (reach(found, change, gaps, -1.0), reach(found, change, gaps, 1.0)))


def reach(found: LineContacts, change: LineChange, gaps: Array, sign: float) -> float:
    """Change of the parameter at which, as it moves by `sign`, a contact ends or begins, or a point leaves its cell."""
    covered = found.held.copy()
    covered[found.points.beside.ravel()] = True
    reaction = np.concatenate([found.held_reaction, found.reaction])
    near, far = found.points.to_nodes
    return min(
        falling(reaction - RESIDUAL_TOLERANCE, sign * change.reaction),
        falling(found.gaps[~covered] - RESIDUAL_TOLERANCE, sign * gaps[~covered]),
        falling(near, sign * change.phi),
        falling(far, -sign * change.phi),
    )
