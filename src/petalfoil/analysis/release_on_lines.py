"""Motions with contact lines: of which bearings, and the journal released from a film and petals that touch on them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.analysis.release_at_nodes import released
from petalfoil.case import Case
from petalfoil.dynamics.line_path import on_lines_instant
from petalfoil.dynamics.time_state import Instant
from petalfoil.dynamics.tr_bdf2 import RotorBearing
from petalfoil.equilibrium.followed_lines import followed_lines
from petalfoil.equilibrium.line_contacts import LineContacts, NoLinesError
from petalfoil.equilibrium.run_context import current_run
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]


def lines_in_time(case: Case, layout: BearingLayout, friction: Friction | None) -> bool:
    """Whether contacts of a motion are lines between nodes: of one bearing in 3-D without friction between petals."""
    return case.has_contact_lines and case.bearings == 1 and friction is None and not layout.fields


def lines_beside(known: LineContacts, problem: CoupledProblem) -> LineContacts | None:
    """The equilibrium at a fixed position from that of a balance near by; None where it is lost on the way.

    The position of the balance itself has the same state.
    """
    if known.problem.layout.n != problem.layout.n:
        return None
    same = known.under(problem, None)
    if same.balanced:
        return same
    try:
        return followed_lines(known, problem, None)
    except NoLinesError as failure:
        current_run().note("followed", outcome=str(failure))
        return None


def released_on_lines(system: RotorBearing, tau: float, lines: LineContacts, moving: tuple[Array, Array]) -> Instant:
    """An instant from film, petals and contact lines, position and velocity: its rates by the equations."""
    start = released(system, tau, (lines.x, lines.lam, lines.active), moving)
    return on_lines_instant(tau, lines, start.moving, start.change)
