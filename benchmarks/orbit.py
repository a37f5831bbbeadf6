"""The motion of a rotor: what a step costs in factorisations, and a revolution against explicit steps."""

from __future__ import annotations

import math
import time
from collections import deque
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import explicit
import numpy as np
from measure import Row, Value, at_least, at_most, in_turn

from petalfoil.analysis.motion import Orbit
from petalfoil.analysis.release import TOLERANCE, OrbitRequest
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.classic.kernels import Engine
from petalfoil.dynamics.time_state import Instant
from petalfoil.equilibrium.linear_response import Motion
from petalfoil.solvers.constraints import tie
from petalfoil.solvers.spanning import determining
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem

EXAMPLES = Path(__file__).parents[1] / "examples"
ROTOR = {"mass": 3.0, "unbalance": 2e-6}
"""Mass [kg] and distance of its centre from the axis [m]."""
MOST_FACTORISATIONS, LEAST_RATIO = 0.15, 100.0
SETTLED = 1e-2 * TOLERANCE
"""Tolerance of the package's descent: as much of the local error as petalfoil leaves in a stage, and as the classic
method's own rule gives for a change of this size."""
TURN, PLACES = 25, 8
"""Steps of the last turn that are kept, and how many of them the explicit motion is looked at in."""
LOOPS = {Engine.NUMBA: 16_000, Engine.NUMPY: 960}
"""Steps of the loops timed together."""


@dataclass(frozen=True)
class Lane:
    """One motion of the paper's 8 petals: from balance, with unbalance, for some revolutions or some seconds.

    `sample` is the processor time for the explicit motion's counts, and for its march [s].
    """

    name: str
    kind: str
    changes: dict[str, object] = field(default_factory=dict)
    revolutions: float = 200.0
    seconds: float = math.inf
    sample: float = 30.0

    def case(self) -> Case:
        """The bearing with its rotor."""
        file = "paper_n8" if self.kind == "2d" else "paper_n8_spatial"
        return Case.load(EXAMPLES / f"{file}.toml").replace(rotor=ROTOR, **self.changes)

    @property
    def says(self) -> str:
        """Which motion."""
        case = self.case()
        cells = f"{build_problem(case).layout.wall.film.shape[1] - 1}"
        cells += f"×{case.model.axial_cells}" if self.kind == "3d" else ""
        return f"orbit, 8 petals, {self.kind}, {cells} cells"


FULL = (
    Lane("2d", "2d", sample=40.0),
    Lane("3d", "3d", {"model.cells_per_pitch": 24, "model.axial_cells": 16}, seconds=60.0, sample=40.0),
)
QUICK = (
    Lane("2d", "2d", {"model.cells_per_pitch": 16}, revolutions=2.0, sample=2.0),
    Lane("3d", "3d", {"model.cells_per_pitch": 10, "model.axial_cells": 6}, revolutions=1.0, sample=2.0),
)


@dataclass(frozen=True)
class Followed:
    """A motion that was followed: its orbit, the instants of its last turn or so, and what the steps took."""

    lane: Lane
    orbit: Orbit
    turn: tuple[Instant, ...]
    factorisations: int
    seconds: float

    @property
    def steps(self) -> int:
        """Steps that were accepted."""
        return int(self.orbit.counts["steps"])

    @property
    def revolutions(self) -> float:
        """Turns of the shaft."""
        rows = self.orbit.trace.rows
        return (rows[-1]["shaft_angle"] - rows[0]["shaft_angle"]) / (2.0 * math.pi)

    @property
    def seconds_a_turn(self) -> float:
        """Processor time of a revolution [s]; what it takes to find where it starts is not in it."""
        return self.seconds / self.revolutions


def rows(lanes: tuple[Lane, ...]) -> list[Row]:
    """All rows of all motions."""
    found: list[Row] = []
    for lane in lanes:
        motion = followed(lane)
        found += own(motion)
        with one_thread():
            found += [*against_explicit(motion), marched(motion)]
    return found


def followed(lane: Lane) -> Followed:
    """Follow a motion until its end or until its time is up."""
    orbit = Orbit.begin(lane.case(), OrbitRequest(initial="balance", revolutions=lane.revolutions))
    before, last, start = orbit.work.film.factorizations, deque([orbit.start], TURN + 2), time.process_time()
    for _ in orbit.advance():
        assert orbit.trace.last is not None  # it has just made a step
        last.append(orbit.trace.last)
        if time.process_time() - start > lane.seconds:
            break
    seconds = time.process_time() - start
    last.pop()  # the last step of a motion may have been cut short
    return Followed(lane, orbit, tuple(last), orbit.work.film.factorizations - before, seconds)


# ---------------------------------------------------------------------------------------------- petalfoil's steps


