"""Rotor orbits: factorisations per step, and the time of a revolution against explicit time steps."""

from __future__ import annotations

import math
import time
from collections import deque
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path

import explicit
import numpy as np
import scipy.sparse as sp
from measure import Row, Value, at_least, at_most, in_turn

from petalfoil.analysis.orbit_motion import Orbit
from petalfoil.analysis.release import TOLERANCE, OrbitRequest
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.classic.kernels import KernelBackend
from petalfoil.dynamics.stage import StageOptions
from petalfoil.dynamics.time_state import Instant
from petalfoil.solvers.constraints import constrain
from petalfoil.solvers.sparse_lu import LinearSolver
from petalfoil.system.build import build_problem

EXAMPLES = Path(__file__).parents[1] / "examples"
ROTOR = {"mass": 3.0, "unbalance": 2e-6}
"""Rotor mass [kg] and distance of the mass centre from the shaft axis [m]."""
MOST_FACTORISATIONS, LEAST_RATIO = 0.15, 100.0
SETTLED = 1e-2 * TOLERANCE
"""Tolerance of the descent of the pack.

It is the fraction of the local error that petalfoil leaves in a stage, and that the classic method gives for a change
of this size.
"""
TURN, PLACES = 25, 8
"""Number of the last steps that are kept, and of those in which explicit steps are counted."""
MODELS = {"2d": "2-D", "3d": "3-D"}
LOOPS = {KernelBackend.NUMBA: 16_000, KernelBackend.NUMPY: 960}
"""Number of loop steps in one timed call."""


