"""A rigid rotor on its bearing, or in two of them where it may tilt: what its stability is asked of.

Load and mass of a rotor in two equal bearings are those of the whole rotor. Its mass centre is half-way, so that each
bearing carries half of the load and the shaft stays parallel in equilibrium: the state of one bearing is that of both.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from petalfoil.analysis.impedance import elastic
from petalfoil.analysis.tilted_journal import held
from petalfoil.case import Case
from petalfoil.dynamics.critical_mass import Whirl, neutral_whirl, whirl_impedance
from petalfoil.dynamics.natural_modes import Mode, natural_modes
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rotor_motion import Inertia
from petalfoil.equilibrium.cold_start import nothing_found
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.solvers.contact_newton import solve_contacts
from petalfoil.system.build import build_pair
from petalfoil.system.coupled import CoupledProblem
from petalfoil.walls.two_bearings import by_kind


@dataclass(frozen=True)
class RotorOnBearings:
    """A rigid rotor and what it runs in.

    Attributes
    ----------
    case : Case
        The bearing; where the rotor runs in two of them, on the grid of its whole length.
    mass : float
        Mass of the rotor [kg]; nan where none is known.
    """

    case: Case
    mass: float

    @cached_property
    def inertia(self) -> Inertia:
        """Its inertia; in two bearings with the moments of inertia of the case."""
        rotor = self.case.rotor
        if rotor is None or rotor.span is None:
            return Inertia.of_mass(self.mass)
        whole = rotor.model_copy(update={"mass": self.mass})
        return Inertia.of(whole.with_inertias(self.case.bearing.journal_radius))

    @cached_property
    def pair(self) -> CoupledProblem | None:
        """Both bearings; None where there is one."""
        return build_pair(self.case) if self.case.bearings > 1 else None

    def impedance(self, answer: Solution) -> Impedance:
        """The impedance of the bearing, or of both, about the equilibrium of one.

        Raises
        ------
        ConvergenceError
            The pack is bottomed out.
        """
        motion = elastic(self.case, held(self.case, answer))
        if self.pair is not None:
            motion = elastic(self.case, in_both(self.pair, answer))
        return whirl_impedance(motion)

    def whirl(self, impedance: Impedance, speed: float) -> Whirl:
        """The first neutral whirl at a speed [rad/s]."""
        return neutral_whirl(impedance, speed, None if self.pair is None else self.inertia)

    def modes(self, impedance: Impedance, speed: float) -> list[Mode]:
        """The natural modes at a speed [rad/s]."""
        return natural_modes(impedance, self.inertia, speed)


def whole_length(case: Case) -> Case:
    """The case on the grid of its whole length where its rotor may tilt, which half a length cannot."""
    return case.replace(**{"model.symmetry": False}) if case.bearings > 1 else case


def in_both(pair: CoupledProblem, answer: Solution) -> Solution:
    """The equilibrium of both bearings from that of one, the shaft parallel.

    Raises
    ------
    ConvergenceError
        The equations of both are not solved there.
    """
    one, both, run = answer.problem, pair.layout.unknowns, current_run()
    problem = pair.at(
        bearing_number=one.bearing_number,
        displacement=np.append(one.displacement, np.zeros_like(one.displacement)),
        temperatures=one.temperatures,
    )
    x = both.join({name: np.tile(answer.x[one.layout.unknowns[name]], 2) for name in both.sizes})
    active = np.tile(answer.active, 2)[by_kind(one.layout.wall.contacts)]
    contacts, outcome = solve_contacts(problem, (x, active), run.film_solver)
    run.note("contacts", outcome=outcome.value)
    found = from_contacts(problem, contacts, answer.solution_path)
    if found is None:
        raise nothing_found()
    return found if answer.load is None else replace(found, load=np.append(2.0 * answer.load, [0.0, 0.0]))
