"""What is hardly ever meant, or lies outside what the model holds for: one line each, with the reason and what to do.

A case that is possible is never refused for being unlikely; it is answered, with warnings beside the answer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from petalfoil.case.definitions import Case
from petalfoil.case.measured_shape import row_errors
from petalfoil.case.petal_table import PetalTheory
from petalfoil.case.sections import ModelKind
from petalfoil.units.writing import format_quantity

Scalars = Mapping[str, float | int | bool | str]

MAX_STRESS = 2e9
"""Yield strength of the strongest spring steels and nickel alloys in foils [Pa]."""

MAX_MACH = 0.7
"""Mach number of the journal's surface above which the gas heats by tens of kelvins and its inertia matters."""

HEAT_CAPACITY_RATIO = 1.4
"""Of air and other gases of two atoms; 1.67 of noble gases makes the Mach number 9 % smaller."""

MAX_KNUDSEN = 0.1
"""Mean free path over film thickness above which first-order slip no longer holds (Burgdorfer 1959)."""

MIN_CONTACT = 1e-3
"""Fraction of the force on the journal that solid contact must carry to be called contact."""

MIN_ROWS = 6
"""Rows of a measured free shape from which its error can be estimated."""

SCATTER = 6.0
"""Standard deviations by which the worst of some hundred rows misses its neighbours: they scatter as it does."""

MIXED = 3.0
"""Minimum film thickness over contact film thickness below which peaks of the surfaces touch now and then: the film
parameter of mixed lubrication."""

TAYLOR = 41.2
"""Reynolds number of the film over the root of radius over film, from which on vortices form (Taylor 1923)."""

WIDE = 0.1
"""Error bar over the result above which the result is known to its order of magnitude only."""

JUDGED = (
    *("bearing_force", "min_film_thickness", "peak_pressure", "friction_torque", "max_bending_stress"),
    *("critical_mass", "threshold_speed", "liftoff_speed", "starting_torque"),
)
"""Results whose error bars are judged: others may vanish, as a force across the load does."""

BOTTOMED_OUT = ("bottomed out",)
"""Words in the solution path of a foil pack that a load has closed to its solid height."""


@dataclass(frozen=True)
class Usual:
    """Values of a quantity that bearings have.

    Attributes
    ----------
    key : str
        Dotted path in the case.
    low, high : float
        Smallest and largest usual value [`unit`].
    unit : str
        SI unit.
    why : str
        What lies in this range.
    ask : str
        What may have gone wrong, and what to do.
    """

    key: str
    low: float
    high: float
    unit: str
    why: str
    ask: str

    def warning(self, value: float) -> Iterator[str]:
        """Yield a warning where `value` [`unit`] is unusual."""
        if self.low <= value <= self.high:
            return
        given, low, high = (format_quantity(number, self.unit) for number in (value, self.low, self.high))
        yield f"{self.key}: {given} is outside {low} to {high}, {self.why}; {self.ask}"


USUAL = (
    Usual(
        "petals.youngs_modulus", 1e9, 1e12, "Pa", "where metals and polymers lie",
        "if it was typed in MPa or psi, write the unit, as in '200 GPa'",
    ),
    Usual(
        "gas.viscosity", 5e-6, 1e-4, "Pa*s", "where gases lie",
        "if it was typed in mPa s or cP, write the unit, as in '18.5 uPa*s'; liquids are not modelled",
    ),
    Usual(
        "gas.ambient_pressure", 1e3, 1e7, "Pa", "where gas bearings run",
        "if it was typed in bar or psi, write the unit, as in '1 bar'; it is the absolute pressure",
    ),
    Usual(
        "gas.temperature", 100.0, 1500.0, "K", "where gas bearings run",
        "if it was typed in degrees Celsius, write the unit, as in '20 degC'",
    ),
    Usual(
        "gas.gas_constant", 20.0, 5000.0, "J/(kg*K)", "where gases lie",
        "the specific gas constant is wanted, 287.05 J/(kg*K) for air, not the molar one",
    ),
)  # fmt: skip
"""Ranges of single quantities."""