@dataclass(frozen=True)
class OrbitCase:
    """One orbit of the bearing with 8 petals from its equilibrium position, with unbalance.

    It ends after `revolutions` or after `seconds` of processor time. `sample` is the processor time for counting
    explicit steps, and for the explicit motion [s].
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
    def description(self) -> str:
        """Description of the motion."""
        case = self.case()
        cells = f"{build_problem(case).layout.wall.film.shape[1] - 1}"
        cells += f"×{case.model.axial_cells}" if self.kind == "3d" else ""
        return f"orbit, 8 petals, {MODELS[self.kind]}, {cells} cells"


FULL = (
    OrbitCase("2d", "2d", sample=40.0),
    OrbitCase("3d", "3d", {"model.cells_per_pitch": 24, "model.axial_cells": 16}, seconds=60.0, sample=40.0),
)
QUICK = (
    OrbitCase("2d", "2d", {"model.cells_per_pitch": 16}, revolutions=2.0, sample=0.5),
    OrbitCase("3d", "3d", {"model.cells_per_pitch": 10, "model.axial_cells": 6}, revolutions=1.0, sample=0.5),
)


@dataclass(frozen=True)
class Followed:
    """A computed motion: its orbit, the time states of its last steps, factorisations and processor time."""

    case: OrbitCase
    orbit: Orbit
    turn: tuple[Instant, ...]
    factorisations: int
    seconds: float

    @property
    def steps(self) -> int:
        """Number of accepted steps."""
        return self.orbit.taken

    @property
    def revolutions(self) -> float:
        """Number of revolutions of the shaft."""
        rows = self.orbit.trace.rows
        return (rows[-1]["shaft_angle"] - rows[0]["shaft_angle"]) / (2.0 * math.pi)

    @property
    def seconds_per_revolution(self) -> float:
        """Processor time of a revolution without that of the start position [s]."""
        return self.seconds / self.revolutions


def rows(cases: tuple[OrbitCase, ...]) -> list[Row]:
    """All rows of all motions."""
    found: list[Row] = []
    for case in cases:
        motion = followed(case)
        found += own(motion)
        with one_thread():
            found += [*against_explicit(motion), marched(motion)]
    return found


def followed(case: OrbitCase) -> Followed:
    """Compute a motion until its end or its time limit."""
    orbit = Orbit.begin(case.case(), OrbitRequest(initial="balance", revolutions=case.revolutions))
    before, last, start = orbit.run.film.factorizations, deque([orbit.start], TURN + 2), time.process_time()
    with one_thread():
        for _ in orbit.advance():
            assert orbit.trace.last is not None  # a step has just been made
            last.append(orbit.trace.last)
            if time.process_time() - start > case.seconds:
                break
    seconds = time.process_time() - start
    last.pop()  # the last step of a motion may be shorter
    return Followed(case, orbit, tuple(last), orbit.run.film.factorizations - before, seconds)


# ---------------------------------------------------------------------------------------------- petalfoil's steps


def own(motion: Followed) -> list[Row]:
    """Rows about the cost of the steps."""
    case, steps, record = motion.case, motion.steps, motion.orbit.record().scalars
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
        "seconds_per_step": step,
        **times,
    }
    count, kept = (
        motion.factorisations / steps,
        f"{details['failed_steps']} failed, {details['rejected_steps']} rejected",
    )
    remark = f"{steps} steps in {motion.revolutions:.3g} revolutions, {kept}"
    name, cost = f"orbit_{case.name}", step / times["seconds_factorisation"]
    anew = f"{step / times['seconds_factorisation_anew']:.3g} with a new elimination order"
    return [
        at_most(
            f"{name}_count",
            f"{case.description}: factorisations per step",
            count,
            MOST_FACTORISATIONS,
            details=details,
            remark=remark,
        ),
        Row(f"{name}_step", f"{case.description}: time of a step over that of a factorisation", cost, remark=anew),
        Row(
            f"{name}_rate",
            f"{case.description}: revolutions per minute of computing",
            60.0 / motion.seconds_per_revolution,
        ),
    ]


def factorisation(motion: Followed) -> dict[str, float]:
    """Time of assembly and factorisation of a stage, with a known and with a new elimination order [s]."""
    (begin, end), system = motion.turn[-2:], motion.orbit.system
    stage = system.stage(begin.moving, end.tau, end.tau - begin.tau, begin, StageOptions())
    problem = stage.problem.at(displacement=end.e)

    constraints, solver = constrain(problem.G, end.active, problem.layout.wall.contacts.journal), LinearSolver()

    def tangent() -> sp.csc_array:
        return problem.linearize(end.x).matrix(np.zeros(len(problem.weight)))

    with one_thread():
        best = in_turn(
            {
                "seconds_factorisation": lambda: constraints.factor(tangent(), solver, problem.elimination_key),
                "seconds_factorisation_anew": lambda: LinearSolver().factor(constraints.reduce(tangent())),
            },
            7,
        )
    return best


# ---------------------------------------------------------------------------------------------- against explicit steps


def against_explicit(motion: Followed) -> list[Row]:
    """Time of a revolution by explicit steps over that of petalfoil, with compiled loops and in NumPy."""
    film_steps, each = explicit.turn(motion.orbit), []
    for place in np.linspace(0, len(motion.turn) - 2, PLACES).astype(int):
        pair = (motion.turn[place], motion.turn[place + 1])
        looked, taken = explicit.settlings(motion.orbit, pair, SETTLED, motion.case.sample / PLACES)
        each.append(taken / looked)
    counts: dict[str, Value] = {
        "film_steps_per_revolution": film_steps,
        "pack_steps_per_film_step": float(np.mean(each)),
        "least_at_a_place": min(each),
        "most_at_a_place": max(each),
        "seconds_per_revolution": motion.seconds_per_revolution,
    }
    return [by(engine, motion, counts, (film_steps, float(np.mean(each)))) for engine in KernelBackend]


def by(engine: KernelBackend, motion: Followed, counts: dict[str, Value], steps: tuple[float, float]) -> Row:
    """The row of one implementation of the loops."""
    name, description = (
        f"orbit_{motion.case.name}_{engine}",
        f"{motion.case.description}: explicit steps ({engine}) over petalfoil's",
    )
    if engine is KernelBackend.NUMBA and find_spec("numba") is None:
        return Row(name, description, None, remark="numba is not installed")
    (film_steps, each), (film, pack) = steps, explicit.costs(motion.orbit, engine, LOOPS[engine])
    alone, whole = film_steps * film, film_steps * (film + each * pack)
    details = counts | {
        "seconds_film_step": film,
        "seconds_pack_step": pack,
        "seconds_film_per_revolution": alone,
        "seconds_explicit_per_revolution": whole,
    }
    remark = f"estimated: {film_steps:.3g} film steps per revolution, {each:.3g} of the pack after each; "
    remark += f"the film alone {alone / motion.seconds_per_revolution:.3g}"
    return at_least(
        name, description, whole / motion.seconds_per_revolution, LEAST_RATIO, details=details, remark=remark
    )


def marched(motion: Followed) -> Row:
    """An explicit motion from a state near the end: the time until it leaves the motion of petalfoil."""
    begin, end = motion.turn[-2:]
    march = explicit.ExplicitMotion(motion.orbit, begin, SETTLED)
    how = march.follow(end.tau, motion.case.sample)
    details: dict[str, Value] = {
        "film_steps": march.film_steps,
        "pack_steps": march.pack_steps,
        "fraction_of_a_step": (march.tau - begin.tau) / (end.tau - begin.tau),
        "petals_moved": march.moved,
    }
    description = f"{motion.case.description}: explicit steps (no ratio): whether they can go on"
    return Row(f"orbit_{motion.case.name}_march", description, None, details=details, remark=how)
