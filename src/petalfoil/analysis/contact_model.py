"""Where contacts are: equilibria that results are taken from, and what a result says of it."""

from __future__ import annotations

from dataclasses import dataclass

from petalfoil.case import Case
from petalfoil.equilibrium.element_contacts import with_elements
from petalfoil.equilibrium.line_sets import with_lines
from petalfoil.equilibrium.small_motion import JournalMotion
from petalfoil.equilibrium.solution import Solution


@dataclass(frozen=True)
class ContactModel:
    """Where contacts are, and how far the force is from that with contacts at nodes; None where the wall has none.

    `bottomed_out` is whether active contacts chain the journal to the bushing; None of stiffness and damping.
    """

    contact_model: str | None
    nodal_force_difference: float | None = None
    bottomed_out: bool | None = None

    @classmethod
    def of(cls, answer: Solution) -> ContactModel:
        """Those of an equilibrium."""
        if not answer.problem.layout.n_wall:
            return cls(None)
        return cls(answer.contact_model, answer.nodal_force_difference, answer.bottomed_out)

    @classmethod
    def of_motion(cls, motion: JournalMotion) -> ContactModel:
        """Those of stiffness and damping."""
        return cls(motion.contact_model if motion.problem.layout.n_wall else None)


def reported(case: Case, answer: Solution, known: Solution | None = None) -> Solution:
    """The answer with the equilibrium that results are taken from: with contacts between nodes, if there is one.

    In 2-D it has petals with continuous slopes, in 3-D contact lines. The classic method and heat networks keep
    contacts at nodes. `known` is a neighbour with its own.
    """
    if case.has_contact_lines and case.heat is None:
        return with_lines(answer)
    return with_elements(answer, known) if case.has_contact_points and case.heat is None else answer
