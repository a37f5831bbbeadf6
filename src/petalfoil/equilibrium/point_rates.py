"""How an equilibrium follows a parameter with its isolated contacts as points between nodes (V5).

In the discrete equations a contact is at a node and jumps to the next one as a parameter changes. Derivatives with
contacts held at nodes are exact, and differ from the limit on fine grids as the stiffness of a pin or of a clamp does.
With the gap `n` and its slope `n'` at the points, both of the form (E12), and the derivatives `n_p`, `n'_p` of these by
the parameter at a fixed state,

    n x' + n_e e' = -n_p          the gap at the points stays closed
    n'^T (lam / p'') (n' x' + n'_e e' + n'_p)     is added to the rows of the wall, and with `n'_e` taken
                                                  from the force on the journal                         (V5)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.parameter_response import (
    EquationValues,
    HeldEquilibrium,
    ParameterResponse,
    StateRate,
    distances,
    parameter_response,
    undetermined,
)
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.travelling_contacts import TravellingContacts, placed_points, travelling_contacts
from petalfoil.physics.contact_points import IsolatedContacts
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.problem import Border
from petalfoil.solvers.sparse_lu import SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

BESIDE = 2
"""Nodes beside an active one between which a contact point may travel: their gaps open and close with it."""


@dataclass(frozen=True)
class PointEquilibrium:
    """An equilibrium whose isolated contacts travel, its tangent factorised.

    Attributes
    ----------
    solution : Solution
        The equilibrium.
    points : IsolatedContacts
        Its contacts: points, and the others at nodes.
    travelling : TravellingContacts
        What they add to the tangent.
    tangent : BorderedTangent
        The tangent, the journal's position bordered.
    """

    solution: Solution
    points: IsolatedContacts
    travelling: TravellingContacts
    tangent: BorderedTangent

    @classmethod
    def of(cls, solution: Solution) -> PointEquilibrium | None:
        """Find the points of a solution and factorise the tangent; None where it has none.

        Raises
        ------
        ConvergenceError
            The contacts do not determine the state.
        """
        problem, state, active = solution.problem, solution.state, solution.active
        if problem.acting is not problem.G or not constrain(problem.G, active).determinate:
            return None  # (V5) is that of reactions along the gaps alone
        linearized = problem.linearize(state.x, low_order=state.low_order)
        points = placed_points(solution, linearized)
        if not len(points.travel_stiffness):
            return None
        travelling = travelling_contacts((problem.G, problem.G), problem.layout.wall.contacts.by_e, points)
        matrix = linearized.matrix(np.zeros(len(active)))
        whole = sp.csc_array(matrix + travelling.tangent)
        try:
            factor = travelling.constraints.factor(whole, current_run().probe_solver, None)
        except SingularMatrixError:
            raise undetermined() from None
        columns = [linearized.slack_derivative(column) for column in problem.border.gap_derivative.T]
        forcing = np.column_stack(columns) + travelling.forcing
        border = bordered(problem.border, travelling, matrix.shape[0])
        return cls(
            solution,
            points,
            travelling,
            BorderedTangent.of(Tangent(whole, travelling.constraints, factor), border, forcing),
        )

    def respond(self, rates: EquationValues) -> StateRate:
        """The rate of the state (V5) from the rates of the equations at a fixed state."""
        travelling, tangent, problem = self.travelling, self.tangent, self.solution.problem
        turned = travelling.travel_stiffness * (self.points.slope @ rates.gaps)
        residual, closing = rates.residual + travelling.slope_by_x.T @ turned, self.closed(rates.gaps)
        x, pushes = tangent.respond(residual, closing)
        displacement, under_load = np.zeros(tangent.border.size), self.solution.load is not None
        if under_load:
            unbalanced = tangent.border.rows(x, pushes) + rates.force - travelling.slope_by_e.T @ turned
            stiffness = tangent.gradient - travelling.gradient
            displacement = -np.asarray(np.linalg.solve(stiffness, unbalanced), dtype=np.float64)
            residual = residual + tangent.forcing @ displacement
            x, pushes = tangent.respond(residual, closing + travelling.gap_by_e @ displacement)
        by_e = problem.layout.wall.contacts.by_e
        gaps = rates.gaps + by_e @ displacement + problem.G @ x
        return StateRate(x, self._at_nodes(pushes, gaps), gaps, displacement if under_load else rates.displacement)

    def closed(self, gaps: Array) -> Array:
        """Of values at all gaps (m,), those at the contacts: at nodes, then at the points."""
        return np.concatenate([gaps[self.points.at_nodes], self.points.value @ gaps])

    def _at_nodes(self, pushes: Array, gaps: Array) -> Array:
        """Rates of the reactions at nodes from those at the contacts, and from the points that travel; (m,)."""
        nodes = int(np.count_nonzero(self.points.at_nodes))
        lam: Array = self.points.value.T @ pushes[nodes:]
        lam[self.points.at_nodes] += pushes[:nodes]
        lam -= self.points.slope.T @ (self.travelling.travel_stiffness * (self.points.slope @ gaps))
        return lam

    def reach(self, rate: StateRate, sign: float) -> float:
        """Change of the parameter as it moves by `sign` at which a contact begins or ends.

        Gaps within `BESIDE` nodes of an active one are left out: a point that travels opens and closes them.
        """
        solution, active = self.solution, self.solution.active
        change = sign * rate.lam / solution.problem.weight
        whole = self.points.value @ (solution.lam / solution.problem.weight)
        ends = _distance(whole, self.points.value @ change)
        begins = distances(solution, active, rate, sign)[~beside(solution) | self.points.at_nodes]
        return float(min(np.min(ends, initial=np.inf), np.min(begins, initial=np.inf)))


def _distance(here: Array, change: Array) -> Array:
    """Change of the parameter at which what is `here` vanishes; infinite where it does not fall."""
    out = np.full(len(here), np.inf)
    falling = change < 0.0
    out[falling] = here[falling] / -change[falling]
    return out


def beside(solution: Solution) -> Mask:
    """Active gaps and those within `BESIDE` nodes of one on its line, (m,)."""
    near = solution.active.copy()
    for line in solution.problem.layout.wall.contacts.lines:
        on_line = solution.active[line.number]
        spread = on_line.copy()
        for step in range(1, BESIDE + 1):
            spread[:, step:] |= on_line[:, :-step]
            spread[:, :-step] |= on_line[:, step:]
        near[line.number[spread]] = True
    return near


def bordered(border: Border, travelling: TravellingContacts, n: int) -> Border:
    """How the journal's position enters where contacts travel: its rows read all unknowns."""
    rows = np.zeros((border.size, n))
    rows[:, border.columns] = border.row_derivative
    rows -= travelling.forcing.T
    return Border(travelling.gap_by_e, rows, slice(0, n))


def point_response(
    equilibrium: PointEquilibrium | None, held: HeldEquilibrium, rates: EquationValues, nearest: float
) -> ParameterResponse:
    """The response with contacts as points; with contacts at nodes where there are none, or one begins or ends here.

    Parameters
    ----------
    equilibrium : PointEquilibrium or None
        The equilibrium with its points, if it has any.
    held, rates, nearest
        As in `parameter_response`.
    """
    if equilibrium is None:
        return parameter_response(held, rates, nearest)
    rate = equilibrium.respond(rates)
    reach = equilibrium.reach(rate, -1.0), equilibrium.reach(rate, 1.0)
    return ParameterResponse(rate, rate, reach) if min(reach) > nearest else parameter_response(held, rates, nearest)
