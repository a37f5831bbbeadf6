"""Tables of the pages on validation: computed anew and put between their marks on the page.

    python -m benchmarks.validation_tables                             # all tables
    python -m benchmarks.validation_tables capacity                    # one of them
    python -m benchmarks.validation_tables small-motions "test rig"    # one of its rows, the others stay as they are

Run it from the root of the repository: elastica and random packs are those of `tests`. Where a table stands on
its page, `page_tables.py` tells. A good minute on one core for all.
"""

from __future__ import annotations

import sys
from functools import cache, partial
from pathlib import Path

import numpy as np
import xarray as xr
from benchmarks.page_tables import DOCS, Row, Table, write
from tests.random_packs import random_case
from tests.verification.elastica import elastica_force, linear_force, pressed_radius
from tests.verification.test_contact_slopes import apart
from tests.verification.test_results_from_points import LEAST_DIFFERENCE, TEN, on, small_motions

import petalfoil
from petalfoil import Case

EXAMPLES = Path(__file__).parents[1] / "examples"
MICRON = 1e6  # [1/m]


def example(name: str, **changes: object) -> Case:
    """A case of the examples with changes by dotted path, dots written as two underscores."""
    return Case.load(EXAMPLES / f"{name}.toml").replace(
        **{key.replace("__", "."): value for key, value in changes.items()}
    )


def number(result: xr.Dataset, name: str) -> float:
    """A result of a single point [SI]."""
    return float(np.squeeze(result[name].values))


def percent(ratio: float) -> str:
    """A ratio as a signed difference from one, two digits."""
    value = 100.0 * (ratio - 1.0)
    return (f"{value:+.1f} %" if abs(value) < 10.0 else f"{value:+.0f} %").replace("-", "−")


# ------------------------------------------------------------------------------------------- geometric linearity

BORE = {"petals__linear_about": "bore"}


def petal_forces(name: str, radius: float | None = None) -> tuple[float, float, float]:
    """Force on one petal by a journal of a mid-surface radius [m]: elastica, about free shape and bore [N]."""
    free, bore = example(name), example(name, **BORE)
    radius = pressed_radius(bore) if radius is None else radius
    return elastica_force(bore, radius), linear_force(free, radius), linear_force(bore, radius)


def pressed_petal(name: str) -> tuple[str, ...]:
    """Row of a petal pressed up to the bore."""
    exact, *linear = petal_forces(name)
    return f"{exact:.3f} N", *(f"{force:.3f} N, {percent(force / exact)}" for force in linear)


def way_of_a_petal(radius: float) -> tuple[str, ...]:
    """Row of the paper's petal at a mid-surface radius of the journal [mm]."""
    return tuple(f"{force:.3f} N" for force in petal_forces("paper_n8", 1e-3 * radius))


def preload(name: str) -> tuple[str, ...]:
    """Row of a whole pack on the centred journal."""
    packs = (example(name), example(name, **BORE))
    return tuple(
        f"{number(petalfoil.static(pack, eccentricity='0 um'), 'contact_normal_force'):.1f} N" for pack in packs
    )


ELASTICA = {
    "elastica": Table(
        "validation/elastica.md",
        "| petal | elastica | linear about the free shape (the paper, default) | linear about the bore |",
        {
            "paper, `examples/paper_n8.toml` (the same with 6 and 10 petals)": partial(pressed_petal, "paper_n8"),
            "test rig, `examples/rig.toml`": partial(pressed_petal, "rig"),
        },
    ),
    "way-of-a-petal": Table(
        "validation/elastica.md",
        "| radius | elastica | about the free shape | about the bore |",
        {f"{mm} mm": partial(way_of_a_petal, mm) for mm in (23.089, 23.589, 24.089, 24.589, 25.089)},
        words=(),
    ),
    "preload": Table(
        "validation/elastica.md",
        "| pack | about the free shape | about the bore |",
        {
            **{f"paper, {count} petals": partial(preload, f"paper_n{count}") for count in (6, 8, 10)},
            "test rig": partial(preload, "rig"),
        },
    ),
}

# ------------------------------------------------------------------------------------------- published bearings

