"""A bearing with its heat network: film, petals, contacts, temperatures and, under a load, the position in one Newton.

The temperatures are bordered unknowns beside the journal's position. From the equilibrium at other temperatures two or
three tangents lead on. A pack that has bottomed out has no tangent: temperatures and equilibrium follow each other
until it has one, or both have settled. Elsewhere the friction power is raised from nothing; where it cannot be raised
to its whole, the bearing has no steady temperature.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.cold_start import solve_cold
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution, from_contacts
from petalfoil.equilibrium.under_load import rebalance
from petalfoil.errors import ConvergenceError
from petalfoil.solvers.contact_equations import (
    ContactEquations,
    ContactOptions,
    ContactState,
    Correction,
    Step,
    StepVerdict,
)
from petalfoil.solvers.contact_newton import ActiveContacts, contact_newton
from petalfoil.solvers.problem import Border
from petalfoil.solvers.tangent import BorderedTangent
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.heat_network import NODES, HeatNetwork
from petalfoil.system.heat_rows import BALANCE, HeatRows
from petalfoil.system.loaded import load_scale
from petalfoil.system.temperatures import Temperatures

Array = NDArray[np.float64]

WARMING = ContactOptions(tangents=12, rounded=1e-6)
"""Contacts move while the shaft grows."""

MOST_FILMS = 10.0
"""Longest move of the journal in a step, in reference films."""

WARMEST_STEP = 0.2
"""Largest change of a temperature in a step, over that of the gas: some 60 K."""

CORRECTIONS = 6
"""Refinements of a balance; the part of the leakage that the derivative leaves out takes one or two."""

TURNS = 60
"""Turns of temperatures and equilibrium of a bottomed-out pack; each leaves about 0.4 of the change before."""

FIRST_PART, LEAST_PART = 0.25, 1.0 / 64.0
"""First step and least step of the friction power where it is raised from nothing."""


class ThermalRunawayError(ConvergenceError):
    """No steady temperature: what the film loses grows faster with the temperature than what is carried away."""


@dataclass(frozen=True)
class HeatedEquations(ContactEquations):
    """The variant with the temperatures bordered, under a load also the position.

    Attributes
    ----------
    problem : CoupledProblem
        The bearing at its speed.
    network : HeatNetwork
        Its heat balances.
    load : (n_position,) array or None
        Load over the unit of force [1]; None where the journal is held.
    rows : HeatRows or None
        The heat balances at the last tangent.
    """

    problem: CoupledProblem
    network: HeatNetwork
    load: Array | None
    rows: HeatRows | None = None

    @property
    def _at_tangent(self) -> HeatRows:
        if self.rows is None:
            raise ValueError("the heat balances are linearised with the first tangent")
        return self.rows

    @property
    def n_free(self) -> int:
        """Coordinates of the position among the bordered unknowns."""
        return 0 if self.load is None else len(self.load)

    @property
    def border(self) -> Border:
        """How position and temperatures enter, as at the last tangent."""
        return self._at_tangent.border(None if self.load is None else self.problem.border)

    @property
    def border_stiffness(self) -> Array:
        """Minus the derivative of forces and balances by position and temperatures, the unknowns held."""
        rows, k = self._at_tangent, self.n_free
        stiffness = np.zeros((k + NODES, k + NODES))
        stiffness[k:, k:] = -rows.by_temperature / rows.scale
        if k:
            stiffness[k:, :k] = -rows.by_position / rows.scale
        return stiffness

    def at(self, b: Array) -> CoupledProblem:
        """The coupled system at a position and temperatures."""
        k, unit = self.n_free, self.network.gas.temperature
        warm = Temperatures(*(float(T) for T in b[k:] * unit))
        return self.problem.at(displacement=b[:k] if k else None, temperatures=warm)

    def unknowns(self, problem: CoupledProblem) -> Array:
        """Position and temperatures of a problem as bordered unknowns."""
        warm = (problem.temperatures or self.network.cold).nodes / self.network.gas.temperature
        return warm if self.load is None else np.append(problem.displacement, warm)

    def imbalance(self, x: Array, lam: Array, b: Array) -> Array:
        """Force of film, contacts and load on the journal, and what the nodes gain over the scale of the balances."""
        problem = self.at(b)
        rows = HeatRows(self.network, problem, x, lam)
        gained = rows.residual / (rows if self.rows is None else self.rows).scale
        if self.load is None:
            return gained
        return np.concatenate([problem.journal_force(x, lam) + self.load, gained])

    def renewed(self, state: ContactState, before: ContactState, count: int) -> HeatedEquations:
        """The same with the heat balances linearised at `state`."""
        return replace(self, rows=HeatRows(self.network, self.at(state.b), state.x, state.lam))

    def longest_step(self, at: tuple[Array, Array], correction: Correction) -> float:
        """Pressures stay positive; the journal moves by a few films, the temperatures by some tens of kelvins."""
        k = self.n_free
        farthest = MOST_FILMS / max(float(np.linalg.norm(correction.b[:k])), 1e-300)
        warmest = WARMEST_STEP / max(float(np.max(np.abs(correction.b[k:]))), 1e-300)
        return min(super().longest_step(at, correction), farthest, warmest)

    def balanced(self, x: Array, lam: Array, b: Array) -> bool:
        """Whether forces and heat balance."""
        left, k = np.abs(self.imbalance(x, lam, b)), self.n_free
        forces = True if self.load is None else bool(np.linalg.norm(left[:k]) <= BALANCE * load_scale(self.load))
        return forces and bool(np.max(left[k:]) <= BALANCE)

    def verdict(self, step: Step, options: ContactOptions) -> StepVerdict:
        """By the residual; and forces and heat must balance."""
        verdict = super().verdict(step, options)
        if verdict is not StepVerdict.CONVERGED or step.after is None:
            return verdict
        if self.balanced(step.after.x, step.after.lam, step.after.b):
            return verdict
        return StepVerdict.GO_ON if step.number + 1 < options.steps else StepVerdict.RENEW


def heated(known: Solution, network: HeatNetwork, *, gradually: bool = True) -> Solution:
    """The equilibrium with the temperatures of its heat network, from an equilibrium at other ones.

    From a neighbour with nearly the same temperatures nothing is gained by raising the power `gradually`.

    Raises
    ------
    ThermalRunawayError
        It has no steady temperature.
    """
    found = warmed(known, network)
    if found is None and known.contacts is None:
        found = by_turns(known, network)
    if found is None and not gradually:
        raise runaway(known, network, 0.0)
    return found or raised(known, network)


def warmed(known: Solution, network: HeatNetwork) -> Solution | None:
    """Newton from `known`; None if it fails."""
    equations, run = HeatedEquations(known.problem, network, known.load), current_run()
    begin = known.x, equations.unknowns(known.problem), known.active
    contacts, outcome = contact_newton(equations, begin, run.film_solver, WARMING)
    run.note("heat", outcome=outcome.value)
    if contacts is None:
        return None
    return polished(equations, contacts, known.solution_path)


def by_turns(known: Solution, network: HeatNetwork) -> Solution | None:
    """Temperatures of the equilibrium, then the equilibrium at these; None if that leads nowhere.

    As soon as a contact set determines the pack, Newton's method goes on from there.
    """
    cold = known.problem.temperatures or network.cold
    found = replace(known, problem=known.problem.at(temperatures=cold))
    for turn in range(TURNS):
        rows = HeatRows(network, found.problem, found.x, found.lam)
        left = float(np.max(np.abs(rows.residual)) / rows.scale)
        current_run().note("heat", turn=turn, imbalance=left)
        if turn and left <= BALANCE:
            return found
        change = -np.linalg.solve(network.by_temperature(rows.temperatures, rows.film_heat), rows.residual)
        part = min(1.0, WARMEST_STEP * network.gas.temperature / max(float(np.max(np.abs(change))), 1e-300))
        warm = Temperatures(*(float(T) for T in rows.temperatures.nodes + part * change))
        try:
            found = settled_at(found, warm)
        except ConvergenceError as failure:
            current_run().note("heat", outcome=str(failure))
            return None
        there = None if found.contacts is None else warmed(found, network)
        if there is not None:
            return there
    return None


def settled_at(known: Solution, warm: Temperatures) -> Solution:
    """The equilibrium at given temperatures, under the load of `known` or at its position.

    Raises
    ------
    ConvergenceError
        There is none.
    """
    problem = known.problem.at(temperatures=warm)
    return solve_cold(problem) if known.load is None else rebalance(known, problem, known.load)


def polished(equations: HeatedEquations, contacts: ActiveContacts, path: str) -> Solution | None:
    """The refined state; position and temperatures follow where it is not in balance. No factorisation."""
    state, tangent, best = contacts.state, contacts.tangent, None
    equations = replace(equations, rows=HeatRows(equations.network, equations.at(state.b), state.x, state.lam))
    b, stiffness = state.b, equations.border_stiffness - tangent.gradient
    for _ in range(CORRECTIONS):
        found = from_contacts(equations.at(b), replace(contacts, state=state), path)
        if found is None:
            return best
        best = replace(found, load=equations.load)
        if equations.balanced(found.x, found.lam, b):
            return best
        change = np.linalg.solve(stiffness, equations.imbalance(found.x, found.lam, b))
        b = b + change
        state = replace(state, x=found.x + tangent.units @ change, lam=found.lam, b=b)
    return None


def stiffness(found: Solution, network: HeatNetwork | None) -> Array:
    """Minus the derivative of the forces on the journal by its position, the temperatures following it [1].

    Shape (n_position, n_position). No factorisation: that of the last tangent serves.

    Raises
    ------
    ConvergenceError
        The pack is bottomed out: its stiffness has no bound. Or it is undecided which contacts are active.
    """
    if found.contacts is None:
        raise ConvergenceError(
            "the journal is on a bottomed-out pack, whose stiffness has no bound"
            if found.bottomed_out
            else "no stiffness: it is undecided which contacts without force are active",
            history=current_run().history,
            advice="lower the load on this bearing" if found.bottomed_out else "raise the load or the speed",
        )
    problem, last = found.problem, found.contacts.tangent
    border, resists = problem.border, np.zeros((problem.layout.n_position, problem.layout.n_position))
    if network is not None:
        rows = HeatRows(network, problem, found.x, found.lam)
        equations = HeatedEquations(problem, network, np.zeros(problem.layout.n_position), rows)
        border, resists = equations.border, equations.border_stiffness
    linearized = problem.linearize(found.x)
    forcing = np.column_stack([linearized.slack_derivative(column) for column in border.gap_derivative.T])
    if border.forcing is not None:
        forcing = forcing + border.forcing
    there = BorderedTangent.of(last.tangent, border, forcing, last.constraints, last.exchange)
    whole, k = resists - there.gradient, problem.layout.n_position
    if network is None:
        return np.asarray(whole, dtype=np.float64)
    # temperatures follow: their rows vanish
    return np.asarray(whole[:k, :k] - whole[:k, k:] @ np.linalg.solve(whole[k:, k:], whole[k:, :k]), dtype=np.float64)


def raised(known: Solution, network: HeatNetwork) -> Solution:
    """The equilibrium with the friction power raised from nothing.

    Raises
    ------
    ThermalRunawayError
        It cannot be raised to its whole.
    """
    cold = known.problem.at(temperatures=network.cold)
    found, part, step = replace(known, problem=cold), 0.0, FIRST_PART
    while part < 1.0:
        ahead = min(1.0, part + step)
        there = warmed(found, replace(network, power=ahead))
        if there is None and step <= LEAST_PART:
            raise runaway(found, network, part)
        if there is None:
            step *= 0.5
            continue
        found, part, step = there, ahead, min(2.0 * step, 2.0 * FIRST_PART)
    return found


def runaway(found: Solution, network: HeatNetwork, part: float) -> ThermalRunawayError:
    """The error of a bearing whose heat does not balance with more than a part of its friction power."""
    warm = found.problem.temperatures
    shaft = "" if warm is None else f", with the shaft at {warm.shaft:.0f} K,"
    what = "no steady temperature" if network.before is None else "thermal runaway within a time step"
    return ThermalRunawayError(
        f"{what}: the heat balances up to {100.0 * part:.0f} % of the friction power{shaft} and not beyond: as the "
        "shaft grows the film loses more than is carried away",
        history=current_run().history,
        advice="lower the speed or the load, widen the clearance, or carry more heat away (the conductances of [heat])",
    )
