"""What is implausible about an answer: one line each, with the reason and what to do."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from petalfoil.case import gas_properties
from petalfoil.case.definitions import Case
from petalfoil.case.sections import ContactDiscretization, ModelKind
from petalfoil.units.writing import format_percent, format_quantity

Scalars = Mapping[str, float | int | bool | str]

MAX_STRESS = 2e9
"""Yield strength of the strongest spring steels and nickel alloys in foils [Pa]."""

NODES_APART = 0.1
"""Difference of the force from that with contacts at nodes past which a finer grid is to tell that both belong to one
equilibrium: in most packs it is below 1 %, in stiff clamped ones some per cent."""

FEWEST_CELLS = 7.0
"""Cells along which neighbours overlap from which contacts near a root are points (`line_signs.freed_near_ends`). The
rig's damping at 1 um is 18 and 14 % too large on 16 cells per pitch (4), 20 and 12 % too small on 24 (6), 0 and 6 % too
large on 32 (8)."""

MAX_KNUDSEN = 0.1
"""Mean free path over film thickness above which first-order slip no longer holds (Burgdorfer 1959)."""

FILMS = {
    "knudsen_number": "the minimum film thickness",
    "contact_knudsen_number": "the contact film thickness",
    "clearance_knudsen_number": "the radial clearance",
}
"""Knudsen numbers of results, and the lengths that they are based on."""

MIN_CONTACT = 1e-3
"""Part of the normal forces on the journal that solid contact must make to be called contact."""

MIXED = 3.0
"""Minimum film thickness over contact film thickness below which peaks of the surfaces touch now and then: the film
parameter of mixed lubrication."""

NO_FORCE = 1e-6
"""Force, over ambient pressure times radius times length, below which a bearing carries nothing: its journal is
centred, and the force is what the solution leaves."""

NEUTRAL = "neutral"
"""Word of a verdict on the rotor that neither calls it stable nor unstable."""

NEUTRAL_DAMPING = 1e-4
"""Damping ratio within which a mode is called neutral. Solid metal alone damps by as much (loss factors of steel are
1e-4 to 6e-4, twice the damping ratio), and a light rotor on stiff petals is damped by less from the film than grids
tell: whatever else damps decides."""

WIDE = 0.1
"""Error bar over the result above which the result is known to its order of magnitude only."""

JUDGED = (
    *("bearing_force", "min_film_thickness", "peak_pressure", "friction_torque", "max_bending_stress"),
    *("critical_mass", "threshold_speed", "liftoff_speed", "starting_torque"),
)
"""Results whose error bars are judged: others may vanish, as a force across the load does."""


def of_answer(case: Case, scalars: Scalars) -> Iterator[str]:
    """Yield what is implausible about an answer, by its scalars; nothing without any."""
    yield from _stress(case, number(scalars, "max_bending_stress"))
    yield from _real_gas(case, scalars)
    yield from _warm_parts(case, scalars)
    yield from _contact(case, scalars)
    yield from _mixed_lubrication(case, scalars)
    yield from _pressed_bumps(case, scalars)
    yield from neutral(scalars)
    if scalars.get("bottomed_out", False):
        yield (
            "bottomed_out: the foil pack has bottomed out, journal, petals and bushing touch as a solid stack, whose "
            "own stiffness is not modelled; reduce the load, or enlarge the pack's clearance"
        )
    at_nodes = "at nodes" in str(scalars.get("contact_model", "")) and "point_share" not in scalars
    if at_nodes and case.has_contact_points and case.heat is None:
        yield (
            "contact_model: no equilibrium with contact points was found, results are those of contacts at nodes: in "
            "such stiff packs forces change by several per cent from grid to grid, stiffness and damping by more; "
            "compare two grids (--error)"
        )
    yield from _dragged_at_nodes(case, scalars)
    yield from _path_at_nodes(case, scalars)
    if number(scalars, "friction_harmonics") == 1.0:
        yield (
            "friction_harmonics: slips of petals that rub were taken for sines, as they are with many contacts "
            "and in modes that are lost with more harmonics: where contacts stick and slip in turn "
            "damping is off by up to a third; compare `coefficients --amplitude` on a coarser grid"
        )
    yield from _short_lines(case, scalars)
    apart = number(scalars, "nodal_force_difference")
    if apart > NODES_APART:
        yield (
            f"nodal_force_difference: the force is {format_percent(apart)} from that with contacts at nodes of the "
            "same grid, which in stiff packs miss it; that the equilibrium is the same one is known to so much only: "
            "refine model.cells_per_pitch until it falls"
        )


def _dragged_at_nodes(case: Case, scalars: Scalars) -> Iterator[str]:
    """Contacts of a journal that drags petals along, in 3-D."""
    between = case.model.kind is ModelKind.THREE_D and case.model.contacts is ContactDiscretization.POINTS
    touches = number(scalars, "contact_normal_force") != 0.0
    if between and case.drags_petals and touches and "at nodes" in str(scalars.get("contact_model", "")):
        yield (
            "contact_model: contacts are at nodes, for a journal that drags petals along (surface.journal_rubbing) "
            "pushes them in other directions than those in which gaps close, and contact lines between nodes take "
            "reactions along the gaps alone; from grid to grid forces change by several per cent, stiffness and "
            'damping by more: compare two grids (--error), or take "torque"'
        )


def _path_at_nodes(case: Case, scalars: Scalars) -> Iterator[str]:
    """Contacts of petals that keep the friction forces of their path, in 3-D."""
    path = str(scalars.get("friction_path", "")).startswith("assembled")
    between = case.has_contact_lines and case.follows_friction and case.heat is None
    if path and between and "at nodes" in str(scalars.get("contact_model", "")):
        yield (
            "contact_model: contacts are at nodes, as contact lines between nodes were lost on the path, or as motions "
            "with friction have none in 3-D; the rig's starting moment differs by 18 per cent between 16 x 6 and "
            "32 x 12 cells so, stiffness and damping by more: compare two grids (--error), or the same path in 2-D, "
            "which has contact points"
        )


def _short_lines(case: Case, scalars: Scalars) -> Iterator[str]:
    """Yield where contacts of petals that rub, 3-D, are nodes for want of cells along which neighbours overlap."""
    pack = case.pack
    if "friction_harmonics" not in scalars or case.model.kind is not ModelKind.THREE_D or pack is None:
        return
    cells = (pack.overlap - 1.0) * case.cells_per_pitch
    if cells < FEWEST_CELLS:
        needed = math.ceil(FEWEST_CELLS / (pack.overlap - 1.0))
        yield (
            f"model.cells_per_pitch: {case.cells_per_pitch} leave {cells:.2g} cells where neighbouring petals overlap, "
            "too few for contacts near a root to lie between nodes: damping of petals that rub may be off by a fifth "
            f"at small amplitudes; give at least {needed}"
        )


def neutral(scalars: Scalars) -> Iterator[str]:
    """Yield what is to be said of a rotor whose modes neither grow nor decay by more than the results tell."""
    if NEUTRAL in str(scalars.get("verdict", "")):
        yield (
            "verdict: film and contacts neither damp a mode of the rotor nor drive it by more than these results can "
            "tell: any structural damping, of shaft, petals and mount, which is not modelled, decides whether it is "
            "stable; add damping, or refine the grid until the growth rate stands clear of its error (--error)"
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


def _real_gas(case: Case, scalars: Scalars) -> Iterator[str]:
    peak, name = number(scalars, "peak_pressure"), case.gas.name
    if name is None or not peak > case.gas.ambient_pressure:
        return
    temperature = number(scalars, "film_temperature", case.gas.temperature)
    if gas_properties.within_temperatures(name, temperature):
        if found := gas_properties.unlike_ideal(name, temperature, peak):
            yield (
                f"peak_pressure: {found}: at the peak of the film the density is not that of the ideal-gas law, which "
                "is modelled alone; lower the load or gas.ambient_pressure, or take a warmer gas"
            )


def _warm_parts(case: Case, scalars: Scalars) -> Iterator[str]:
    film, name = number(scalars, "film_temperature"), case.gas.name
    if name is not None and not math.isnan(film) and not gas_properties.within_temperatures(name, film):
        yield (
            f"film_temperature: {format_quantity(film, 'K', digits=5)} is outside the range in which CoolProp knows "
            f"{name}: its viscosity there is extrapolated; cool the bearing, or give the gas by numbers"
        )
    metal, pack = None if case.petals is None else case.petals.metal, number(scalars, "pack_temperature")
    if metal is not None and not math.isnan(pack) and not metal.range[0] <= pack <= metal.range[1]:
        low, high = (end - 273.15 for end in metal.range)
        yield (
            f"pack_temperature: at {pack - 273.15:.0f} °C the modulus of {metal.name} is not known, only from "
            f"{low:.0f} to {high:.0f} °C, and that of petals.metal_temperature is used; cool the bearing, or give the "
            "modulus as a number"
        )


def rarefaction(case: Case, scalars: Scalars) -> Iterator[str]:
    """Yield what is to be said of a film that is no continuum."""
    for name, length in FILMS.items():
        if (knudsen := number(scalars, name)) > MAX_KNUDSEN:
            slip = "" if case.model.slip else "set model.slip = true, without which the film is too stiff; "
            yield (
                f"{name}: the mean free path of the gas is {knudsen:.2g} times {length}, more than {MAX_KNUDSEN:g}, up "
                f"to which slip at the walls describes the film; {slip}take force and damping as estimates"
            )


def _contact(case: Case, scalars: Scalars) -> Iterator[str]:
    fraction, speed = number(scalars, "contact_fraction"), number(scalars, "speed", case.operation.speed)
    if fraction > MIN_CONTACT and 0.0 < case.operation.speed <= speed:
        yield (
            f"contact_fraction: at operating speed solid contact makes {format_percent(fraction)} of the normal forces "
            "that press on the journal (all around it: they may be larger than the load, and cancel): it would heat "
            "up, and wear, which is not modelled; reduce the load, or raise the speed"
        )


def _mixed_lubrication(case: Case, scalars: Scalars) -> Iterator[str]:
    film, floor = number(scalars, "min_film_thickness"), case.surface.contact_film_thickness
    speed = number(scalars, "speed", case.operation.speed)
    free = not number(scalars, "contact_fraction", 0.0) > MIN_CONTACT
    if free and film < MIXED * floor and 0.0 < case.operation.speed <= speed:
        yield (
            f"min_film_thickness: {format_quantity(film, 'm')} is under {MIXED:g} times "
            f"surface.contact_film_thickness, {format_quantity(floor, 'm')}: peaks of the surfaces touch now and then, "
            "which is not modelled; reduce the load, raise the speed, or take smoother surfaces"
        )


def _pressed_bumps(case: Case, scalars: Scalars) -> Iterator[str]:
    for springs, name in ((case.bump_foil, "max_deflection"), (case.backing, "max_backing_deflection")):
        deflection = number(scalars, name)
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
    wide = {name: errors[name] / abs(number(scalars, name)) for name in JUDGED if name in errors and scalars.get(name)}
    least = NO_FORCE * math.prod(
        number(scalars, name, 0.0) for name in ("ambient_pressure", "journal_radius", "length")
    )
    if errors.get("bearing_force", math.inf) < least:  # a centred journal
        wide.pop("bearing_force", None)
    told = {name: share for name, share in wide.items() if share > WIDE}
    if not told:
        return []
    worst = max(told, key=lambda name: told[name])
    more = f" (and those of {', '.join(name for name in told if name != worst)})" if len(told) > 1 else ""
    return [
        f"{worst}: its error bar is {format_percent(told[worst])} of it{more}, over {format_percent(WIDE)}: the grid "
        "is too coarse for it; raise model.cells_per_pitch and, in 3-D, model.axial_cells, or see `converge`"
    ]


def number(scalars: Scalars, name: str, default: float = math.nan) -> float:
    """A scalar as a number; `default` where there is none."""
    value = scalars.get(name)
    return default if value is None or isinstance(value, str) or math.isnan(value) else float(value)