PRINTED_LOAD = 537.0
"""Of the single-pad bump foil [N]: 352 kPa times diameter and length."""
TOP_FOIL = {"bump_foil__top_foil_thickness": "0.1016 mm"}
HELD = {"bump_foil__feet": "held"}
SINGLE_PAD: dict[str, dict[str, object]] = {
    "nothing": {},
    "contact film thickness 2 µm": {"surface__contact_film_thickness": "2 um"},
    "contact film thickness 0.5 µm": {"surface__contact_film_thickness": "0.5 um"},
    "clearance 10 µm": {"bearing__bushing_radius": "21.86 mm"},
    "clearance 50 µm": {"bearing__bushing_radius": "21.9 mm"},
    "top foil of 0.1016 mm that bends": TOP_FOIL,
    "feet of the bumps held": HELD,
}
MEASURED: dict[str, dict[str, object]] = {
    "nothing": {},
    "contact film thickness 0.5 µm": {"surface__contact_film_thickness": "0.5 um"},
    "top foil of 0.1016 mm that bends round the shaft": TOP_FOIL,
    "clearance 20 µm": {"bearing__bushing_radius": "19.07 mm"},
    "feet of the bumps held": HELD,
}
LOADS = ("50 N", "100 N", "150 N", "200 N")
SPEEDS = {"30 000": "30000 rpm", "45 000": "45000 rpm"}


def load_capacity(changes: dict[str, object]) -> tuple[str, ...]:
    """Row of the single-pad bump foil: the load at a contact fraction of 1 %, and over the printed one."""
    found = petalfoil.capacity(example("single_pad_bump_foil", **changes), contact_fraction=0.01)
    load = number(found, "load_capacity")
    return f"{load:.0f}" if load >= 1000.0 else f"{load:.1f}", f"{load / PRINTED_LOAD:.2f}"


def at_mid_plane(case: Case, load: str) -> tuple[float, float, float]:
    """Minimum film thickness at the mid-plane [µm], attitude angle [deg] and contact fraction [%] under a load."""
    point = petalfoil.balance(case, load=load)
    film = point["film_thickness"].sel(z=case.bearing.length / 2.0, method="nearest").min().item()
    angle = np.degrees(number(point, "attitude_angle"))
    return MICRON * film, float(angle), 100.0 * number(point, "contact_fraction")


@cache
def over_load(speed: str) -> list[tuple[float, float, float]]:
    """The measured bump foil at a speed, under each load."""
    return [at_mid_plane(example("measured_bump_foil", operation__speed=speed), load) for load in LOADS]


def film_or_angle(speed: str, place: int) -> tuple[str, ...]:
    """Row of one result over the load."""
    return tuple(f"{point[place]:.1f}" for point in over_load(speed))


def assumption(changes: dict[str, object]) -> tuple[str, ...]:
    """Row of the measured bump foil at 45 000 rpm under 150 N with an assumption changed."""
    film, angle, fraction = at_mid_plane(example("measured_bump_foil", **changes), "150 N")
    return f"{film:.1f}", f"{angle:.1f}", f"{fraction:.2f}"


PUBLISHED = {
    "capacity": Table(
        "validation/published-bearings.md",
        "| changed | load, N | over the printed one |",
        {label: partial(load_capacity, changes) for label, changes in SINGLE_PAD.items()},
    ),
    "mid-plane": Table(
        "validation/published-bearings.md",
        f"| speed, rpm | at the mid-plane | {' | '.join(LOADS)} |",
        {
            f"{label} | {result}": partial(film_or_angle, speed, place)
            for place, result in enumerate(("film thickness, µm", "attitude angle, deg"))
            for label, speed in SPEEDS.items()
        },
        words=(1,),
    ),
    "assumptions": Table(
        "validation/published-bearings.md",
        "| changed | film at the mid-plane, µm | attitude angle, deg | contact fraction, % |",
        {label: partial(assumption, changes) for label, changes in MEASURED.items()},
    ),
}

# ------------------------------------------------------------------------------------------- grids


def recorded_grids() -> dict[str, Row]:
    """Rows as `benchmarks/grid_accuracy.py` wrote them on its page."""
    page = (DOCS / "validation" / "grid-accuracy.md").read_text(encoding="utf-8")
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in page.splitlines() if line[:1] == "|"]
    return {label: partial(tuple, cells) for label, *cells in lines[2:]}


GRIDS_HEAD = (
    "| cells per pitch (× along the axis) | bearing force within | minimum film thickness within "
    "| peak pressure within | friction torque within |"
)
RANDOM = (1, 3, 6, 7, 8, 9)
GROUPS: dict[str, dict[str, Case]] = {
    "turbocharger": {"turbocharger": TEN["turbocharger"]},
    "six, eight, ten petals": {name: TEN[name] for name in ("six petals", "eight petals", "ten petals")},
    "test rig": {"rig": TEN["rig"]},
    f"random packs {', '.join(map(str, RANDOM))} (`tests/random_packs.py`)": {
        f"random {k}": random_case(np.random.default_rng(k), **{"model.cells_per_pitch": 128}) for k in RANDOM
    },
}


