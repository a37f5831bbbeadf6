"""`stability`: a rigid rotor on the bearing: critical mass, threshold speed, damped natural frequencies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from petalfoil.analysis.arguments import Load, Loads, Mass, Speed, Speeds
from petalfoil.analysis.campbell import BRANCHES, CRITICAL, Branches
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.coefficients import (
    Amplitude,
    Amplitudes,
    Harmonics,
    check_harmonics,
    check_rubbing,
    state_parts,
)
from petalfoil.analysis.contact_model import ContactModel
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.operating_point import OperatingPoint, Vector, applied_load, at, operating_point
from petalfoil.analysis.records import branch, effort, failed_record, record_of
from petalfoil.analysis.rotor_on_bearings import RotorOnBearings, whole_length
from petalfoil.analysis.rotor_verdict import MassMargin, RotorVerdict, stability_of
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.analysis.speeds import SpeedLine
from petalfoil.analysis.threshold import AtOwnSpeed, rotor_mass, threshold_speed, told_with_mach
from petalfoil.case import NEUTRAL, Case
from petalfoil.dynamics.critical_mass import EVEN_FILM, Whirl
from petalfoil.dynamics.film_stability import leading_eigenvalue
from petalfoil.dynamics.natural_modes import Mode
from petalfoil.dynamics.reduced_impedance import Impedance
from petalfoil.dynamics.rubbing_cycle import ONE_HARMONIC, HarmonicsTold
from petalfoil.dynamics.rubbing_modes import RubbingMode, RubbingNeutral
from petalfoil.equilibrium.run_context import Progress, running
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.grid import LoadSpeedGrid
from petalfoil.results.layout import ArrayTable, Cell, Series, SinglePoint, at_speed
from petalfoil.results.parts import AppliedLoad, RunOutcome
from petalfoil.results.record import Array, Record
from petalfoil.results.summary import ABSENT, cell, number
from petalfoil.results.variable import Variable

MODES = ("natural_frequency", "mode_growth_rate", "damping_ratio", "participation", "whirl_direction")
"""What is told of each natural mode."""
TILT = "mode_tilt"
"""The same of a rotor that tilts."""
HARMONICS = "mode_friction_harmonics"
"""The same at an amplitude."""
MODE_BARS = ("natural_frequency_error", "mode_growth_rate_error", "damping_ratio_error")
"""Their error bars."""
MODE_CHANGES = (
    "natural_frequency_harmonics_change",
    "mode_growth_rate_harmonics_change",
    "damping_ratio_harmonics_change",
)
"""What half as many harmonics of slips change of them, at an amplitude."""


def barred(name: str, record: Record, mode: int, shown_as: str = "") -> Cell:
    """A number of a natural mode, and its error bar where it has one; `shown_as` gives a scalar with its unit."""
    bars = record.fields.get(f"{name}_error")
    found = [float(values[mode]) for values in (record.fields[name], bars) if values is not None]
    shown = [cell(shown_as, value).value if shown_as else number(value) for value in found]
    return found[0] if bars is None and not shown_as else " ± ".join(shown)


def between_ends(name: str, record: Record, mode: int) -> Cell:
    """Where a natural mode is on a scale of 0 to 1, to three decimals; absent where the scale is."""
    return round(float(record.fields[name][mode]), 3) + 0.0 if name in record.fields else ABSENT


AT_AMPLITUDE = "no threshold speed at an amplitude"
"""What is told of the threshold speed of a rotor whose petals rub."""


MODE_TABLE = ArrayTable(
    dim="mode",
    columns={
        "natural\nrpm": lambda record, k: barred("natural_frequency", record, k, "speed"),
        "Hz": lambda record, k: float(record.fields["natural_frequency"][k]) / (2.0 * math.pi),
        "growth\n1/s": lambda record, k: barred("mode_growth_rate", record, k),
        "damping\nratio": lambda record, k: barred("damping_ratio", record, k),
        "participation\nof the rotor": lambda record, k: float(record.fields["participation"][k]),
        "forward (+1) or\nbackward (-1)": lambda record, k: between_ends("whirl_direction", record, k),
        "cylindrical (0)\nor conical (1)": lambda record, k: between_ends(TILT, record, k),
        "harmonics\nof slips": lambda record, k: (
            str(int(record.fields[HARMONICS][k])) if HARMONICS in record.fields else ABSENT
        ),
    },
)
CAMPBELL_TABLE = ArrayTable(
    dim="mode",
    columns={
        "speed\nrpm": lambda record, _: cell("speed", record.scalars["speed"]).value,
        "rotor": lambda record, _: stability_of(record),
        "branch": lambda record, k: str(int(record.coords["mode"][k])),
        **MODE_TABLE.columns,
        "critical speed\nrpm": lambda record, k: (
            ABSENT
            if math.isnan(float(record.fields[CRITICAL][k]))
            else cell("speed", float(record.fields[CRITICAL][k])).value
        ),
    },
    there=lambda record, k: math.isfinite(float(record.fields["natural_frequency"][k])),
    keys=3,
)


@dataclass(frozen=True, kw_only=True)
class Campbell(Series):
    """Natural modes over speed: without error bars, for modes of different grids need not belong to each other."""

    takes_error_bars: ClassVar[bool] = False


GRID = LoadSpeedGrid(
    names=(
        *("verdict", "critical_mass", "whirl_ratio", "mass_margin"),
        *("contact_fraction", "eccentricity_x", "eccentricity_y", "status"),
    ),
    tables={
        "critical_mass": "critical mass [kg] over load and speed",
        "whirl_ratio": "whirl ratio over load and speed",
        "mass_margin": "critical mass over the rotor's mass, over load and speed: unstable where below 1",
    },
)


@dataclass(frozen=True)
class CriticalMass:
    """Mass of a rigid rotor above which it whirls, and its whirl frequency over the speed."""

    critical_mass: float
    whirl_ratio: float


@dataclass(frozen=True)
class WhirlChanges:
    """By how much critical mass and its whirl ratio differ from those with half as many harmonics of the slips."""

    critical_mass_harmonics_change: float
    whirl_ratio_harmonics_change: float

    @classmethod
    def of(cls, whirl: Whirl) -> WhirlChanges:
        """Of a neutral whirl; not known (nan) with one harmonic, or where none is found."""
        if isinstance(whirl, RubbingNeutral):
            return cls(whirl.mass_change, whirl.ratio_change)
        return cls(math.nan, math.nan)


@dataclass(frozen=True)
class Wanted:
    """What the rotor is, and how it whirls: mass [kg], amplitude [m], fewest harmonics of the slips; each if given."""

    mass: float | None
    amplitude: float | None
    harmonics: int | None


@dataclass(frozen=True)
class RotorMass:
    """The rotor."""

    rotor_mass: float


@dataclass(frozen=True)
class RotorThreshold:
    """The rotor, and the speed at which it becomes unstable."""

    rotor_mass: float
    threshold_speed: float


@analysis(
    SinglePoint(lists=MODES, histories=(TILT, HARMONICS, *MODE_CHANGES, *MODE_BARS), array_tables=(MODE_TABLE,)),
    GRID,
    Campbell(lists=(*MODES, CRITICAL), histories=(TILT,), array_tables=(CAMPBELL_TABLE,), at=at_speed),
    excludes={
        "speed": ("speeds",),
        "load": ("loads",),
        "mass": ("loads",),
        "amplitude": ("speeds", "loads"),
        "harmonics": ("speeds", "loads"),
    },
    results={CRITICAL: Variable(("mode",), "rad s-1", "speed at which the natural frequency is the speed", "omega_c")},
    error_bars=True,
)
def stability(  # noqa: PLR0913 - the options of the verb
    case: Case,
    *,
    load: Load = None,
    mass: Mass = None,
    speed: Speed = None,
    speeds: Speeds = None,
    loads: Loads = None,
    amplitude: Amplitude = None,
    harmonics: Harmonics = None,
    progress: Progress | None = None,
) -> Record | Points:
    """Find critical mass, threshold speed and damped natural frequencies of a rigid rotor.

    At the case's eccentricity, or under a load where one is given; with
    --speeds or --loads as a table over load and speed. Petals with friction
    stick, as in the smallest motions; with an --amplitude they rub: modes
    pass that amplitude, and a rotor of the critical mass whirls on with it.
    Where the row "contacts" says "at nodes" and petals lie on each other
    along a stretch, frequencies are accurate to several per cent, a small
    damping to 50 %. A case without rotor.span is one bearing, and masses are
    what it carries; with it load and masses are those of the whole rotor in
    two bearings, which may tilt. The participation of the rotor is near 1
    where the rotor moves as on springs, and small where gas and petals do.
    With --speeds and --mass as a Campbell diagram: natural modes over speed.

    Example: petalfoil stability case.toml --load "20 N" --mass "2 kg"

    Raises
    ------
    UsageError
        The shaft does not turn, there is no load where a table needs one, nothing rubs at an amplitude, or harmonics
        are given without one.
    ConvergenceError
        The operating point was not found, or the pack is bottomed out.
    """
    newton_only(case)
    check_harmonics(amplitude, harmonics)
    if speeds is None and loads is None:
        if amplitude is not None:
            check_rubbing(case)
        return point(turning(at(case, speed)), load, Wanted(mass, amplitude, harmonics), progress)
    if speeds is not None and mass is not None:
        over = [turning(at(case, omega)) for omega in speeds]
        return Points(partial(_campbell, over, load, mass, progress), len(over), layout=Campbell)
    wanted = [applied_load(case, load)] if loads is None else [(0.0, -size) for size in loads]
    turn = [case.operation.speed if speed is None else speed] if speeds is None else speeds
    cases = [turning(at(case, omega, (0.0, 0.0))) for omega in turn]
    return Points(partial(_points, cases, wanted, progress), len(cases) * len(wanted))


def turning(case: Case) -> Case:
    """The case, if its shaft turns."""
    if not case.operation.speed > 0.0:
        raise UsageError("stability needs a turning shaft: give a speed above zero")
    return case


def point(case: Case, load: Vector | None, wanted: Wanted, progress: Progress | None) -> Record:
    """Critical mass at the operating point, the speed at which the rotor becomes unstable, and its modes.

    Without a mass that of the case's rotor is taken, without one the load over gravity; without a load there are no
    threshold speed (nan) and no modes.
    """
    with running(progress, "stability") as run:
        speed, amplitude = case.operation.speed, wanted.amplitude
        mass = rotor_mass(case, load, wanted.mass)
        rotor = RotorOnBearings(whole_length(case), mass, amplitude, wanted.harmonics or 0)
        found = operating_point(rotor.case, load)
        impedance = rotor.impedance(found.answer)
        whirl = rotor.whirl(impedance, speed)
        modes = None if math.isnan(rotor.mass) else rotor.modes(impedance, speed)
        if amplitude is None:
            start = AtOwnSpeed(found.answer, impedance, whirl)
            growing = any(mode.s.real > 0.0 for mode in modes or ())
            threshold, ended = threshold_speed(rotor, load, start, grows=growing)
        else:
            threshold, ended = math.nan, AT_AMPLITUDE
        ended = told_with_mach(case, threshold, ended)
        parts = (
            *(() if amplitude is not None else (RotorVerdict.of(case, whirl, rotor.mass, modes),)),
            RotorThreshold(rotor.mass, threshold),
            *(() if amplitude is None else at_amplitude(amplitude, whirl, modes)),
            *whirl_parts(case, found, whirl, ended, modes),
            ContactModel.of_motion(impedance.motion),
            effort(run.seconds),
        )
        fields, coords = ({}, {}) if modes is None else mode_fields(modes, speed, tilts=case.bearings > 1)
        return record_of("stability", case, *parts, fields=fields, coords=coords)


def whirl_parts(
    case: Case, found: OperatingPoint, whirl: Whirl, ended: str, modes: Sequence[Mode] | None = None
) -> tuple[object, ...]:
    """The state and its critical mass; what has no number is told by the status.

    Where no mass is critical, stability is the same for all: the rotor's own modes tell which.
    """
    even = whirl.ratio == EVEN_FILM.ratio
    half = "whirls at half the speed at any speed and rotor mass"
    any_mass = {0.0: half if even else "unstable for any rotor mass", math.inf: "stable for any rotor mass"}
    if any_grows(modes):
        any_mass[math.inf] = "a mode grows, though no mass is critical"
    elif any(mode.is_neutral for mode in modes or ()):
        any_mass[math.inf] = f"no rotor mass is critical; a mode is {NEUTRAL}"
    if ended == AT_AMPLITUDE:
        any_mass[math.inf] = "no whirl was found that goes on at the amplitude"
    remarks = ["converged", any_mass.get(whirl.mass, ""), ended]
    outcome = RunOutcome(status="; ".join(filter(None, remarks)), residual=found.answer.reported_residual)
    return *state_parts(case, found), CriticalMass(whirl.mass, whirl.ratio), outcome


def at_amplitude(amplitude: float, whirl: Whirl, modes: Sequence[Mode] | None) -> tuple[object, ...]:
    """What is told of petals that rub."""
    return Amplitudes(amplitude), harmonics_told(whirl, modes), WhirlChanges.of(whirl)


def harmonics_told(whirl: Whirl, modes: Sequence[Mode] | None) -> HarmonicsTold:
    """Harmonics of the slips in the critical whirl and the modes: the fewest."""
    told = [one.told for one in (whirl, *(modes or ())) if isinstance(one, RubbingNeutral | RubbingMode)]
    return HarmonicsTold.fewest_of(told or [ONE_HARMONIC])


def any_grows(modes: Sequence[Mode] | None) -> bool:
    """Whether one of the natural modes, as far as there are any, grows, and is not neutral."""
    return any(mode.grows for mode in modes or ())


def mode_fields(modes: list[Mode], speed: float, *, tilts: bool) -> tuple[dict[str, Array], dict[str, Array]]:
    """Fields and coordinates that tell the modes."""
    values = {
        "natural_frequency": [mode.s.imag * speed for mode in modes],
        "mode_growth_rate": [mode.s.real * speed for mode in modes],
        "damping_ratio": [mode.damping_ratio for mode in modes],
        "participation": [mode.participation for mode in modes],
        "whirl_direction": [mode.direction for mode in modes],
    }
    if tilts:
        values[TILT] = [mode.tilt for mode in modes]
    rubbing = [mode for mode in modes if isinstance(mode, RubbingMode)]
    if rubbing:
        changes = zip(*(mode.changes(speed) for mode in rubbing), strict=True)
        values[HARMONICS] = [float(mode.told.friction_harmonics) for mode in rubbing]
        values |= {name: list(each) for name, each in zip(MODE_CHANGES, changes, strict=True)}
    fields: dict[str, Array] = {name: np.array(each, dtype=float) for name, each in values.items()}
    return fields, {"mode": np.arange(1, len(modes) + 1)}


def _points(
    cases: list[Case], loads: list[Vector], progress: Progress | None, done: Sequence[Record] = ()
) -> Iterator[Record]:
    """Critical masses load by load, speeds in order, each balance followed from the one before."""
    rotor = RotorOnBearings(whole_length(cases[0]), rotor_mass(cases[0], None, None))
    rows, columns = divmod(len(done), len(cases))  # whole rows that are done, and points of the next one
    for row, load in enumerate(loads[rows:], rows):
        line, first = SpeedLine(rotor.case, load), columns if row == rows else 0
        if first:
            line.regain([case.operation.speed for case in cases[:first]], done[-1])
        for column, case in enumerate(cases[first:], first):
            here = part(progress, row * len(cases) + column, len(loads) * len(cases))
            with running(here, "stability") as run:
                try:
                    found, whirl, impedance = _followed(line, case, rotor)
                    contacts = ContactModel.of_motion(impedance.motion)
                    own = replace(rotor, mass=rotor_mass(case, load, None))
                    modes = own.deciding_modes(whirl, impedance, case.operation.speed)
                    judged = (rotor if modes is None else own).mass
                    told = RotorVerdict.of(case, whirl, judged, modes), MassMargin.of(whirl, rotor.mass)
                    parts = (*told, *whirl_parts(case, found, whirl, "", modes), contacts, effort(run.seconds))
                    record = record_of("stability", case, *parts)
                except ConvergenceError as failure:
                    line.known = None
                    record = failed_record("stability", case, failure, AppliedLoad.of(load))
            yield record


def _campbell(
    cases: list[Case], load: Vector | None, mass: float, progress: Progress | None, done: Sequence[Record] = ()
) -> Iterator[Record]:
    """Natural modes of a rotor of `mass` [kg] speed by speed, each on the branch of the one before."""
    rotor, branches = RotorOnBearings(whole_length(cases[0]), mass), Branches()
    loaded = load is not None or cases[0].operation.load is not None
    wanted = applied_load(cases[0], load) if loaded else None
    line = None if wanted is None else SpeedLine(rotor.case, wanted)
    if done:
        branches.regain(next((record for record in reversed(done) if record.converged), done[-1]))
        if line is not None:
            line.regain([case.operation.speed for case in cases[: len(done)]], done[-1])
    for place, case in enumerate(cases[len(done) :], len(done)):
        speed = case.operation.speed
        with running(part(progress, place, len(cases)), "stability") as run:
            try:
                if line is None:
                    found = operating_point(at(rotor.case, speed), None)
                    impedance = rotor.impedance(found.answer)
                    whirl = rotor.whirl(impedance, speed)
                else:
                    found, whirl, impedance = _followed(line, case, rotor)
                modes = rotor.modes(impedance, speed)
                fields, _ = mode_fields(modes, speed, tilts=case.bearings > 1)
                contacts = ContactModel.of_motion(impedance.motion)
                told = RotorMass(mass), RotorVerdict.of(case, whirl, mass, modes)
                parts = (*told, *whirl_parts(case, found, whirl, "", modes), contacts, effort(run.seconds))
                coords: dict[str, Array] = {"mode": np.arange(1, BRANCHES + 1)}
                placed = branches.placed(fields, speed)
                record = record_of("stability", case, *parts, fields=dict(placed), coords=coords)
            except ConvergenceError as failure:
                if line is not None:
                    line.known = None
                record = failed_record("stability", case, failure)
        yield record


def _followed(line: SpeedLine, case: Case, rotor: RotorOnBearings) -> tuple[OperatingPoint, Whirl, Impedance]:
    """The balance at the case's speed, its critical mass, and the impedance about it."""
    answer = line.at(case.operation.speed)
    impedance = rotor.impedance(answer)
    whirl = rotor.whirl(impedance, case.operation.speed)
    known = branch(leading_eigenvalue(answer), case, None, answer.solution_path)
    return OperatingPoint(answer, known, (AppliedLoad.of(line.load),)), whirl, impedance
