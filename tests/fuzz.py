"""Random bearings over the whole declared domain, by stratum: how many find no equilibrium.

::

    make fuzz N=2000        # or python -m tests.fuzz 2000 [first] [--edges continuous] [--into build/fuzz.jsonl]

With `--nodes` contacts stay at nodes, where every equilibrium is sought first; contact points begin there and take most
of the time. Each number draws its bearing from a generator of its own, so that one that fails can be drawn again by its
number. What is drawn and solved is added to the file line by line, and a run goes on from what its file holds.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from petalfoil.analysis.solve import point
from petalfoil.case import Case
from petalfoil.errors import ConvergenceError
from tests.random_packs import wide_case

SEED = 7


@dataclass(frozen=True)
class Drawn:
    """What became of a random bearing: None as its path where no equilibrium was found."""

    number: int
    strata: tuple[str, ...]
    solution_path: str | None
    stable: bool
    seconds: float = 0.0
    """Processor time."""


def bearing(number: int, edges: str | None = None) -> Case:
    """The random bearing of a number."""
    return wide_case(np.random.default_rng([number, SEED]), **({"model.edges": edges} if edges else {}))


def strata(case: Case) -> tuple[str, ...]:
    """The strata that a bearing counts in, each within its edges."""
    assert case.petals is not None
    assert case.pack is not None
    surface_speed = case.operation.speed * case.bearing.journal_radius
    parts = [
        "all",
        case.petals.mount.value,
        "slip" if case.model.slip else "no slip",
        within(case.petals.count, "petals", (3, 6, 13, 20)),
        within(case.pack.overlap, "overlap", (1, 2, 3, 3.9)),
        within(case.gas.ambient_pressure / 1e5, "bar", (0.1, 0.5, 2, 10)),
        within(surface_speed, "m/s", (0.5, 10, 100, 400)),
        "chordal root" if case.petals.root_tilt == "chordal" else "tilted root",
        f"{case.gas.name or 'gas by numbers'}",
    ]
    return tuple(f"{case.model.edges.value} edges, {part}" for part in parts)


def within(value: float, name: str, limits: tuple[float, ...]) -> str:
    """The interval of `limits` that a value lies in."""
    k = min(int(np.searchsorted(limits, value, side="right")), len(limits) - 1)
    return f"{limits[k - 1]:g} to {limits[k]:g} {name}"


def solved(number: int, edges: str | None = None, at_nodes: bool = False) -> Drawn:
    """Draw and solve one."""
    case = bearing(number, edges)
    if at_nodes:
        case = case.replace(**{"model.contacts": "nodes"})
    start = time.process_time()
    try:
        found = point(case).scalars
    except ConvergenceError:
        return Drawn(number, strata(case), None, False, time.process_time() - start)
    fraction, residual = found["contact_fraction"], found["residual"]
    if not (0.0 <= fraction <= 1.0 and residual <= 1e-8):  # type: ignore[operator]
        raise AssertionError(f"bearing {number}: contact fraction {fraction}, residual {residual}")
    seconds = time.process_time() - start
    return Drawn(number, strata(case), str(found["solution_path"]), bool(found["stable"]), seconds)


def kept(path: Path) -> list[Drawn]:
    """What a file of an earlier run holds; a line that was not finished is left out."""
    lines = path.read_text().splitlines(keepends=True) if path.exists() else []
    return [Drawn(**json.loads(line)) for line in lines if line.endswith("\n")]


def table(drawn: Iterable[Drawn]) -> Iterator[str]:
    """Markdown rows: stratum, bearings, without an equilibrium, unstable."""
    counts: dict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
    for one in drawn:
        for stratum in one.strata:
            count = counts[stratum]
            count[0] += 1
            count[1] += one.solution_path is None
            count[2] += one.solution_path is not None and not one.stable
    yield "| stratum | bearings | no equilibrium found | share | unstable at a fixed journal |"
    yield "|---|---|---|---|---|"
    for stratum, (all_of, lost, unstable) in sorted(counts.items()):
        yield f"| {stratum} | {all_of} | {lost} | {100.0 * lost / all_of:.1f} % | {unstable} |"


HEAD = (
    "| stratum | ambient edges: bearings | no equilibrium found | continuous edges: bearings | no equilibrium found |"
)
GROUPS = {
    "all": ("all",),
    "hinged, clamped": ("hinged", "clamped"),
    "with slip, without": ("slip", "no slip"),
    "below 0.5 bar, 0.5 to 2 bar, above 2 bar": ("0.1 to 0.5 bar", "0.5 to 2 bar", "2 to 10 bar"),
    "below 10 m/s, 10 to 100 m/s, above 100 m/s": ("0.5 to 10 m/s", "10 to 100 m/s", "100 to 400 m/s"),
    "3 to 5, 6 to 12, 13 to 20 petals": ("3 to 6 petals", "6 to 13 petals", "13 to 20 petals"),
    "overlap 1 to 2, 2 to 3, 3 to 3.9": ("1 to 2 overlap", "2 to 3 overlap", "3 to 3.9 overlap"),
    "chordal roots, tilted roots": ("chordal root", "tilted root"),
}
"""Rows of the table of docs/random-bearings.md, and the strata that each counts one after the other."""


def page_table(drawn: Sequence[Drawn]) -> Iterator[str]:
    """The table of docs/random-bearings.md."""
    bearings = Counter(stratum for one in drawn for stratum in one.strata)
    lost = Counter(stratum for one in drawn if one.solution_path is None for stratum in one.strata)
    yield from (HEAD, "|---|---:|---:|---:|---:|")
    for label, parts in GROUPS.items():
        cells = []
        for edges in ("ambient", "continuous"):
            among, without = ([counts[f"{edges} edges, {part}"] for part in parts] for counts in (bearings, lost))
            cells += [", ".join(map(str, among)), ", ".join(map(str, without))]
            if label == "all" and without[0]:
                cells[-1] += f" ({100.0 * without[0] / among[0]:.1f} %)"
        yield f"| {label} | {' | '.join(cells)} |"


def line(one: Drawn) -> str:
    """One line of such a file."""
    return json.dumps(asdict(one)) + "\n"


def main() -> None:
    """Draw, solve, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("first", type=int, nargs="?", default=0)
    parser.add_argument("--edges", choices=["ambient", "continuous"])
    parser.add_argument("--nodes", action="store_true")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--into", type=Path, default=Path("build/fuzz.jsonl"))
    asked = parser.parse_args()
    into: Path = asked.into
    into.parent.mkdir(parents=True, exist_ok=True)
    wanted = range(asked.first, asked.first + asked.count)
    earlier = kept(into)
    drawn = {one.number: one for one in earlier if one.number in wanted}
    with ProcessPoolExecutor(asked.jobs) as pool, into.open("w") as file:
        file.writelines(line(one) for one in earlier)
        file.flush()  # a run that is stopped before its first outcome loses nothing
        left = [number for number in wanted if number not in drawn]
        for done in as_completed(pool.submit(solved, number, asked.edges, asked.nodes) for number in left):
            one = done.result()
            drawn[one.number] = one
            file.write(line(one))
            file.flush()
    print("\n".join(table(drawn.values())), "", *page_table(list(drawn.values())), sep="\n")
    print("no equilibrium found:", *sorted(number for number, one in drawn.items() if one.solution_path is None))


if __name__ == "__main__":
    main()