def grid_differences(bearing: Case) -> tuple[tuple[float, float, float], list[float]]:
    """Stiffness, damping and frequencies on the default grid against twice as many cells [%]; orders of the former."""
    K, C, frequencies = zip(*(small_motions(on(bearing, finer)) for finer in (1, 2, 4)), strict=True)
    apart_by = [(apart(*matrices[:2]), apart(*matrices[1:])) for matrices in (K, C)]
    orders = [float(np.log2(coarse / fine)) for coarse, fine in apart_by if coarse > LEAST_DIFFERENCE]
    frequency = float(np.max(np.abs(frequencies[0] / frequencies[1] - 1.0)))
    return (100.0 * apart_by[0][0], 100.0 * apart_by[1][0], 100.0 * frequency), orders


def small_motions_of(bearings: dict[str, Case]) -> tuple[str, ...]:
    """Row of a group of bearings: its largest differences, its least and largest order."""
    found = [grid_differences(bearing) for bearing in bearings.values()]
    orders = sorted({f"{order:.1f}" for _, some in found for order in some}, key=float)
    largest = np.max([differences for differences, _ in found], axis=0)
    return *(f"{value:.2g} %" for value in largest), " to ".join(dict.fromkeys((orders[0], orders[-1])))


GRIDS = {
    "grids": Table("validation/trust.md", GRIDS_HEAD, recorded_grids()),
    "grids-to-choose": Table("how-to/choose-the-grid.md", GRIDS_HEAD, recorded_grids()),
    "small-motions": Table(
        "validation/trust.md",
        "| bearing, contact points | stiffness | damping | natural frequency | orders |",
        {label: partial(small_motions_of, bearings) for label, bearings in GROUPS.items()},
    ),
}

# ------------------------------------------------------------------------------------------- rig with heat

STEEL = {
    "shaft": {
        "youngs_modulus": "200 GPa", "poisson_ratio": 0.3, "density": "7850 kg/m^3", "expansion": "11.5e-6 1/K"
    },
    "bushing": {"expansion": "11.5e-6 1/K"},
}  # fmt: skip
NETWORK = {
    "bushing_to_ambient": "0.6 W/K",
    "along_shaft": "1.2 W/K",
    "shaft_capacity": "700 J/K",
    "pack_capacity": "10 J/K",
    "bushing_capacity": "1000 J/K",
}
ROOM = 293.15
"""Temperature of the gas and the surroundings [K]."""
LAUNCHES = ((7, 0), (18, 0), (7, 30), (18, 30), (2, 0), (2, 30), (7, 38))
"""Conductances from pack to bushing [W/K], and how much warmer the shaft is at the start [K]."""


def launch(conductance: int, warmer: int) -> tuple[str, ...]:
    """Row of the rig's fourth experiment: run up within 20 s and down again, from a shaft that may be warm."""
    heat = {**NETWORK, "pack_to_bushing": f"{conductance} W/K", "shaft_start_temperature": ROOM + warmer}
    case = example("rig", **STEEL, heat=heat, model__cells_per_pitch=32)
    found = petalfoil.runup(case, load="104.6 N", to="30000 rpm", points=14, warm_up="20 s")
    if not np.all(found["converged"]):
        raise SystemExit(f"{conductance} W/K, +{warmer} K: {found['status'].values}")
    moment, shaft = found["friction_torque"].values, found["shaft_temperature"].values - ROOM
    top = int(np.argmax(found["speed"].values))
    return f"{moment[0]:.2f} N·m", f"{shaft[top]:+.1f} K", f"{shaft[-1]:+.1f} K", f"{moment[-1]:.2f} N·m"


HEAT = {
    "heat": Table(
        "validation-rig.md",
        "| pack to bushing | shaft at the start | starting moment | shaft at 30 000 rpm | shaft at the end "
        "| moment at the end |",
        {f"{G} W/K | +{warmer} K": partial(launch, G, warmer) for G, warmer in LAUNCHES},
        words=(),
    )
}

# ------------------------------------------------------------------------------------------- pages

TABLES = ELASTICA | PUBLISHED | GRIDS | HEAT


def main(names: list[str]) -> None:
    """Write all tables, or one, or some rows of it."""
    if not names:
        for name, table in TABLES.items():
            write(name, table, list(table.rows))
        return
    name, *labels = names
    if name not in TABLES:
        sys.exit(f"no table {name!r}; allowed: {', '.join(TABLES)}")
    unknown = [label for label in labels if label not in TABLES[name].rows]
    if unknown:
        sys.exit(f"{name} has no row {unknown[0]!r}; allowed: {'; '.join(TABLES[name].rows)}")
    write(name, TABLES[name], labels or list(TABLES[name].rows))


if __name__ == "__main__":
    main(sys.argv[1:])