def own(motion: Followed) -> list[Row]:
    """What the steps cost."""
    lane, steps, record = motion.lane, motion.steps, motion.orbit.record().scalars
    step, times = motion.seconds / steps, factorisation(motion)
    details: dict[str, Value] = {
        "unknowns": motion.orbit.system.problem.layout.n,
        "revolutions": motion.revolutions,
        "steps": steps,
        "factorisations": motion.factorisations,
        "failed_steps": int(record["failed_steps"]),
        "rejected_steps": int(record["rejected_steps"]),
        "largest_residual": float(record["residual"]),
        "seconds": motion.seconds,
        "seconds_a_step": step,
        **times,
    }
    count, kept = (
        motion.factorisations / steps,
        f"{details['failed_steps']} failed, {details['rejected_steps']} refused",
    )
    remark = f"{steps} steps in {motion.revolutions:.3g} revolutions, {kept}"
    name, cost = f"orbit_{lane.name}", step / times["seconds_factorisation"]
    anew = f"{step / times['seconds_factorisation_anew']:.3g} where its order is found anew"
    return [
        at_most(
            f"{name}_count",
            f"{lane.says}: factorisations per step",
            count,
            MOST_FACTORISATIONS,
            details=details,
            remark=remark,
        ),
        Row(f"{name}_step", f"{lane.says}: time of a step over that of a factorisation", cost, remark=anew),
        Row(f"{name}_rate", f"{lane.says}: revolutions per minute of computing", 60.0 / motion.seconds_a_turn),
    ]


def factorisation(motion: Followed) -> dict[str, float]:
    """Time of a stage's assembly and factorisation, in the order known and with one found anew [s]."""
    (begin, end), system = motion.turn[-2:], motion.orbit.system
    stage = system.stage(begin.moving, end.tau, end.tau - begin.tau, begin)
    problem = stage.problem.at(displacement=end.e)

    held = determining(problem.G, end.closed, problem.layout.wall.contacts.journal)
    ties = tie(problem.G, held)

    def reduced() -> Motion:
        return Motion(problem, problem.linearize(end.x), held, ties)

    with one_thread():
        best = in_turn(
            {
                "seconds_factorisation": lambda: reduced().respond(0.0, LinearSolver()),
                "seconds_factorisation_anew": lambda: LinearSolver().factor(ties.reduce(reduced().steady)),
            },
            7,
        )
    return best


# ---------------------------------------------------------------------------------------------- against explicit steps


def against_explicit(motion: Followed) -> list[Row]:
    """A revolution by explicit steps over petalfoil's, with compiled loops and in NumPy; the counts are the same."""
    film_steps, each = explicit.turn(motion.orbit), []
    for place in np.linspace(0, len(motion.turn) - 2, PLACES).astype(int):
        pair = (motion.turn[place], motion.turn[place + 1])
        looked, taken = explicit.settlings(motion.orbit, pair, SETTLED, motion.lane.sample / PLACES)
        each.append(taken / looked)
    counts: dict[str, Value] = {
        "film_steps_a_turn": film_steps,
        "package_steps_a_film_step": float(np.mean(each)),
        "least_at_a_place": min(each),
        "most_at_a_place": max(each),
        "seconds_a_turn": motion.seconds_a_turn,
    }
    return [by(engine, motion, counts, (film_steps, float(np.mean(each)))) for engine in Engine]


def by(engine: Engine, motion: Followed, counts: dict[str, Value], steps: tuple[float, float]) -> Row:
    """The row of one kind of loops."""
    name, says = f"orbit_{motion.lane.name}_{engine}", f"{motion.lane.says}: explicit steps ({engine}) over petalfoil's"
    if engine is Engine.NUMBA and find_spec("numba") is None:
        return Row(name, says, None, remark="numba is not installed")
    (film_steps, each), (film, package) = steps, explicit.costs(motion.orbit, engine, LOOPS[engine])
    alone, whole = film_steps * film, film_steps * (film + each * package)
    details = counts | {
        "seconds_film_step": film,
        "seconds_package_step": package,
        "seconds_film_a_turn": alone,
        "seconds_explicit_a_turn": whole,
    }
    remark = f"estimated: {film_steps:.3g} film steps a turn, {each:.3g} of the package after each; "
    remark += f"the film alone {alone / motion.seconds_a_turn:.3g}"
    return at_least(name, says, whole / motion.seconds_a_turn, LEAST_RATIO, details=details, remark=remark)


def marched(motion: Followed) -> Row:
    """Explicit steps that find their own way, from a state near the end: how long they stay with the motion."""
    begin, end = motion.turn[-2:]
    march = explicit.ExplicitMotion(motion.orbit, begin, SETTLED)
    how = march.follow(end.tau, motion.lane.sample)
    details: dict[str, Value] = {
        "film_steps": march.film_steps,
        "pack_steps": march.pack_steps,
        "share_of_a_step": (march.tau - begin.tau) / (end.tau - begin.tau),
        "petals_moved": march.moved,
    }
    says = f"{motion.lane.says}: explicit steps (no ratio): whether they can go on"
    return Row(f"orbit_{motion.lane.name}_march", says, None, details=details, remark=how)
