"""Whether an equilibrium is stable at a fixed journal position.

The wall has no mass; the film has. With the contacts that carry load kept active, small disturbances obey
`J u + s M u = 0` (E1) in `exp(s tau)`, `tau = omega t`: stable if every `s` has a negative real part.
"""

from __future__ import annotations

import numpy as np

from petalfoil.equilibrium.amended_factor import ServedTangent
from petalfoil.equilibrium.branches import SLOW
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import TangentEquations
from petalfoil.equilibrium.solution import Solution
from petalfoil.solvers.constraints import ContactConstraints, constrain
from petalfoil.solvers.eigenvalues import Pencil, rightmost, seen_through
from petalfoil.system.unknowns import DEFLECTION

DOUBT = 0.3
"""Distance of an eigenvalue that is nearly known from zero and from `branches.SLOW`, on whose side of both what follows
depends, below which it is found exactly [1]. Tangents at hand give those of ten bearings, -17 to -2, to 0.04."""


def leading_eigenvalue(solution: Solution, near: float = 0.0) -> complex:
    """Leading eigenvalue in radians of rotation; nan at zero speed, where the film does not move.

    `near` is the real part of that of a neighbour, if it is known.
    """
    problem = solution.problem
    if problem.bearing_number == 0.0:
        return complex(np.nan, np.nan)
    if solution.elements is not None:
        return rightmost(pencil_of(solution.elements.equations), current_run().probe_solver, near)
    linearized = problem.linearize(solution.x)
    steady = linearized.matrix(np.zeros(len(problem.weight)))
    contacts = solution.contacts
    constraints = held_contacts(solution) if contacts is None else contacts.constraints
    wall = constraints.group[problem.layout.unknowns[DEFLECTION]]
    first = int(wall.max(initial=-1)) + 1
    solver = current_run().probe_solver
    order = constraints.elimination_order(solver, problem.elimination_key)
    pencil = Pencil(constraints.reduce(steady), constraints.reduce(linearized.stored), slice(first, None), order)
    return rightmost(pencil, solver, near)


def eigenvalue_at_hand(solution: Solution) -> complex:
    """The same as the last tangent of contact points has it, near enough to tell whether it is stable.

    That is the tangent of a state close by, which takes no factorisation; exactly where there is none, or in doubt.
    """
    points = solution.elements
    if isinstance(points, PointContacts) and points.tangent is not None and points.tangent.n == points.equations.n:
        tangent = points.tangent.factor
        solve = tangent.nearly if isinstance(tangent, ServedTangent) else tangent.solve
        s = seen_through(solve, pencil_of(points.equations))
        if min(abs(s.real), abs(s.real + SLOW)) > DOUBT:
            return s
    return leading_eigenvalue(solution)


def held_contacts(solution: Solution) -> ContactConstraints:
    """Contacts that carry load, held; where some repeat others and rub, pushes of the journal there stay as they are.

    What they are does not follow from the contacts, and a pack that has bottomed out there does not move.
    """
    problem = solution.problem
    stops = problem.layout.wall.contacts.journal if problem.acting is not problem.G else None
    return constrain(problem.G, solution.active, stops, problem.acting)


def pencil_of(equations: TangentEquations) -> Pencil:
    """The matrices of petals with continuous slopes: the rows of the film are those that store."""
    first = len(equations.deflection)
    return Pencil(equations.steady, equations.stored, slice(first, first + len(equations.pressures)))
