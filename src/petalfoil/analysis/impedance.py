"""Small motions of the journal about an equilibrium: stiffness and damping at a whirl frequency (E5)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.dynamics.harmonic_balance import SlidingContacts
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rubbing_cycle import HarmonicsTold, RubbingCycle
from petalfoil.equilibrium.element_contacts import near_nodes
from petalfoil.equilibrium.element_response import ElementMotion
from petalfoil.equilibrium.led_points import with_nodal_contacts
from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.equilibrium.linear_response import SmallMotion
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.small_motion import HELD_AT_NODES, ElementEquilibrium, Motion
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import ConvergenceError
from petalfoil.physics.dry_friction import Friction
from petalfoil.system.friction import friction_at_points, friction_of, friction_on_lines
from petalfoil.system.point_layout import PointLayout

Array = NDArray[np.float64]

SLOW = 1e-6
"""Whirl ratio that stands for zero: stiffness depends on its square."""

FEW = 3
"""Most frequencies that are solved for one by one: a reduced model costs three factorisations and its basis."""


@dataclass(frozen=True)
class CycleImpedance:
    """Stiffness and damping where contacts rub.

    Attributes
    ----------
    stiffness, damping : (d, d) array
        `K` [N/m] and `C` [N s/m].
    changes : (d, d) array, (d, d) array
        By how much they differ from those with half as many harmonics of the slips; nan with one harmonic.
    told : HarmonicsTold
        Harmonics of the slips.
    """

    stiffness: Array
    damping: Array
    changes: tuple[Array, Array]
    told: HarmonicsTold


def sliding_at(case: Case, answer: Solution) -> SlidingContacts | None:
    """Contacts at nodes that slide under load, if petals have friction."""
    layout = answer.problem.layout
    friction = friction_of(case, layout)
    return None if friction is None else SlidingContacts.at(friction, answer.lam)


def elastic(case: Case, answer: Solution) -> Motion:
    """Small motions about `answer`, petals with friction stick; see `elastic_and_sliding`."""
    return elastic_and_sliding(case, answer)[0]


def elastic_and_sliding(case: Case, answer: Solution) -> tuple[Motion, SlidingContacts | None]:
    """Small motions about `answer`, petals with friction stick; and the contacts under load that would slide.

    They are those of petals with continuous slopes or of contact lines where such an equilibrium is found, else of the
    nodes of `answer`.

    Raises
    ------
    ConvergenceError
        The pack is bottomed out: the journal cannot move without bending what has no clearance to bend.
    """
    found = answer.elements if answer.friction is not None else near_nodes(answer)
    if found is not None:
        return on_elements(case, found)
    friction, lines = friction_of(case, answer.problem.layout), answer.lines
    if lines is not None and friction is None:
        return lines.motion, None
    if isinstance(lines, LineContacts) and friction is not None and friction.exact:
        return on_lines(friction, lines)
    answer = with_nodal_contacts(answer)
    sliding = sliding_at(case, answer)
    if answer.friction is not None and sliding is not None:  # a contact that sticks does not travel
        stuck = SmallMotion.at_nodes(answer, sliding.sticking(len(answer.x)))
        return replace(stuck, contact_model=HELD_AT_NODES, stuck=sliding.friction), sliding
    motion = SmallMotion.about(answer, None if sliding is None else sliding.sticking(len(answer.x)))
    if not motion.contacts.constraints.determinate:
        raise ConvergenceError(
            "no coefficients: the journal is on a bottomed-out pack, its stiffness has no bound",
            history=current_run().history,
            advice="lower the load, or ask `balance` what part of it solid contact carries",
        )
    return (motion if sliding is None else replace(motion, stuck=sliding.friction)), sliding


def on_lines(friction: Friction, found: LineContacts) -> tuple[Motion, SlidingContacts]:
    """Small motions about an equilibrium with contact lines, petals stick; and its contacts that would slide."""
    reactions = np.concatenate([found.held_reaction, found.reaction])
    sliding = SlidingContacts.at(friction_on_lines(friction, found.held, found.points), reactions)
    return replace(found.motion, sticking=sliding.sticking(len(found.x)), stuck=sliding.friction), sliding


def on_elements(case: Case, found: ElementEquilibrium) -> tuple[Motion, SlidingContacts | None]:
    """Small motions about an equilibrium of petals with continuous slopes, and its contacts that would slide."""
    layout = found.equations.problem.layout
    friction = friction_of(case, layout)
    if friction is None:
        return ElementMotion(found), None
    whole = PointLayout(found.pack, layout)
    points = found.friction_points
    sliding = SlidingContacts.at(friction_at_points(friction, whole, points), points.reaction)
    return ElementMotion(found, sliding.friction), sliding


def impedances(motion: Motion, frequencies: Array, speed: float) -> list[tuple[Array, Array]]:
    """`K` [N/m] and `C` [N s/m] at whirl frequencies [rad/s], each (2, 2): by a reduced model where it is cheaper."""
    if len(frequencies) <= FEW:
        return [impedance(motion, frequency, speed) for frequency in frequencies]
    ratios = np.maximum(frequencies / speed, SLOW)
    whirl = Impedance.over(motion, np.sort(ratios).tolist())
    Z = [whirl.at_ratio(nu) for nu in ratios]
    return [(one.real, one.imag / (nu * speed)) for one, nu in zip(Z, ratios, strict=True)]


def impedance(motion: Motion, frequency: float, speed: float) -> tuple[Array, Array]:
    """`K` [N/m] and `C` [N s/m] (E5) at one whirl frequency [rad/s], each (d, d); one factorisation.

    At a frequency of zero, `C` is the limit of small ones.
    """
    scales = motion.problem.layout.scales
    nu = max(frequency / speed, SLOW)
    Z = -motion.respond(nu, current_run().probe_solver).force_gradient * scales.force / scales.length
    return Z.real, Z.imag / (nu * speed)


def cycle_impedance(
    motion: Motion, frequency: float, speed: float, rubs: tuple[SlidingContacts, float], least: int = 0
) -> CycleImpedance:
    """The same where contacts rub in a whirl of an amplitude [m].

    `motion` is without their friction. Slips have at least so many harmonics as `least` says.

    Raises
    ------
    ConvergenceError
        Slips and friction did not agree.
    """
    scales, (sliding, amplitude) = motion.problem.layout.scales, rubs
    cycle = RubbingCycle.of(sliding, motion, 1j * frequency / speed, amplitude / scales.length, least)
    found = cycle.force_gradient()
    Z, change = (-gradient * scales.force / scales.length for gradient in (found.force, found.change))
    return CycleImpedance(Z.real, Z.imag / frequency, (change.real, change.imag / frequency), found.told)
