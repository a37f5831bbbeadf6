"""What is hardly ever meant, or lies outside what the model holds for: one line each, with the reason and what to do.

A case that is possible is never refused for being unlikely; it is answered, with warnings beside the answer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from petalfoil.case.definitions import Case
from petalfoil.case.implausible_answers import Scalars, number, of_answer, rarefaction
from petalfoil.case.measured_shape import row_errors
from petalfoil.case.petal_table import PetalTheory
from petalfoil.case.sections import ModelKind
from petalfoil.units.writing import format_quantity

MAX_MACH = 0.7
"""Mach number of the journal's surface above which the gas heats by tens of kelvins and its inertia matters."""

LOWEST_SPEED, HIGHEST_SPEED = 2.0 * math.pi / 60.0 * 100.0, 2.0 * math.pi / 60.0 * 1e6
"""Speeds between which gas bearings run, 100 and a million rpm [rad/s]; slower ones are passed in a run-up."""

HEAT_CAPACITY_RATIO = 1.4
"""Of air and other gases of two atoms; 1.67 of noble gases makes the Mach number 9 % smaller."""

MIN_ROWS = 6
"""Rows of a measured free shape from which its error can be estimated."""

SCATTER = 6.0
"""Standard deviations by which the worst of some hundred rows misses its neighbours: they scatter as it does."""

TAYLOR = 41.2
"""Reynolds number of the film over the root of radius over film, from which on vortices form (Taylor 1923)."""


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
        if self.low <= value <= self.high or value == 0.0:  # zero is meant: a shaft at rest, no contraction
            return
        given, low, high = (format_quantity(number, self.unit) for number in (value, self.low, self.high))
        yield f"{self.key}: {given} is outside {low} to {high}, {self.why}; {self.ask}"


USUAL = (
    Usual(
        "petals.youngs_modulus", 1e9, 1e12, "Pa", "where metals and polymers lie",
        "check the unit: steel has '200 GPa', and a bare number is in Pa",
    ),
    Usual(
        "petals.poisson_ratio", 0.1, 0.48, "1", "where metals and polymers lie",
        "metals have 0.27 to 0.36",
    ),
    Usual(
        "operation.speed", LOWEST_SPEED, HIGHEST_SPEED, "rad/s", "where gas bearings run",
        "check the unit: a bare number is in rad/s, and '60.000 rpm' is sixty revolutions per minute",
    ),
    Usual(
        "gas.viscosity", 5e-6, 1e-4, "Pa*s", "where gases lie",
        "check the unit: air has '18.5 uPa*s', and a bare number is in Pa*s; liquids are not modelled",
    ),
    Usual(
        "gas.ambient_pressure", 1e3, 1e7, "Pa", "where gas bearings run",
        "check the unit: the atmosphere has '1 bar', and a bare number is in Pa; it is the absolute pressure",
    ),
    Usual(
        "gas.temperature", 100.0, 1500.0, "K", "where gas bearings run",
        "check the unit: air in a laboratory has '20 degC', and a bare number is in K",
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
    return [*_of_inputs(case, scalars), *of_answer(case, scalars)]


# ---------------------------------------------------------------------------------------------- inputs


def _of_inputs(case: Case, scalars: Scalars) -> Iterator[str]:
    yield from _unusual(case)
    yield from CLEARANCE_RATIO.warning(case.bearing.clearance / case.bearing.journal_radius)
    yield from SLENDERNESS.warning(0.5 * case.bearing.length / case.bearing.journal_radius)
    yield from _surface_speed(case, number(scalars, "speed", case.operation.speed))
    if not list(_unusual(case)):  # a density or a mean free path that is wrong would be told twice
        yield from _turbulence(case, scalars)
        yield from rarefaction(case, scalars)
    yield from _unbalance(case)
    yield from _petal_theory(case)
    if case.rotor is not None and case.rotor.inertia_is_estimated:
        whole = case.rotor.with_inertias(case.bearing.journal_radius)
        yield (
            f"rotor.transverse_inertia: not given; {whole.transverse_inertia:.4g} kg m^2 is taken, and "
            f"{whole.polar_inertia:.4g} kg m^2 about the axis, as of a cylinder of the journal's radius between the "
            "bearings: conical modes and their threshold speed depend on it"
        )
    yield from _measured_shape(case)
    yield from _metal(case)


def _petal_theory(case: Case) -> Iterator[str]:
    rubs, is_3d = case.surface.petal_friction > 0.0, case.model.kind is ModelKind.THREE_D
    if rubs and case.petal_theory is PetalTheory.INEXTENSIBLE:
        yield (
            'surface.petal_friction: with petals.theory = "inextensible" it counts the turning of the faces only, '
            "about a sixtieth of the slip in the paper's bearing: the damping it gives is no prediction; "
            'petals.theory = "shell" counts the whole slip along the petals'
        )
    if is_3d and case.backing is not None and case.petals is not None and case.petals.theory is None:
        yield (
            "backing: petals of a 3-D model on backing springs bend without stretching, which makes the minimum film "
            "of the paper's bearings 20 to 40 % too thin; without [backing] they stretch; petals.theory = "
            '"inextensible" says that this is meant'
        )


def _unusual(case: Case) -> Iterator[str]:
    for usual in USUAL:
        section, _, name = usual.key.partition(".")
        table = getattr(case, section)
        if table is not None:
            given = getattr(table, name)
            warnings = (list(usual.warning(value)) for value in (given if isinstance(given, tuple) else (given,)))
            yield from next(filter(None, warnings), [])  # of unequal petals one is told


def surface_mach(case: Case, speed: float) -> float:
    """Mach number of the journal's surface at a speed [rad/s]."""
    gas = case.gas
    sound = math.sqrt(HEAT_CAPACITY_RATIO * gas.gas_constant * gas.temperature)
    return speed * case.bearing.journal_radius / sound


def _surface_speed(case: Case, speed: float) -> Iterator[str]:
    surface, mach = speed * case.bearing.journal_radius, surface_mach(case, speed)
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
        elif case.heat is None and not low <= case.gas.temperature <= high:
            yield (
                f"{table.section}.metal_temperature: the gas is at {case.gas.temperature - 273.15:.0f} °C, where the "
                f"modulus of {metal.name} is not known ({metal.known_at}), and that at {temperature - 273.15:.0f} °C "
                f"is taken; give {table.section}.youngs_modulus and {table.section}.poisson_ratio instead of a material"
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


def _turbulence(case: Case, scalars: Scalars) -> Iterator[str]:
    radius, speed = case.bearing.journal_radius, number(scalars, "speed", case.operation.speed)
    film = case.bearing.clearance if case.petals is None else number(scalars, "min_film_thickness")
    reynolds = case.gas.ambient_density * speed * radius * film / case.gas.viscosity
    limit = TAYLOR * math.sqrt(radius / film) if film > 0.0 else math.inf
    if reynolds > limit:
        name = "radial clearance" if case.petals is None else "minimum film thickness"
        yield (
            f"operation.speed: the Reynolds number of a film of the {name}, {format_quantity(film, 'm')}, is "
            f"{reynolds:.3g}, above {limit:.3g}, where vortices form and the film becomes turbulent, which is not "
            "modelled: friction and stiffness would be larger; lower speed or ambient pressure, or a smaller clearance"
        )
