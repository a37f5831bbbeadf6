"""Every analysis on random bearings of the whole declared domain: each run converges or ends in a typed error.

::

    make fuzz-verbs N=500                    # or python -m tests.fuzz_verbs 500 [first] [--verbs orbit static]

A run that is not done after `SECONDS` of processor time is stopped and counted as slow. Anything else that is not an
answer or a `PetalfoilError`, a warning of NumPy or SciPy included, is printed with the number of its bearing.
"""

from __future__ import annotations

import argparse
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor

import numpy as np

from petalfoil.analysis.known_verbs import find
from petalfoil.case import Case, Rotor
from petalfoil.errors import PetalfoilError
from tests.random_packages import wide_case

SEED = 13
SECONDS = 60.0
Arguments = dict[str, object]


class OutOfTimeError(Exception):
    """The run has had its time."""


def drawn(number: int) -> tuple[Case, Arguments]:
    """A random bearing on a coarse grid, with a rotor; and the arguments of every verb that needs some."""
    rng = np.random.default_rng([number, SEED])
    case = wide_case(rng, **{"model.cells_per_pitch": 16})
    assert case.package is not None
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
    asked = parser.parse_args()
    numbers = range(asked.first, asked.first + asked.count)
    print("| analysis | runs | outcomes |\n|---|---|---|")
    with ProcessPoolExecutor(asked.jobs) as pool:
        for verb in asked.verbs:
            outcomes = list(pool.map(ran, numbers, [verb] * len(numbers)))
            counts = Counter(kind for kind, _ in outcomes)
            print(f"| {verb} | {len(numbers)} |", ", ".join(f"{n} {kind}" for kind, n in counts.most_common()), "|")
            for number, (kind, text) in zip(numbers, outcomes, strict=True):
                if kind == "UNTYPED":
                    print(f"bearing {number}: {text}")


if __name__ == "__main__":
    main()
