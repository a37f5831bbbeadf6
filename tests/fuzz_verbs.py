"""Every analysis on random bearings of the whole declared domain: each run converges or ends in a typed error.

::

    make fuzz-verbs N=500   # or python -m tests.fuzz_verbs 500 [first] [--verbs orbit static] [--into outcomes.jsonl]

Every 25 bearings meet all verbs, the cheapest first. A run that is not done after `SECONDS` of processor time, or those
of `--seconds`, is stopped and counted as slow. Anything else that is not an answer or a `PetalfoilError`, a warning of
NumPy or SciPy included, is printed with the number of its bearing. Outcomes are added to the file line by line, and a
run goes on from what its file holds; `--table` prints what it holds and runs nothing.
"""

from __future__ import annotations

import argparse
import json
import signal
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import Pool
from pathlib import Path
from typing import NoReturn

import numpy as np
import xarray as xr

from petalfoil.analysis.known_verbs import find
from petalfoil.case import Case, Rotor
from petalfoil.errors import PetalfoilError
from petalfoil.report.case_report import design_report
from petalfoil.studies.optimize import optimize
from petalfoil.studies.question import ERROR
from petalfoil.studies.run import Execution
from petalfoil.studies.sweep import sweep
from petalfoil.studies.tolerance import tolerance
from tests.random_packs import wide_case

SEED = 13
SECONDS = 60.0
ROUND = 25
CELLS = 8
"""Cells per pitch."""
EASY = 51
"""A bearing that each verb answers in a few seconds."""
POINTS_EVERY = 32
POINTS_TAKE = 5.0
"""Processor time of contacts at points over that of contacts at nodes, at least."""
MOST_PETALS = 20
FEW_PETALS = 8
COSTLY = ("tolerance", "optimize", "runup", "report", "capacity")
"""Verbs that solve many states: on bearings of few petals."""
Arguments = dict[str, object]


class OutOfTime(BaseException):
    """The run has had its time. No handler of errors may take it for one."""


@dataclass(frozen=True)
class Ran:
    """What became of a run: "converged", the name of a typed error, "slow" or "UNTYPED"."""

    number: int
    verb: str
    outcome: str
    text: str = ""
    seconds: float = 0.0
    """Processor time."""


def pack(number: int, petals: int) -> tuple[Case, np.random.Generator]:
    """The first random bearing of a number that has at most so many petals, on a coarse grid, and its generator."""
    rng = np.random.default_rng([number, SEED])
    contacts = {"model.petal_cells": 12} if number % POINTS_EVERY == 0 else {"model.contacts": "nodes"}
    while True:
        case = wide_case(rng, **{"model.cells_per_pitch": CELLS, **contacts})
        if case.petals is not None and case.petals.count <= petals:
            return case, rng


def drawn(number: int, petals: int = MOST_PETALS) -> tuple[Case, Arguments]:
    """A random bearing of at most so many petals with a rotor; and the arguments of every verb that needs some.

    One bearing in 32 has its contacts at points between nodes, on the coarsest petals that there are. Those take
    ten times the time of contacts at nodes, which the others have.
    """
    case, rng = pack(number, petals)
    assert case.pack is not None
    area = case.gas.ambient_pressure * 2.0 * case.bearing.journal_radius * case.bearing.length
    load = area * 10.0 ** rng.uniform(-4.0, -1.0)
    span = 2.0 * case.bearing.length if rng.random() < 0.3 else None
    rotor = Rotor(
        mass=max(load / 9.81, 1e-6) * (1.0 if span is None else 2.0),
        unbalance=10.0 ** rng.uniform(-9.0, -6.0),
        span=span,
        transverse_inertia=0.0 if span is None else load / 9.81 * span**2,
    )
    case = case.replace(rotor=rotor, **{"surface.petal_friction": float(rng.choice([0.0, 0.1]))})
    room = max(case.pack_clearance, 1e-6)
    return case, {
        "eccentricities": [0.0, 0.6 * room],
        "load": (0.0, -load),
        "loads": [load],
        "to": 2.0 * case.operation.speed,
        "points": 3,
        "revolutions": 0.1,
        "levels": 2,
        "mass": rotor.mass,
        "min_film_thickness": 2.0 * case.surface.contact_film_thickness,
        "vary": ["petals.thickness", "operation.speed"],
        "contacts": case.model.contacts,
    }


