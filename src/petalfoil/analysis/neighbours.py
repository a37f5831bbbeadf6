"""Equilibria that begin at the solution of a similar case: continuation from case to case of a study.

A memory holds the last solutions of other cases. The nearest of them with a grid of the same size is a start for
Newton's method on its active contacts: three factorisations in place of some fourteen. What it leads to counts only if
it is stable and no farther than the branch leads there; else the case begins from nothing, as it does by itself.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.equilibrium.continuation import FAR_FOLLOWED, WARM, distance, follow, predict, predicted
from petalfoil.equilibrium.run_context import current_run
from petalfoil.equilibrium.solution import Solution
from petalfoil.equilibrium.under_load import WARM as WARM_UNDER_LOAD
from petalfoil.equilibrium.under_load import newton
from petalfoil.system.coupled import CoupledProblem

Array = NDArray[np.float64]
Found = TypeVar("Found", bound="Solution | None")
Place = Mapping[str, float | int]
"""Values of the parameters of a case by path, SI."""

FROM_NEIGHBOUR = "Newton from the solution of a neighbouring case"
"""How such a solution was reached."""

MOST = 6
"""Solutions that a memory holds: each keeps the factors of its tangent."""

TRIALS = 6
"""Starts from neighbours before their time is compared with that of starts from nothing."""

AGAIN = 16
"""One case in so many still begins at a neighbour where that has not been quicker: what follows may be nearer."""


@dataclass(frozen=True)
class NeighbourSolution:
    """A solution of another case.

    Attributes
    ----------
    place : mapping
        Values of the parameters of its case.
    number : int
        Which of the equilibria of its case it is, in the order in which they were asked for.
    solution : Solution
        The solution.
    """

    place: Place
    number: int
    solution: Solution

    def fits(self, problem: CoupledProblem, load: Array | None, number: int) -> bool:
        """Whether its unknowns, contacts and load are of the same kind as those of another problem."""
        own = self.solution.problem
        same_size = own.layout.n == problem.layout.n and len(own.weight) == len(problem.weight)
        same_border = own.border.size == problem.border.size and (self.solution.load is None) == (load is None)
        return same_size and same_border and self.number == number and self.solution.contacts is not None


@dataclass
class Memory:
    """The last solutions of a study in one process, and what starts from them cost.

    Attributes
    ----------
    known : list of NeighbourSolution
        The last solutions, the newest last.
    seconds, answers : float, int
        Processor time of the starts from neighbours [s], and how many led to an answer.
    tried : int
        How many starts there were.
    cold_seconds, cold : float, int
        Processor time of starts from nothing [s], and how many there were.
    passed : int
        How many equilibria were asked for.
    place : mapping
        Values of the parameters of the present case.
    asked : int
        How many equilibria it has asked for.
    """

    known: list[NeighbourSolution] = field(default_factory=list)
    seconds: float = 0.0
    answers: int = 0
    tried: int = 0
    cold_seconds: float = 0.0
    cold: int = 0
    passed: int = 0
    place: Place = field(default_factory=dict)
    asked: int = 0

    @property
    def is_quicker(self) -> bool:
        """Whether an answer from a neighbour takes less time than one from nothing, failed starts counted."""
        if self.tried < TRIALS or not self.cold:
            return True
        return self.seconds < self.answers * self.cold_seconds / self.cold

    def nearest(self, problem: CoupledProblem, load: Array | None) -> Solution | None:
        """The solution whose parameters differ least from those of the present case, if it is worth a start."""
        fitting = [known for known in self.known if known.fits(problem, load, self.asked)]
        self.passed += 1
        if not fitting or not (self.is_quicker or self.passed % AGAIN == 0):
            return None
        return min(fitting, key=lambda known: apart(known.place, self.place)).solution

    def keep(self, solution: Solution) -> None:
        """Keep a solution for later cases."""
        self.known = [*self.known, NeighbourSolution(dict(self.place), self.asked, solution)][-MOST:]


def apart(one: Place, other: Place) -> float:
    """Square of the distance of two cases: relative differences of their parameters, 1 for one that a case lacks."""
    pairs = [(float(one.get(path, np.nan)), float(other.get(path, np.nan))) for path in {*one, *other}]
    parts = [(a - b) / max(abs(a), abs(b)) if a != b else 0.0 for a, b in pairs]
    return sum(1.0 if np.isnan(part) else part**2 for part in parts)


NOTHING = complex(math.nan, math.nan)
"""Eigenvalue where nothing was found."""

_MEMORY: ContextVar[Memory | None] = ContextVar("neighbours", default=None)


@contextmanager
def beside(memory: Memory, place: Place) -> Iterator[None]:
    """Answer a case with the solutions of others at hand."""
    memory.place, memory.asked = place, 0
    token = _MEMORY.set(memory)
    try:
        yield
    finally:
        _MEMORY.reset(token)


def begun(
    problem: CoupledProblem,
    load: Array | None,
    from_nothing: Callable[[], Found],
    rate_of: Callable[[Solution], complex] = leading_eigenvalue,
) -> tuple[Solution | Found, complex]:
    """An equilibrium and its leading eigenvalue: from a neighbouring case where that leads to a stable one.

    Parameters
    ----------
    problem : CoupledProblem
        The bearing at its speed, and at its position unless a load determines it.
    load : (n_position,) array or None
        Load over the unit of force [1].
    from_nothing : callable
        Finds the equilibrium of the case by itself; called where no neighbour leads to a stable one.
    rate_of : callable
        Finds the leading eigenvalue of what `from_nothing` found.

    Returns
    -------
    (Solution or what `from_nothing` returns, complex)
        What was found, and its eigenvalue in radians of rotation; nan where nothing was found.
    """
    memory, start = _MEMORY.get(), time.thread_time()
    known = None if memory is None else memory.nearest(problem, load)
    if memory is not None and known is not None:
        near = followed(known, problem, load)
        rate = NOTHING if near is None else leading_eigenvalue(near)
        stable = near is not None and not rate.real > 0.0
        memory.tried, memory.answers = memory.tried + 1, memory.answers + stable
        memory.seconds += time.thread_time() - start
        current_run().note("neighbour", outcome="followed" if stable else "led to no stable equilibrium")
        if near is not None and stable:
            return near, rate
    start, found = time.thread_time(), from_nothing()
    rate = NOTHING if found is None else rate_of(found)
    if memory is not None:
        memory.cold, memory.cold_seconds = memory.cold + 1, memory.cold_seconds + time.thread_time() - start
    return found, rate


def followed(known: Solution, problem: CoupledProblem, load: Array | None) -> Solution | None:
    """The equilibrium of `problem` on the branch of `known`; None where Newton's method leads to none on it."""
    here = problem if load is None else problem.at(displacement=known.problem.displacement)
    change = predict(known, here)
    start = predicted(known, here, change)
    if not here.admits(start):
        return None
    foretold = max(float(np.max(np.abs(step), initial=0.0)) for step in (change, correction(known, here, start)))
    if load is None:
        found = follow(known, here, WARM, change)
    else:
        found = newton(here, (start, known.active), load, WARM_UNDER_LOAD)
    if found is None or distance(known, found) > FAR_FOLLOWED * foretold:
        return None
    return replace(found, solution_path=FROM_NEIGHBOUR)


def correction(known: Solution, problem: CoupledProblem, x: Array) -> Array:
    """What the tangent of `known` changes at unknowns `x` of another problem, whose stiffness may be another; (n,)."""
    if known.contacts is None:
        return np.zeros_like(x)
    return np.asarray(known.contacts.tangent.tangent.step(problem.linearize(x).residual))


def keep(solution: Solution, *, alone: bool) -> None:
    """Keep a solution for the cases that follow, if it is stable and `alone`: the only one known."""
    memory = _MEMORY.get()
    if memory is not None:
        if alone:
            memory.keep(solution)
        memory.asked += 1
