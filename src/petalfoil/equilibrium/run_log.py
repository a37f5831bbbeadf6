"""The work of one run: its linear solver, what it counted, what it went through, whom it tells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from petalfoil.solvers.cone import ConePoint
from petalfoil.solvers.interior_point import Step
from petalfoil.solvers.sparse_lu import Counter, LinearSolver

HistoryRow = dict[str, float | int | str]
Progress = Callable[[float, str], None]


@dataclass
class RunLog:
    """Counts and history of one run.

    Attributes
    ----------
    film, package, probes : Counter
        Factorisations of the coupled system, of the package alone, and of systems that only asked a question
        (stability, other equilibria).
    history : list
        One row a step.
    tell : callable or None
        Told of every step.
    """

    film: Counter = field(default_factory=Counter)
    package: Counter = field(default_factory=Counter)
    probes: Counter = field(default_factory=Counter)
    history: list[HistoryRow] = field(default_factory=list)
    tell: Callable[[str], None] | None = None

    @property
    def film_solver(self) -> LinearSolver:
        """Solver of the coupled system."""
        return LinearSolver(self.film)

    @property
    def package_solver(self) -> LinearSolver:
        """Solver of the package alone."""
        return LinearSolver(self.package)

    @property
    def probe_solver(self) -> LinearSolver:
        """Solver of systems that only ask a question."""
        return LinearSolver(self.probes)

    def note(self, phase: str, **row: float | int | str) -> None:
        """Add a row to the history."""
        self.history.append({"phase": phase, **row})
        if self.tell is not None:
            self.tell(phase)

    def watch(self, phase: str, content: Callable[[Step], bool]) -> Callable[[ConePoint, Step], bool]:
        """A watch for the interior point that writes the history and stops when `content`."""

        def look(point: ConePoint, step: Step) -> bool:
            self.note(
                phase,
                barrier=step.barrier,
                residual=step.residual,
                infeasibility=step.infeasibility,
                length=step.length,
                time_step=1.0 / step.rate if step.rate else 0.0,
            )
            return content(step)

        return look
