"""Points of a curve past a jump: how many equilibria are known beside the branch that it has led to.

Others are looked for as `solve` does, which need not find the branch: once, and again where the contacts of the branch
have become others, or its stability. In between the number stays.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from petalfoil.analysis.branch_choice import others
from petalfoil.analysis.neighbours import NOTHING
from petalfoil.analysis.operating_point import OperatingPoint
from petalfoil.case import Case
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.branches import different
from petalfoil.equilibrium.contact_runs import runs
from petalfoil.equilibrium.led_points import with_nodal_contacts
from petalfoil.equilibrium.point_contacts import PointContacts
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.whole_length import first_attempt

ContactPattern = tuple[tuple[int, ...], ...]


@dataclass
class PastJump:
    """What is known of the branch past the last jump.

    Attributes
    ----------
    contacts : tuple or None
        Its contacts at the last point at which others were looked for; None where they are yet to be.
    stable : bool or None
        Whether it was stable there.
    known : int
        Equilibria that were found there.
    """

    contacts: ContactPattern | None = None
    stable: bool | None = None
    known: int = 0

    def told(self, case: Case, found: OperatingPoint) -> OperatingPoint:
        """A point on the branch with the number of equilibria known there."""
        here = contacts_of(found.answer)
        if here != self.contacts or found.branch.stable != self.stable:
            self.contacts, self.stable, self.known = here, found.branch.stable, count(case, found.answer)
        path = f"{found.branch.solution_path}, past a jump"
        return replace(found, branch=replace(found.branch, known_equilibria=self.known, solution_path=path))


def count(case: Case, answer: Solution) -> int:
    """Number of equilibria known beside an answer, itself included."""
    first = first_attempt(answer.problem)
    known, met = others(case, answer.problem, first, NOTHING if first is None else leading_eigenvalue(first))
    return max(known, len(different([with_nodal_contacts(answer), *met])))


def contacts_of(answer: Solution) -> ContactPattern:
    """Which surfaces touch, and in how many places: curves of contact points, or runs of nodes on each line of gaps."""
    if isinstance(answer.elements, PointContacts):
        points = answer.elements.points
        return tuple(points.curve.tolist()), tuple((points.inner > 0).astype(int).tolist())
    lines = answer.problem.layout.wall.contacts.lines
    return tuple(tuple(len(runs(answer.active[number])) for number in line.number) for line in lines)
