"""The paper's test rig: which dimensions, among those that the paper does not give, explain its Table 1?

    python examples/rig_study.py FOLDER

For every count and mount of the petals, packs are drawn evenly over the ranges (Latin hypercube, seeded), the contact
film thickness and the friction coefficient are set to what experiments 1 to 3 ask for, and the best pack of a count and
mount is refined (Nelder-Mead). All that explain the experiments are computed again on a fine grid, with the fourth
experiment as a prediction. 2-D model; about an hour on two cores. The same numbers come out each time; all is
written to FOLDER at once, and a run that was interrupted goes on from there. Told in docs/validation-rig.md.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from multiprocessing import Pool
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from scipy.optimize import minimize
from scipy.stats import qmc

from petalfoil import Case
from petalfoil.analysis.balance import balance
from petalfoil.analysis.crossings import CONTACT_FRACTION, crossing, walk
from petalfoil.analysis.session import one_thread
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.case.pack_geometry import MAX_ARC_ANGLE
from petalfoil.errors import ConvergenceError, DefinitionError

Array = NDArray[np.float64]

HERE = Path(__file__).parent

LOADS, MOMENTS, SPEEDS = (
    tuple(column)
    for column in np.loadtxt(HERE / "rig_table1.csv", delimiter=",", skiprows=2, unpack=True, dtype=float).tolist()
)  # of Table 1 [N], [N m], [rpm]
FITTED = 3  # experiments; in the fourth the bearing failed: it is predicted
SCATTER_MOMENT, SCATTER_SPEED = 0.05, 0.03  # standard deviations of experiments 1 to 3 about their means

COUNTS, MOUNTS = range(5, 13), ("hinged", "clamped")
RANGES = {  # of the unknown dimensions
    "clearance": (5e-6, 900e-6),  # above the solid pack height [m]; uniform in its logarithm
    "overlap": (1.1, 2.95),  # petal length over pitch
    "coating": (12e-6, 20e-6),  # as stated [m]
    "turn": (0.0, 1.0),  # of the roots against the load [pitches]
    "tilt": (0.0, 1.2),  # of a clamped root, over the chordal one; a hinged root turns freely
}
FLOORS = (0.3e-6, 5e-6)  # roughness of ground journal and sprayed coating together [m]
FRICTIONS = (0.05, 0.5)  # solid lubricants to bare metal

DRAWN, REFINED, KEPT = 32, 12, 8  # packs drawn for each pair; steps of each refinement; pairs refined
EXPLAINS = 9.0  # misfit up to which a drawn or refined pack is computed again on the fine grid
FIRST_FLOOR = 0.8e-6  # [m]
HOPELESS_MOMENTS, HOPELESS_SPEEDS = (
    12.0,
    60.0,
)  # misfits, levels aside, of two and more deviations each: no more is done
TOO_FAST = 3.0  # times the measured speed; no floor in the range makes up for more
OUTSIDE = 1e3  # misfit of a pack out of range
LEVEL = 0.01  # of the mean of the lift-off speeds, which the floor is to meet

out, err = Console(markup=False, highlight=False), Console(stderr=True, markup=False, highlight=False)


SEARCH, FINAL = 48, 192  # cells per pitch; from 192 to 384 lift-off speeds fall by 1 %


@dataclass(frozen=True)
class Pack:
    """The unknown dimensions; `RANGES` says what they are."""

    count: int
    mount: str
    clearance: float
    overlap: float
    coating: float
    turn: float
    tilt: float = 1.0

    def case(self, floor: float, cells: int) -> Case:
        """The rig with this pack and contact film thickness [m]."""
        rig = Case.load(HERE / "rig.toml")
        R_B, delta = rig.bearing.bushing_radius, 0.15e-3 + self.coating
        pitch, r_m = 2.0 * math.pi / self.count, R_B - delta / 2.0
        length = self.overlap * pitch * r_m
        tilt = "chordal" if self.mount == "hinged" else self.tilt * chordal(rig, r_m, length)
        return rig.replace(
            **{
                "bearing.journal_radius": R_B - (math.floor(self.overlap) + 1) * delta - self.clearance,
                "petals.count": self.count,
                "petals.mount": self.mount,
                "petals.arc_length": length,
                "petals.coating": self.coating,
                "petals.root_tilt": tilt,
                "petals.first_root": self.turn * pitch,
                "surface.contact_film_thickness": floor,
                "model.cells_per_pitch": cells,
            }
        )


def chordal(rig: Case, r_m: float, length: float) -> float:
    """Root tilt for which the free edge of the free petal lies on the bore [rad], to first order in its angle."""
    assert rig.petals is not None
    return 0.5 * length * (1.0 / r_m - 1.0 / rig.petals.bend_radius)


@dataclass(frozen=True)
class Finding:
    """What the model says of a pack. Misfits are sums of squares over the scatter of the experiments."""

    pack: Pack
    floor: float  # [m]
    friction: float
    moments: tuple[float, ...] = ()  # [N m]
    speeds: tuple[float, ...] = ()  # [rpm]
    misfit: float = math.inf
    note: str = ""

    @property
    def line(self) -> str:
        """As a line of a store."""
        return json.dumps(asdict(self))

    @classmethod
    def read(cls, line: str) -> Finding:
        """From a line of a store."""
        entries = json.loads(line)
        entries.update(pack=Pack(**entries["pack"]), moments=tuple(entries["moments"]))
        return cls(**{**entries, "speeds": tuple(entries["speeds"])})


# ------------------------------------------------------------------------------------------- one pack


def reactions(case: Case, loads: Sequence[float]) -> list[float]:
    """Sum of the contact reactions on the journal at rest under each load [N]."""
    still = [balance.record(case, (0.0, -load), speed=0.0) for load in loads]
    return [float(record.scalars["contact_normal_force"]) for record in still]


def lift_off(case: Case, load: float, near: float, share: float = CONTACT_FRACTION) -> float:
    """Lift-off speed [rpm], looked for from the speed `near`; nan if it is far above."""
    omega = near * math.pi / 30.0
    with one_thread():
        line = SpeedLine(case, (0.0, -load))
        touching, known = line.contact_fraction(omega) > share, line.known
        if touching and line.contact_fraction(TOO_FAST * omega) > share:
            return math.nan
        line.known = known
        found = crossing(line, walk(case, omega, upward=touching), share, upward=touching)
    return math.nan if found is None else found * 30.0 / math.pi


def misfit(found: Sequence[float] | Array, measured: Sequence[float], scatter: float) -> float:
    """Sum of squares of the relative differences of experiments 1 to 3 over their scatter."""
    left = np.log(np.array(found[:FITTED]) / np.array(measured[:FITTED])) / scatter
    return float(left @ left)


def judge(pack: Pack, floor: float, cells: int, known: int = FITTED) -> Finding:
    """The moments and lift-off speeds of the first `known` experiments, floor and friction set to the fitted ones."""
    loads = LOADS[:known]
    try:
        case = pack.case(floor, cells)
        arms = case.bearing.journal_radius * np.array(reactions(case, loads))
        friction = float(np.clip(np.exp(np.mean(np.log(MOMENTS[:FITTED] / arms[:FITTED]))), *FRICTIONS))
        moments = tuple((friction * arms).tolist())
        first = Finding(pack, floor, friction, moments)
        of_moments = misfit(moments, MOMENTS, SCATTER_MOMENT)
        if of_moments > HOPELESS_MOMENTS:
            return replace(first, note="moments grow with the load")
        floor, speeds = levelled(pack, floor, cells, loads)
    except DefinitionError as refused:
        return Finding(pack, floor, math.nan, note=str(refused))
    except ConvergenceError as failure:
        return Finding(pack, floor, math.nan, note=f"not converged: {failure}")
    if not np.all(np.isfinite(speeds[:FITTED])):
        return replace(first, floor=floor, note="no lift-off near the measured speeds")
    whole = of_moments + misfit(speeds, SPEEDS, SCATTER_SPEED)
    return replace(first, floor=floor, speeds=tuple(speeds), misfit=whole)


def levelled(pack: Pack, floor: float, cells: int, loads: Sequence[float]) -> tuple[float, list[float]]:
    """Contact film thickness [m] at which experiments 1 to 3 lift off at the measured mean speed, and the speeds."""
    slope, before = 0.7, (math.nan, math.nan)  # of lift-off speed over floor, in logarithms, to begin with
    speeds: list[float] = []
    for _ in range(6):
        case, speeds = pack.case(floor, cells), []
        for load, measured in zip(loads[:FITTED], SPEEDS[:FITTED], strict=False):
            speeds.append(lift_off(case, load, measured))
            if not math.isfinite(speeds[-1]):
                return floor, speeds
        above = float(np.mean(np.log(np.array(speeds) / SPEEDS[:FITTED])))
        if misfit(np.array(speeds) * math.exp(-above), SPEEDS, SCATTER_SPEED) > HOPELESS_SPEEDS:
            break
        if math.isfinite(before[0]):
            slope = float(np.clip((above - before[1]) / (math.log(floor) - before[0] or 1.0), 0.3, 2.0))
        if abs(above) < LEVEL:
            break
        before, wanted = (math.log(floor), above), float(np.clip(floor * math.exp(-above / slope), *FLOORS))
        if wanted == floor:
            break
        floor = wanted
    speeds += [lift_off(case, load, near) for load, near in zip(loads[FITTED:], SPEEDS[FITTED:], strict=False)]
    return case.surface.contact_film_thickness, speeds


# ------------------------------------------------------------------------------------------- the search


class Store:
    """Findings by pack, in a file of one line each: a run that was interrupted goes on from there."""

    def __init__(self, path: Path, cells: int, known: int = FITTED) -> None:
        self.path, self.cells, self.known = path, cells, known
        lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
        self.findings = {finding.pack: finding for finding in map(Finding.read, lines)}

    def judge(self, pack: Pack, floor: float) -> Finding:
        """The finding of a pack, computed if it is new."""
        if pack not in self.findings:
            found = judge(pack, floor, self.cells, self.known)
            with self.path.open("a", encoding="utf-8") as file:
                file.write(found.line + "\n")
            self.findings[pack] = found
        return self.findings[pack]

    @property
    def best(self) -> Finding:
        """The finding of the smallest misfit."""
        return min(self.findings.values(), key=lambda finding: finding.misfit)


def drawn(count: int, mount: str) -> Iterator[Pack]:
    """Packs spread evenly over the ranges."""
    ranges = ranges_of(count, mount)
    for point in qmc.LatinHypercube(len(ranges), seed=count).random(DRAWN):
        values = {name: low + u * (high - low) for u, (name, (low, high)) in zip(point, ranges.items(), strict=True)}
        low, high = ranges["clearance"]
        values["clearance"] = low * (high / low) ** point[0]
        yield Pack(count, mount, **{name: float(f"{value:.4g}") for name, value in values.items()})


def ranges_of(count: int, mount: str) -> dict[str, tuple[float, float]]:
    """`RANGES`, with no petal longer than a circular free shape may be, and without the tilt of a hinged root."""
    ranges = {name: limits for name, limits in RANGES.items() if name != "tilt" or mount == "clamped"}
    low, high = ranges["overlap"]
    return {**ranges, "overlap": (low, min(high, 0.999 * MAX_ARC_ANGLE * count / (2.0 * math.pi)))}


def draw(pair: tuple[int, str], folder: Path) -> Finding:
    """The best of the packs drawn for a count and a mount."""
    store = searched(*pair, folder)
    return min((store.judge(pack, FIRST_FLOOR) for pack in drawn(*pair)), key=lambda finding: finding.misfit)


def searched(count: int, mount: str, folder: Path) -> Store:
    """The store of the search for a count and a mount."""
    return Store(folder / f"search_{count}_{mount}.jsonl", SEARCH)


def refine(start: Finding, folder: Path) -> Finding:
    """The best pack near one that is known."""
    pack, store = start.pack, searched(start.pack.count, start.pack.mount, folder)
    ranges, names = (
        ranges_of(pack.count, pack.mount),
        ["overlap", "clearance"] + ["tilt"] * (pack.mount == "clamped"),
    )

    def value(steps: Array) -> float:
        moved = {name: getattr(pack, name) * math.exp(step) for name, step in zip(names, steps, strict=True)}
        if any(not ranges[name][0] <= moved[name] <= ranges[name][1] for name in names):
            return OUTSIDE
        rounded: dict[str, Any] = {name: float(f"{x:.5g}") for name, x in moved.items()}
        return min(store.judge(replace(pack, **rounded), start.floor).misfit, OUTSIDE)

    simplex = np.vstack([np.zeros(len(names)), np.diag([0.04, 0.15, 0.1][: len(names)])])
    minimize(value, simplex[0], method="Nelder-Mead", options={"maxfev": REFINED, "initial_simplex": simplex})
    return store.best


def explaining(folder: Path) -> list[Finding]:
    """The best pack near each drawn one that explains experiments 1 to 3."""
    best: dict[tuple[int, str, float], Finding] = {}
    for count in COUNTS:
        for mount in MOUNTS:
            for found in searched(count, mount, folder).findings.values():
                drawn_as = (count, mount, found.pack.turn)  # refinement leaves the turn as drawn
                if found.misfit < min(EXPLAINS, best[drawn_as].misfit if drawn_as in best else math.inf):
                    best[drawn_as] = found
    return sorted(best.values(), key=lambda found: found.misfit)


def again(finding: Finding, folder: Path) -> Finding:
    """A known pack on the fine grid, all four experiments."""
    p = finding.pack
    path = folder / f"final_{p.count}_{p.mount}_{p.turn}.jsonl"
    return Store(path, FINAL, len(LOADS)).judge(p, finding.floor)


def main(folder: Path) -> None:
    """Draw, refine, compute again; a table to standard output and to FOLDER."""
    folder.mkdir(parents=True, exist_ok=True)
    pairs = [(count, mount) for count in COUNTS for mount in MOUNTS]
    with Pool(2) as pool:
        found = told(pool.imap_unordered(partial(draw, folder=folder), pairs), len(pairs))
        start = sorted((f for f in found if math.isfinite(f.misfit)), key=lambda f: f.misfit)[:KEPT]
        told(pool.imap_unordered(partial(refine, folder=folder), start), len(start))
        sets = explaining(folder)
        final = told(pool.imap_unordered(partial(again, folder=folder), sets), len(sets))
    text = table(sorted(final, key=lambda f: f.misfit))
    (folder / "sets.md").write_text(text, encoding="utf-8")
    out.print(text, soft_wrap=True)


def told(findings: Iterable[Finding], count: int) -> list[Finding]:
    """Collect findings, each told as it comes."""
    found = []
    for finding in findings:
        found.append(finding)
        p = finding.pack
        err.print(f"{len(found)} of {count}: {p.count} petals, {p.mount}: misfit {finding.misfit:.3g}")
    return found


HEADS = (
    "", "petals", "mount", "$R_j$, mm", "$l_p$, mm", "overlap", "coating, µm", "tilt", "root angle, pitches",
    "floor, µm", "friction", "misfit", "moment 4, N·m", "lift-off 4, rpm",
)  # fmt: skip


def is_example(case: Case) -> bool:
    """Whether a pack is that of `rig.toml`, to its printed digits."""
    rig = Case.load(HERE / "rig.toml")
    assert rig.petals is not None
    assert case.petals is not None
    return (
        case.petals.count == rig.petals.count
        and abs(case.bearing.journal_radius - rig.bearing.journal_radius) < 1e-6
        and abs(case.petals.arc_length - rig.petals.arc_length) < 1e-4
    )


def table(findings: Sequence[Finding]) -> str:
    """The sets that explain the experiments best, with what they predict for the fourth, in Markdown."""
    lines = ["|" + "|".join(f" {head} " if head else " " for head in HEADS) + "|", "|---|---:|---|" + "---:|" * 11]
    for found in findings:
        p, case = found.pack, found.pack.case(found.floor, FINAL)
        assert case.petals is not None
        cells = [
            "`rig.toml`" if is_example(case) else "",
            str(p.count), p.mount, f"{case.bearing.journal_radius * 1e3:.3f}", f"{case.petals.arc_length * 1e3:.1f}",
            f"{p.overlap:.2f}", f"{p.coating * 1e6:.0f}", f"{p.tilt:.2f}", f"{p.turn:.2f}", f"{found.floor * 1e6:.2f}",
            f"{found.friction:.3f}", f"{found.misfit:.1f}", f"{found.moments[-1]:.2f}", f"{found.speeds[-1]:.0f}",
        ]  # fmt: skip
        lines.append("|" + "|".join(f" {cell} " if cell else " " for cell in cells) + "|")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python examples/rig_study.py FOLDER")
    main(Path(sys.argv[1]))