CLEARANCE_RATIO = Usual(
    "bearing.bushing_radius", 1e-4, 0.15, "1", "where the clearance ratio (R_B - R_j)/R_j of gas bearings lies",
    "check both radii: they are radii, not diameters",
)  # fmt: skip

SLENDERNESS = Usual(
    "bearing.length", 0.1, 10.0, "1", "where length over diameter of journal bearings lies",
    "check the units of length and radii",
)  # fmt: skip


def warnings_of(case: Case, scalars: Scalars) -> list[str]:
    """Return what is implausible about a case and its answer.

    Parameters
    ----------
    case : Case
        What was asked.
    scalars : mapping
        The answer's scalars by their names in a result, in SI units; what is absent, nan or a text where a number is
        expected is not judged. Empty for the case alone.

    Returns
    -------
    list of str
        One line each: key or quantity, what is implausible about it, why, and what to do.
    """
    return [*_of_inputs(case, scalars), *_of_answer(case, scalars)]


# ---------------------------------------------------------------------------------------------- inputs


def _of_inputs(case: Case, scalars: Scalars) -> Iterator[str]:
    yield from _unusual(case)
    yield from CLEARANCE_RATIO.warning(case.bearing.clearance / case.bearing.journal_radius)
    yield from SLENDERNESS.warning(0.5 * case.bearing.length / case.bearing.journal_radius)
    yield from _surface_speed(case, _number(scalars, "speed", case.operation.speed))
    if not list(_unusual(case)):  # a density that is wrong would be told twice
        yield from _turbulence(case, scalars)
    yield from _unbalance(case)
    if case.surface.petal_friction > 0.0 and case.petal_theory is PetalTheory.INEXTENSIBLE:
        yield (
            'surface.petal_friction: with petals.theory = "inextensible" it counts the turning of the faces only, '
            "about a sixtieth of the slip in the paper's bearing: the damping it gives is no prediction; in 2-D "
            'petals.theory = "shell" counts the whole slip'
        )
    if case.rotor is not None and case.rotor.inertia_is_estimated:
        whole = case.rotor.with_inertias(case.bearing.journal_radius)
        yield (
            f"rotor.transverse_inertia: not given; {whole.transverse_inertia:.4g} kg m^2 is taken, and "
            f"{whole.polar_inertia:.4g} kg m^2 about the axis, as of a cylinder of the journal's radius between the "
            "bearings: conical modes and their threshold speed depend on it"
        )
    yield from _measured_shape(case)
    yield from _metal(case)


def _unusual(case: Case) -> Iterator[str]:
    for usual in USUAL:
        section, _, name = usual.key.partition(".")
        table = getattr(case, section)
        if table is not None:
            given = getattr(table, name)
            warnings = (list(usual.warning(value)) for value in (given if isinstance(given, tuple) else (given,)))
            yield from next(filter(None, warnings), [])  # of unequal petals one is told


def _surface_speed(case: Case, speed: float) -> Iterator[str]:
    gas, surface = case.gas, speed * case.bearing.journal_radius
    mach = surface / math.sqrt(HEAT_CAPACITY_RATIO * gas.gas_constant * gas.temperature)
    if mach > MAX_MACH:
        yield (
            f"operation.speed: the journal's surface moves at {surface:.4g} m/s, Mach {mach:.2g}, above {MAX_MACH:g}, "
            "where inertia and compression heating of the gas matter, which are not modelled; if the speed was typed "
            f"in rpm, write the unit, as in '{speed:.6g} rpm'"
        )