GIVEN: dict[str, tuple[str, ...]] = {
    "check": (),
    "solve": (),
    "static": ("eccentricities",),
    "balance": ("load",),
    "curve": ("eccentricities",),
    "converge": ("levels",),
    "coefficients": ("load",),
    "sensitivity": ("vary", "contacts"),
    "stability": ("load", "mass"),
    "liftoff": ("loads",),
    "runup": ("load", "to", "points"),
    "orbit": ("load", "revolutions"),
    "capacity": ("min_film_thickness",),
}
"""Arguments of each analysis, of those drawn."""

ALONE = Execution(workers=0)
"""Studies in this process, whose time is limited."""


def swept(case: Case, arguments: Arguments) -> None:
    """Two speeds."""
    speeds = [0.5 * case.operation.speed, case.operation.speed]
    refuse_mistakes(sweep(case, {"operation.speed": speeds}, execution=ALONE))


def scattered(case: Case, arguments: Arguments) -> None:
    """Two bearings whose petals scatter, under a load."""
    scatter, load = {"petals.thickness": "± 1 %"}, arguments["load"]
    refuse_mistakes(tolerance(case, scatter, "balance", samples=2, execution=ALONE, load=load))


def optimised(case: Case, arguments: Arguments) -> None:
    """Two designs under a load."""
    assert case.petals is not None
    thin, thick = 0.95 * case.petals.thickness, 1.02 * case.petals.thickness
    vary, wanted = {"petals.thickness": f"{thin} m : {thick} m"}, "min_film_thickness"
    load = arguments["load"]
    refuse_mistakes(optimize(case, vary, "balance", maximize=wanted, budget=2, execution=ALONE, load=load))


def reported(case: Case, arguments: Arguments) -> None:
    """A page for a design review, without error bars."""
    with tempfile.TemporaryDirectory() as folder:
        design_report(case, folder, load=arguments["load"], error=False)


OF_MANY: dict[str, Callable[[Case, Arguments], None]] = {
    "sweep": swept,
    "tolerance": scattered,
    "optimize": optimised,
    "report": reported,
}
"""Commands that ask analyses many times."""


class MistakeError(Exception):
    """A case of a study ended in an error that nobody gave a type."""


def refuse_mistakes(study: xr.Dataset) -> None:
    """Raise what a study keeps as an internal error of a case.

    Raises
    ------
    MistakeError
        There is one.
    """
    for status, reason in zip(np.ravel(study["status"].values), np.ravel(study["reason"].values), strict=True):
        if status == ERROR:
            raise MistakeError(reason)


def analysed(verb: str, case: Case, arguments: Arguments) -> None:
    """Ask one analysis."""
    analysis = find(verb)
    assert analysis is not None
    analysis(case, **{name: arguments[name] for name in GIVEN[verb]})


COSTS = (
    *("check", "balance", "coefficients", "stability", "solve", "sweep", "tolerance", "optimize", "curve", "static"),
    *("converge", "liftoff", "sensitivity", "orbit", "runup", "report", "capacity"),
)
RUNS = {verb: OF_MANY.get(verb, partial(analysed, verb)) for verb in COSTS}
"""Every verb, the cheapest first."""


