"""A foil pack whose petals slide along themselves, moved a step further with Coulomb's friction, exactly (M6).

The pack without film is linear. One factorisation on the contacts of the state before, and a solve for each contact
that may open, close or rub, make the step a small dense problem of contacts and friction together
(`solvers/coulomb.py`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.equilibrium.friction_path import FrictionResult
from petalfoil.physics.dry_friction import Friction
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.contact_space import KnownState, RubbingContacts, UnitResponses
from petalfoil.solvers.coulomb import ContactForces
from petalfoil.solvers.problem import ContactProblem, Linearized, no_border
from petalfoil.solvers.sparse_lu import LinearSolver, SingularMatrixError
from petalfoil.solvers.tangent import BorderedTangent, Tangent
from petalfoil.system.friction import FrictionState, against_slip, energy_lost, slipping, slips

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Mask = NDArray[np.bool_]
Lines = Sequence[Index]
"""Numbers of gaps, (line, node) each."""

BESIDE = 1
"""Open gaps on either side of a closed one that a step may close."""

ROUNDS = 8
"""Times that gaps which the step would close are added."""

CLOSED = -1e-9
"""A gap below this, in units of the reference film, has closed."""


def rubbing_of(friction: Friction, n: int) -> RubbingContacts:
    """The gaps that rub, among all `n` unknowns."""
    share = friction.reaction_share[: friction.slip.shape[0] // friction.directions].tocoo()
    gap = np.zeros(share.shape[0], dtype=np.intp)
    gap[share.row] = share.col
    beside_wall = sp.csr_array((friction.slip.shape[0], n - friction.slip.shape[1]))
    return RubbingContacts(sp.csr_array(sp.hstack([friction.slip, beside_wall])), gap, friction.coefficient)


def beside(active: Mask, lines: Lines) -> Mask:
    """Active gaps and those next to them on their lines, (m,)."""
    out = active.copy()
    for numbers in lines:
        here = active[numbers]
        for shift in range(1, BESIDE + 1):
            wide = np.zeros_like(here)
            wide[:, shift:] |= here[:, :-shift]
            wide[:, :-shift] |= here[:, shift:]
            out[numbers] |= wide
    return out


def slide_exactly(
    pack: ContactProblem, friction: Friction, before: FrictionResult, lines: Lines, solver: LinearSolver
) -> FrictionResult | None:
    """The pack, whose equations are linear, after the state `before`; None if contacts and friction were not found.

    `lines` are the numbers of its gaps along lines.
    """
    linearized, rubbing = pack.linearize(before.x), rubbing_of(friction, len(before.x))
    tangent = tangent_at(pack, before.active, linearized, solver)
    if tangent is None:
        return None
    gaps = pack.gaps(before.x)
    change, reactions = tangent.respond(linearized.residual, gaps)
    base = change, reactions, gaps + pack.G @ change
    slip = slips(friction, before.x + change) - before.friction.slip
    slides, still = slipping(friction, before.friction), np.zeros_like(slip)
    known = KnownState(before.active, slides, gaps, before.lam, before.friction.force, still)
    doubt = beside(before.active, lines) | (base[2] < CLOSED)
    columns = UnitResponses.of(tangent, (pack.G, pack.acting), np.flatnonzero(doubt), rubbing)
    for _ in range(ROUNDS):
        found = columns.solved(base, slip, known)
        if found is None:
            return None
        x = before.x + change + columns.change @ np.concatenate([found.unknown, found.friction])
        closing = (pack.gaps(x) < CLOSED) & ~doubt
        if not closing.any():
            return reached(pack, friction, before, columns, (x, found))
        doubt |= closing
        columns = columns.with_more(tangent, (pack.G, pack.acting), np.flatnonzero(closing), rubbing)
    return None


def tangent_at(
    pack: ContactProblem, active: Mask, linearized: Linearized, solver: LinearSolver
) -> BorderedTangent | None:
    """The factorised pack with `active` gaps closed; None if these do not determine it."""
    constraints = constrain(pack.G, active, acting=pack.acting)
    if not constraints.determinate:
        return None
    matrix = linearized.matrix(np.zeros(len(active)))
    try:
        factor = constraints.factor(matrix, solver, pack.elimination_key)
    except SingularMatrixError:
        return None
    return BorderedTangent.at(Tangent(matrix, constraints, factor), no_border(len(active)), linearized)


def reached(
    pack: ContactProblem,
    friction: Friction,
    before: FrictionResult,
    columns: UnitResponses,
    at: tuple[Array, ContactForces],
) -> FrictionResult:
    """The state after the step: unknowns `x` and contact forces."""
    x, found = at
    lam, active = np.zeros(len(before.lam)), np.zeros(len(before.lam), dtype=bool)
    lam[columns.contacts], active[columns.contacts] = found.reaction(columns.space), found.states.closed
    slip = slips(friction, x)
    force = np.zeros(len(slip))
    force[columns.rubbing] = found.friction
    after = FrictionState(slip, force, friction.coefficient * friction.normal(lam))
    linearized = pack.linearize(x)
    left = linearized.residual + against_slip(friction, force, len(x)) - pack.acting.T @ lam
    residual = float(np.max(np.abs(left) / linearized.row_scale, initial=0.0))
    return FrictionResult(x, lam, active, residual, after, energy_lost(friction, before.friction, after))