def _unbalance(case: Case) -> Iterator[str]:
    if case.rotor is not None and case.rotor.unbalance > 0.5 * case.bearing.clearance:
        yield (
            f"rotor.unbalance: the mass centre lies {format_quantity(case.rotor.unbalance, 'm')} off the axis, more "
            f"than half the radial clearance {format_quantity(case.bearing.clearance, 'm')}; balanced rotors have some "
            "micrometres: divide a residual unbalance in g mm by the mass"
        )


def _metal(case: Case) -> Iterator[str]:
    for table in (case.petals, case.bump_foil, case.backing):
        metal = None if table is None else table.metal
        if table is None or metal is None:
            continue
        (low, high), temperature = metal.range, table.metal_temperature
        if not low <= temperature <= high:
            yield (
                f"{table.section}.metal_temperature: the modulus of {metal.name} is known from {low - 273.15:.0f} to "
                f"{high - 273.15:.0f} °C, not at {temperature - 273.15:.0f} °C: that of the nearer end is taken; give "
                f"{table.section}.youngs_modulus and {table.section}.poisson_ratio instead of a material"
            )


def _measured_shape(case: Case) -> Iterator[str]:
    petals = case.petals
    if petals is None or petals.free_shape is None:
        return
    rows = len(petals.free_shape)
    if rows < MIN_ROWS:
        yield (
            f"petals.free_shape: {rows} rows are too few to tell how good the shape between them is; "
            f"measure {MIN_ROWS} or more"
        )
        return
    error, tolerance = float(np.max(np.abs(row_errors(petals.free_shape)))), petals.free_shape_tolerance
    if error > case.surface.contact_film_thickness + SCATTER * tolerance:
        by = format_quantity(error, "m", digits=2)
        yield (
            f"petals.free_shape: its estimated error is up to {by}, by which a row misses the curve through its "
            "neighbours, and the film is as sensitive to it as to its own thickness; measure more rows, or state their "
            "scatter as petals.free_shape_tolerance"
        )


# ---------------------------------------------------------------------------------------------- answers


def _of_answer(case: Case, scalars: Scalars) -> Iterator[str]:
    yield from _stress(case, _number(scalars, "max_bending_stress"))
    yield from _rarefaction(case, _number(scalars, "knudsen_number"))
    yield from _contact(case, scalars)
    yield from _mixed_lubrication(case, scalars)
    yield from _pressed_bumps(case, scalars)
    if any(words in str(scalars.get("solution_path", "")) for words in BOTTOMED_OUT):
        yield (
            "solution_path: the foil pack has bottomed out, journal, petals and bushing touch as a solid stack, whose "
            "own stiffness is not modelled; reduce the load, or enlarge the pack's clearance"
        )
    at_nodes = "at nodes" in str(scalars.get("contact_slopes", ""))
    if at_nodes and case.petals is not None and case.backing is None and case.model.kind is ModelKind.TWO_D:
        yield (
            "contact_slopes: no equilibrium with contact points was found, stiffness and damping are those of contacts "
            "at nodes: known to several per cent where petals lie on each other along stretches; compare two grids "
            "(--error)"
        )


def _stress(case: Case, stress: float) -> Iterator[str]:
    given = None if case.petals is None else case.petals.yield_strength
    limit = MAX_STRESS if given is None else given
    if stress > limit:
        what = "above which no foil alloy stays elastic" if given is None else "the yield strength"
        yield (
            f"max_bending_stress: {format_quantity(stress, 'Pa')} exceeds {format_quantity(limit, 'Pa')}, {what}: the "
            "petals would yield, which is not modelled; use a larger petals.bend_radius or a smaller petals.thickness"
        )


def _rarefaction(case: Case, knudsen: float) -> Iterator[str]:
    if knudsen > MAX_KNUDSEN:
        slip = (
            "first-order slip"
            if case.model.slip
            else "without slip the film is too stiff: set model.slip = true, which"
        )
        yield (
            f"knudsen_number: the mean free path is {knudsen:.2g} of the minimum film thickness, over {MAX_KNUDSEN:g}, "
            f"where the gas is no continuum; {slip} holds up to there: take the film's force and damping as an estimate"
        )