def ran(number: int, verb: str, seconds: float = SECONDS) -> Ran:
    """Run one verb on one bearing; contacts at points have longer."""
    case, arguments = drawn(number, FEW_PETALS if verb in COSTLY else MOST_PETALS)
    if case.model.contacts == "points":
        seconds *= POINTS_TAKE
    begun = time.process_time()
    outcome, text = "converged", ""
    try:
        with warnings.catch_warnings(), limited(seconds):
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", category=UserWarning)  # remarks on implausible inputs and answers
            RUNS[verb](case, arguments)
    except OutOfTime:
        outcome = "slow"
    except PetalfoilError as failure:
        outcome, text = type(failure).__name__, str(failure).partition("\n")[0]
    except Exception:
        outcome, text = "UNTYPED", traceback.format_exc()
    return Ran(number, verb, outcome, text, round(time.process_time() - begun, 2))


def ran_as(which: tuple[int, str], seconds: float) -> Ran:
    """A run by number and verb, in a process of its own: one that is stopped may leave locks of a library closed."""
    return ran(*which, seconds)


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    """End what runs within when it has had its processor time.

    A callback that Python calls by itself swallows what ends it, so that it is told again.
    """

    def stop(*_: object) -> NoReturn:
        raise OutOfTime

    former = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds, 1.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, former)


def in_rounds(first: int, count: int, verbs: list[str]) -> Iterator[tuple[int, str]]:
    """Runs in rounds of `ROUND` bearings, each with all verbs: a run that is stopped has met every verb."""
    for begin in range(first, first + count, ROUND):
        for verb in verbs:
            for number in range(begin, min(begin + ROUND, first + count)):
                yield number, verb


HEAD = "| verb | runs | converged | typed errors | stopped by the limit | untyped errors |"


def table(done: list[Ran]) -> Iterator[str]:
    """The table of docs/random-bearings.md, the processor time of a run of each verb, and untyped errors."""
    yield from (HEAD, "|---|---:|---:|---:|---:|---:|")
    seconds = []
    for verb in RUNS:
        of_verb = [one for one in done if one.verb == verb]
        counts = Counter(one.outcome for one in of_verb)
        typed = len(of_verb) - sum(counts[kind] for kind in ("converged", "slow", "UNTYPED"))
        cells = (len(of_verb), counts["converged"], typed, counts["slow"], counts["UNTYPED"])
        yield f"| `{verb}` | {' | '.join(map(str, cells))} |"
        seconds.append(f"{verb} {sum(one.seconds for one in of_verb) / max(len(of_verb), 1):.2f} s")
    yield f"\nprocessor time of a run: {', '.join(seconds)}"
    for one in done:
        if one.outcome == "UNTYPED":
            yield f"bearing {one.number}, {one.verb}: {one.text}"


def kept(path: Path) -> list[Ran]:
    """Outcomes in a file of an earlier run; a line that was not finished is left out."""
    lines = path.read_text().splitlines(keepends=True) if path.exists() else []
    return [Ran(**json.loads(one)) for one in lines if one.endswith("\n")]


def line(one: Ran) -> str:
    """One line of such a file."""
    return json.dumps(asdict(one)) + "\n"


def main() -> None:
    """Draw, run, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--verbs", nargs="+", choices=RUNS, default=list(RUNS))
    parser.add_argument("--seconds", type=float, default=SECONDS)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--into", type=Path, default=Path("build/fuzz-verbs.jsonl"))
    parser.add_argument("--table", action="store_true")
    asked = parser.parse_args()
    into: Path = asked.into
    into.parent.mkdir(parents=True, exist_ok=True)
    done = kept(into)
    if not asked.table:
        known = {(one.number, one.verb) for one in done}
        wanted = [run for run in in_rounds(asked.first, asked.count, asked.verbs) if run not in known]
        for verb in asked.verbs:
            ran(EASY, verb)  # loads what the verb needs, once for all processes of runs
        with Pool(asked.jobs, maxtasksperchild=1) as pool, into.open("w") as file:
            file.writelines(line(one) for one in done)
            file.flush()  # a run that is stopped before its first outcome loses nothing
            for run in pool.imap_unordered(partial(ran_as, seconds=asked.seconds), wanted):
                done.append(run)
                file.write(line(done[-1]))
                file.flush()
    print("\n".join(table(done)))


if __name__ == "__main__":
    main()
