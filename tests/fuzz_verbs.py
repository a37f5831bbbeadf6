"""Every analysis on random bearings of the whole declared domain: each run converges or ends in a typed error.

::

    make fuzz-verbs N=500   # or python -m tests.fuzz_verbs 500 [first] [--verbs orbit static] [--into outcomes.jsonl]

A run that is not done after `SECONDS` of processor time is stopped and counted as slow. Anything else that is not an
answer or a `PetalfoilError`, a warning of NumPy or SciPy included, is printed with the number of its bearing. Outcomes
are added to the file line by line, and a run goes on from what its file holds.
"""

from __future__ import annotations

import argparse
import json
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

import numpy as np

from petalfoil.analysis.known_verbs import find
from petalfoil.case import Case, Rotor
from petalfoil.errors import PetalfoilError
from tests.random_packs import wide_case

SEED = 13
SECONDS = 60.0
Arguments = dict[str, object]


class OutOfTimeError(Exception):
    """The run has had its time."""


def drawn(number: int) -> tuple[Case, Arguments]:
    """A random bearing on a coarse grid, with a rotor; and the arguments of every verb that needs some."""
    rng = np.random.default_rng([number, SEED])
    case = wide_case(rng, **{"model.cells_per_pitch": 16})
    assert case.pack is not None
    area = case.gas.ambient_pressure * 2.0 * case.bearing.journal_radius * case.bearing.length
    load = area * 10.0 ** rng.uniform(-4.0, 0.0)
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
        "eccentricities": [0.0, 0.4 * room, 0.8 * room],
        "load": (0.0, -load),
        "loads": [load],
        "to": 2.0 * case.operation.speed,
        "points": 4,
        "revolutions": 0.3,
        "levels": 2,
        "mass": rotor.mass,
        "min_film_thickness": 2.0 * case.surface.contact_film_thickness,
    }


GIVEN: dict[str, tuple[str, ...]] = {
    "check": (),
    "solve": (),
    "converge": ("levels",),
    "curve": ("eccentricities",),
    "static": ("eccentricities",),
    "balance": ("load",),
    "liftoff": ("loads",),
    "runup": ("load", "to", "points"),
    "coefficients": ("load",),
    "stability": ("load", "mass"),
    "orbit": ("load", "revolutions"),
    "capacity": ("min_film_thickness",),
    "sensitivity": (),
}
"""Arguments of each verb, of those drawn."""


def ran(number: int, verb: str) -> tuple[str, str]:
    """What became of a run, and what there is to say about it."""
    case, arguments = drawn(number)
    analysis = find(verb)
    assert analysis is not None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            warnings.filterwarnings("ignore", category=UserWarning)  # remarks on implausible inputs and answers
            analysis(case, **{name: arguments[name] for name in GIVEN[verb]}, progress=limited())
    except OutOfTimeError:
        return "slow", ""
    except PetalfoilError as failure:
        return type(failure).__name__, str(failure).partition("\n")[0]
    except Exception:
        return "UNTYPED", traceback.format_exc()
    return "converged", ""


def limited() -> Callable[[float, str], None]:
    """A progress that ends the run when it has had its time."""
    end = time.process_time() + SECONDS

    def progress(part: float, text: str) -> None:
        if time.process_time() > end:
            raise OutOfTimeError

    return progress


def main() -> None:
    """Draw, run, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--verbs", nargs="+", choices=GIVEN, default=list(GIVEN))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--into", type=Path, default=Path("build/fuzz-verbs.jsonl"))
    asked = parser.parse_args()
    into: Path = asked.into
    into.parent.mkdir(parents=True, exist_ok=True)
    wanted = [(number, verb) for number in range(asked.first, asked.first + asked.count) for verb in asked.verbs]
    outcomes = kept(into)
    with ProcessPoolExecutor(asked.jobs) as pool, into.open("w") as file:
        file.writelines(line(run, *outcome) for run, outcome in outcomes.items())
        runs = {pool.submit(ran, *run): run for run in wanted if run not in outcomes}
        for done in as_completed(runs):
            run = runs[done]
            outcomes[run] = done.result()
            file.write(line(run, *outcomes[run]))
            file.flush()
    print("| analysis | runs | outcomes |\n|---|---|---|")
    for verb in asked.verbs:
        counts = Counter(outcomes[run][0] for run in wanted if run[1] == verb)
        print(f"| {verb} | {asked.count} |", ", ".join(f"{n} {kind}" for kind, n in counts.most_common()), "|")
    for number, verb in wanted:
        kind, text = outcomes[number, verb]
        if kind == "UNTYPED":
            print(f"bearing {number}, {verb}: {text}")


def kept(path: Path) -> dict[tuple[int, str], tuple[str, str]]:
    """Outcomes in a file of an earlier run by number and verb; a line that was not finished is left out."""
    lines = path.read_text().splitlines(keepends=True) if path.exists() else []
    read = [json.loads(one) for one in lines if one.endswith("\n")]
    return {(one["number"], one["verb"]): (one["outcome"], one["text"]) for one in read}


def line(run: tuple[int, str], outcome: str, text: str) -> str:
    """One line of such a file."""
    return json.dumps({"number": run[0], "verb": run[1], "outcome": outcome, "text": text}) + "\n"


if __name__ == "__main__":
    main()