def _contact(case: Case, scalars: Scalars) -> Iterator[str]:
    fraction, speed = _number(scalars, "contact_fraction"), _number(scalars, "speed", case.operation.speed)
    if fraction > MIN_CONTACT and 0.0 < case.operation.speed <= speed:
        yield (
            f"contact_fraction: at operating speed solid contact carries {100.0 * fraction:.2g} % of the force on the "
            "journal: it would heat up, and wear, which is not modelled; reduce the load, or raise the speed"
        )


def _mixed_lubrication(case: Case, scalars: Scalars) -> Iterator[str]:
    film, floor = _number(scalars, "min_film_thickness"), case.surface.contact_film_thickness
    speed = _number(scalars, "speed", case.operation.speed)
    free = not _number(scalars, "contact_fraction", 0.0) > MIN_CONTACT
    if free and film < MIXED * floor and 0.0 < case.operation.speed <= speed:
        yield (
            f"min_film_thickness: {format_quantity(film, 'm')} is under {MIXED:g} times "
            f"surface.contact_film_thickness, {format_quantity(floor, 'm')}: peaks of the surfaces touch now and then, "
            "which is not modelled; reduce the load, raise the speed, or take smoother surfaces"
        )


def _turbulence(case: Case, scalars: Scalars) -> Iterator[str]:
    radius, speed = case.bearing.journal_radius, _number(scalars, "speed", case.operation.speed)
    film = case.bearing.clearance if case.petals is None else _number(scalars, "min_film_thickness")
    reynolds = case.gas.ambient_density * speed * radius * film / case.gas.viscosity
    limit = TAYLOR * math.sqrt(radius / film) if film > 0.0 else math.inf
    if reynolds > limit:
        name = "radial clearance" if case.petals is None else "minimum film thickness"
        yield (
            f"operation.speed: the Reynolds number of a film of the {name}, {format_quantity(film, 'm')}, is "
            f"{reynolds:.3g}, above {limit:.3g}, where vortices form and the film becomes turbulent, which is not "
            "modelled: friction and stiffness would be larger; lower speed or ambient pressure, or a smaller clearance"
        )


def _pressed_bumps(case: Case, scalars: Scalars) -> Iterator[str]:
    for springs, name in ((case.bump_foil, "max_deflection"), (case.backing, "max_backing_deflection")):
        deflection = _number(scalars, name)
        if springs is not None and deflection > springs.travel:
            yield (
                f"{name}: the foil is pressed in by {format_quantity(deflection, 'm')}, more than the height of "
                f"its bumps, {format_quantity(springs.travel, 'm')}: they would lie on the bushing, which is not "
                "modelled; reduce the load, or take stiffer bumps"
            )


def warnings_of_errors(scalars: Scalars, errors: Mapping[str, float]) -> list[str]:
    """Return what the error bars of an answer tell against it.

    Parameters
    ----------
    scalars : mapping
        The answer's scalars by name, SI.
    errors : mapping
        Their error bars.
    """
    wide = {name: errors[name] / abs(_number(scalars, name)) for name in JUDGED if name in errors and scalars.get(name)}
    told = {name: share for name, share in wide.items() if share > WIDE}
    if not told:
        return []
    worst = max(told, key=lambda name: told[name])
    more = f" (and those of {', '.join(name for name in told if name != worst)})" if len(told) > 1 else ""
    return [
        f"{worst}: its error bar is {100.0 * told[worst]:.2g} % of it{more}, over {100.0 * WIDE:g} %: the grid is too "
        "coarse for it; raise model.cells_per_pitch and, in 3-D, model.axial_cells, or see `converge`"
    ]


def _number(scalars: Scalars, name: str, default: float = math.nan) -> float:
    """A scalar as a number; `default` where there is none."""
    value = scalars.get(name)
    return default if value is None or isinstance(value, str) or math.isnan(value) else float(value)
