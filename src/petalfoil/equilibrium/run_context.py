"""The context of a run: its counts, its history, its clock, its solvers, and the caller who is told of its progress.

`running` opens a run, `current_run` returns the innermost open one. Solvers write into it, so that no function hands a
log down to the next (`docs/decisions/015-run-context.md`).
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TypeVar

from petalfoil.solvers.interior_point import InteriorStep
from petalfoil.solvers.problem import PrimalDualPoint
from petalfoil.solvers.sparse_lu import Counter, LinearSolver
from petalfoil.sparsity import Elimination

T = TypeVar("T")
HistoryRow = dict[str, float | int | str]
Progress = Callable[[float, str], None]

LOG = logging.getLogger(__name__)
"""Told every step at level DEBUG: ``petalfoil --verbose``, or ``logging.basicConfig(level="DEBUG")``."""

TYPICAL_STEPS = 30.0
"""History rows of a typical cold start: the scale of the progress of a single solve."""


@dataclass
class RunContext:
    """Counts, history, clock and solvers of one run.

    Attributes
    ----------
    film, pack, probes : Counter
        Factorisations of the coupled system, of the foil pack alone, and of systems that only answer a question
        (stability, other equilibria).
    coarse : Counter
        Factorisations of all kinds on a coarser grid, whose equilibrium leads to the one that is asked for.
    history : list
        One row a step.
    elimination_orders : dict
        Elimination orders that the factorisations have learnt, by problem. A nested run shares them.
    tell : callable or None
        Called with the phase at every step.
    start : float
        Reading of the clock when the run was opened [s].
    """

    film: Counter = field(default_factory=Counter)
    pack: Counter = field(default_factory=Counter)
    probes: Counter = field(default_factory=Counter)
    coarse: Counter = field(default_factory=Counter)
    history: list[HistoryRow] = field(default_factory=list)
    elimination_orders: dict[Hashable, Elimination] = field(default_factory=dict)
    tell: Callable[[str], None] | None = None
    start: float = field(default_factory=time.perf_counter)

    @property
    def seconds(self) -> float:
        """Wall time since the run was opened [s]."""
        return time.perf_counter() - self.start

    @property
    def film_solver(self) -> LinearSolver:
        """Solver of the coupled system."""
        return LinearSolver(self.film, self.elimination_orders)

    @property
    def pack_solver(self) -> LinearSolver:
        """Solver of the foil pack alone."""
        return LinearSolver(self.pack, self.elimination_orders)

    @property
    def probe_solver(self) -> LinearSolver:
        """Solver of systems that only answer a question."""
        return LinearSolver(self.probes, self.elimination_orders)

    def note(self, phase: str, **row: float | int | str) -> None:
        """Add a row to the history."""
        self.history.append({"phase": phase, **row})
        if LOG.isEnabledFor(logging.DEBUG):
            LOG.debug("%s: %s", phase, ", ".join(map(_told, row.items())))
        if self.tell is not None:
            self.tell(phase)

    def watch(
        self, phase: str, finished: Callable[[InteriorStep], bool]
    ) -> Callable[[PrimalDualPoint, InteriorStep], bool]:
        """A stopping criterion of the interior point that also writes the history."""

        def look(point: PrimalDualPoint, step: InteriorStep) -> bool:
            self.note(
                phase,
                barrier=step.barrier,
                residual=step.residual,
                infeasibility=step.infeasibility,
                length=step.length,
                time_step=1.0 / step.rate if step.rate else 0.0,
            )
            return finished(step)

        return look

    @contextmanager
    def active(self) -> Iterator[RunContext]:
        """Make this the current run within a `with` block."""
        token = _CURRENT.set(self)
        try:
            yield self
        finally:
            _CURRENT.reset(token)

    def during(self, items: Iterator[T]) -> Iterator[T]:
        """Yield `items`, each computed within this run. The code between them is not part of it.

        A generator shares the context of its consumer, so a `with running()` around a `yield` would also count what
        the consumer does.
        """
        while True:
            with self.active():
                try:
                    item = next(items)
                except StopIteration:
                    return
            yield item


def _told(entry: tuple[str, float | int | str]) -> str:
    name, value = entry
    return f"{name} {value:.3g}" if isinstance(value, float) else f"{name} {value}"


_CURRENT: ContextVar[RunContext] = ContextVar("current_run")


def current_run() -> RunContext:
    """The innermost open run; the first call outside any run opens one for the rest of the thread."""
    run = _CURRENT.get(None)
    if run is None:
        run = RunContext()
        _CURRENT.set(run)
    return run


def new_run(progress: Progress | None = None, text: str = "", typical: float = TYPICAL_STEPS) -> RunContext:
    """A run that shares the elimination orders of the current one, if there is one.

    Parameters
    ----------
    progress : callable, optional
        Called with the fraction done, which approaches 1 as the history exceeds `typical` rows, and a text.
    text : str
        Start of that text.
    typical : float
        Rows of a typical history.
    """
    outer = _CURRENT.get(None)
    run = RunContext() if outer is None else RunContext(elimination_orders=outer.elimination_orders)
    if progress is not None:

        def tell(phase: str) -> None:
            progress(1.0 - math.exp(-len(run.history) / typical), f"{text}: {phase}")

        run.tell = tell
    return run


@contextmanager
def running(progress: Progress | None = None, text: str = "", typical: float = TYPICAL_STEPS) -> Iterator[RunContext]:
    """Open a run for a `with` block; arguments as in `new_run`."""
    with new_run(progress, text, typical).active() as run:
        yield run


@contextmanager
def counted_as_coarse() -> Iterator[RunContext]:
    """Open a run on a coarser grid for a `with` block: its factorisations are those of the `coarse` of the current one.

    Who asked is told of each step, and may end it.
    """
    outer = current_run()
    with running() as run:
        run.tell = outer.tell
        try:
            yield run
        finally:
            counters = run.film, run.pack, run.probes, run.coarse
            outer.coarse.factorizations += sum(counter.factorizations for counter in counters)
