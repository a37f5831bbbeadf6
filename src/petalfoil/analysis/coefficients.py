"""`coefficients`: stiffness and damping over whirl frequency and speed at operating points (model, question 6)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from petalfoil.analysis.arguments import Flag, Load, NumbersWithUnit, NumberWithUnit, Speed, Speeds, Whole
from petalfoil.analysis.classic_method import newton_only
from petalfoil.analysis.coefficient_tables import TABLES
from petalfoil.analysis.contact_model import ContactModel
from petalfoil.analysis.declaration import analysis
from petalfoil.analysis.evaluation import Evaluation
from petalfoil.analysis.friction_told import FrictionTold
from petalfoil.analysis.heat_results import heat_results
from petalfoil.analysis.impedance import Array, cycle_impedance, elastic_and_sliding, impedances
from petalfoil.analysis.operating_point import OperatingPoint, Vector, at, operating_point
from petalfoil.analysis.other_bearing import bearing_of, rotor_parts
from petalfoil.analysis.records import effort, failed_record, geometry, position, record_of
from petalfoil.analysis.rotor_files import EXPORTS
from petalfoil.analysis.runs import Points
from petalfoil.analysis.session import part
from petalfoil.analysis.tilt_coefficients import ENTRIES, TILTING, blocks
from petalfoil.analysis.tilted_journal import free_to_tilt, held, whole_length
from petalfoil.case import Case, ModelKind
from petalfoil.dynamics.rubbing_cycle import HarmonicsTold
from petalfoil.equilibrium.run_context import Progress, current_run, running
from petalfoil.errors import ConvergenceError, UsageError
from petalfoil.results.layout import Series, SinglePoint, at_speed
from petalfoil.results.parts import AppliedLoad, RunOutcome
from petalfoil.results.record import Record
from petalfoil.results.variable import Variable
from petalfoil.walls import Capability, required, wall_kind

Frequencies = Annotated[
    Sequence[float] | None,
    NumbersWithUnit(
        unit="rad/s",
        option="frequency",
        also="frequencies",
        metavar="LIST",
        help='Whirl frequencies: "600 Hz, 1200 Hz", or "0 Hz : 1500 Hz : 11"; by default the speed; with --ross '
        "many, closest to each other near half of each speed, where bearings whirl.",
        whirl=True,
        at_least=0.0,
    ),
]
Amplitude = Annotated[
    float | None,
    NumberWithUnit(
        unit="m",
        help='Amplitude of the whirl at which petals with friction rub: "1 um"; by default they stick. They slide '
        "along themselves; where petals.theory is inextensible only their faces turn.",
        above=0.0,
    ),
]
Harmonics = Annotated[
    int | None,
    Whole(
        metavar="COUNT",
        help="Odd harmonics of the slips at the amplitude, at least: 64; by default as many as they need.",
        at_least=1,
        at_most=256,
    ),
]
WithTilt = Annotated[
    bool,
    Flag(help="Also those of the slopes of the journal's axis: 4 by 4, the whole length."),
]
MATRICES = ("stiffness", "damping")


@dataclass(frozen=True)
class CoefficientRequest:
    """Whirl frequencies [rad/s], amplitude at which petals rub [m], whether the journal tilts too, least harmonics."""

    frequencies: Array
    amplitude: float | None
    tilt: bool = False
    harmonics: int | None = None


@dataclass(frozen=True)
class Amplitudes:
    """The amplitude of the whirl, if one was given."""

    whirl_amplitude: float | None


@dataclass(frozen=True)
class SolidContact:
    """What solid contact carries."""

    contact_fraction: float


LISTS = ("whirl_frequency", *MATRICES)
ERROR_BARS = {
    "stiffness_error": Variable(
        ENTRIES, "N m-1", "error bar of the stiffness, from grids and harmonics of slips", "dK"
    ),
    "damping_error": Variable(ENTRIES, "N s m-1", "error bar of the damping, from grids and harmonics of slips", "dC"),
}
HARMONICS_CHANGES = {
    "stiffness_harmonics_change": Variable(
        ENTRIES, "N m-1", "change of the stiffness from half as many harmonics", "dK_h"
    ),
    "damping_harmonics_change": Variable(
        ENTRIES, "N s m-1", "change of the damping from half as many harmonics", "dC_h"
    ),
}
HISTORIES = (*ERROR_BARS, *HARMONICS_CHANGES, *TILTING)


@analysis(
    SinglePoint(lists=LISTS, histories=HISTORIES, array_tables=TABLES),
    Series(lists=LISTS, histories=HISTORIES, array_tables=TABLES, at=at_speed),
    exports=EXPORTS,
    excludes={"speed": ("speeds",)},
    results={**ERROR_BARS, **HARMONICS_CHANGES, **TILTING},
    error_bars=True,
)
def coefficients(  # noqa: PLR0913 - the options of the verb
    case: Case,
    frequencies: Frequencies = None,
    *,
    load: Load = None,
    speed: Speed = None,
    speeds: Speeds = None,
    amplitude: Amplitude = None,
    harmonics: Harmonics = None,
    tilt: WithTilt = False,
    progress: Progress | None = None,
) -> Record | Points:
    """Find stiffness and damping at whirl frequencies, at one speed or several.

    At the case's eccentricity, or under a load where one is given. Those of
    one bearing: of two (rotor.span) each carries half of the load. Force on
    the journal: dF = -(K + i W C) de for a whirl de exp(i W t). Petals with
    friction stick, or rub in cycles of the --amplitude. Where the row
    "contacts" says "at nodes" and petals lie on each other along a stretch,
    stiffness is accurate to several per cent, a small damping to 50 %. With
    --tilt the slopes of the journal's axis and the moments about the
    bearing's centre are added.

    Example: petalfoil coefficients case.toml --frequency "4000 rad/s, 8000 rad/s"

    Raises
    ------
    UsageError
        A shaft at zero speed has no film that could respond; a frequency is zero with an amplitude or a loss factor;
        nothing rubs; harmonics without an amplitude; a tilt in 2-D.
    ConvergenceError
        The operating point was not found, or the pack is bottomed out.
    """
    newton_only(case)
    check_harmonics(amplitude, harmonics)
    turn = list(speeds) if speeds is not None else [at(case, speed).operation.speed]
    if not all(omega > 0.0 for omega in turn):
        raise UsageError("coefficients need a turning shaft: give speeds above zero")
    asked = CoefficientRequest(
        np.array(turn if frequencies is None else frequencies, dtype=float), amplitude, tilt, harmonics
    )
    check_amplitude(case, asked)
    check_loss(case, asked)
    check_tilt(case, asked)
    cases = [at(case, omega) for omega in turn]
    if speeds is None:
        with running(progress, "coefficients"):
            return point(cases[0], asked, load)
    return Points(partial(_points, cases, asked, load, progress), len(cases))


def check_amplitude(case: Case, asked: CoefficientRequest) -> None:
    """Refuse an amplitude that changes nothing, or that has no meaning.

    Raises
    ------
    UsageError
        No petals rub, or a frequency is zero.
    """
    if asked.amplitude is None:
        return
    check_rubbing(case)
    if np.any(asked.frequencies == 0.0):
        raise UsageError(
            "with an amplitude, whirl frequencies must be above zero: what friction takes in a cycle does not vanish "
            "with the frequency, so its equivalent damping has no bound"
        )


def check_harmonics(amplitude: float | None, harmonics: int | None) -> None:
    """Refuse harmonics of slips where no amplitude is given.

    Raises
    ------
    UsageError
        There is none.
    """
    if harmonics is not None and amplitude is None:
        raise UsageError("harmonics are those of petals that rub at an amplitude: give an amplitude, or leave them out")


def check_rubbing(case: Case) -> None:
    """Refuse an amplitude where no petals rub.

    Raises
    ------
    UsageError
        None do.
    """
    required(case, Capability.RUBBING, "an amplitude")
    if not case.surface.petal_friction > 0.0:
        raise UsageError("an amplitude says how far petals rub, and here none do: surface.petal_friction is 0")


def check_loss(case: Case, asked: CoefficientRequest) -> None:
    """Refuse a frequency of zero where the wall loses energy whatever the frequency.

    Raises
    ------
    UsageError
        The equivalent damping has no bound.
    """
    if wall_kind(case).loses_energy(case) and np.any(asked.frequencies == 0.0):
        raise UsageError(
            "with a loss factor, whirl frequencies must be above zero: what the foil loses in a cycle does not vanish "
            "with the frequency, so its equivalent damping has no bound; a loss_factor of 0 gives the static stiffness"
        )


def check_tilt(case: Case, asked: CoefficientRequest) -> None:
    """Refuse the slopes of a journal's axis where the model has no length.

    Raises
    ------
    UsageError
        It is 2-D.
    """
    if asked.tilt and case.model.kind is ModelKind.TWO_D:
        raise UsageError(
            'slopes of the axis need the length of the bearing: set model.kind = "3d", or leave out the tilt'
        )


def _points(
    cases: list[Case],
    asked: CoefficientRequest,
    load: Vector | None,
    progress: Progress | None,
    done: Sequence[Record] = (),
) -> Iterator[Record]:
    for place, case in enumerate(cases[len(done) :], len(done)):
        with running(part(progress, place, len(cases)), "coefficients"):
            try:
                record = point(case, asked, load)
            except ConvergenceError as failure:
                given = load if load is not None else case.operation.load
                applied = () if given is None else (AppliedLoad.of(given),)
                record = failed_record("coefficients", case, failure, *applied, Amplitudes(asked.amplitude))
        yield record


def point(case: Case, asked: CoefficientRequest, load: Vector | None) -> Record:
    """The record of one operating point.

    Raises
    ------
    ConvergenceError
        The operating point was not found, or the pack is bottomed out.
    """
    speed = case.operation.speed
    found = operating_point(whole_length(case) if asked.tilt else case, load)
    bearing = bearing_of(case, found.answer)
    answer = free_to_tilt(bearing, found.answer) if asked.tilt else held(bearing, found.answer)
    motion, sliding = elastic_and_sliding(bearing, answer)
    harmonics: list[HarmonicsTold] = []
    changes: dict[str, Array] = {}
    if asked.amplitude is None or sliding is None:
        pairs = impedances(motion, asked.frequencies, speed)
    else:
        rubs, least = (sliding, asked.amplitude), asked.harmonics or 0
        each = asked.frequencies
        cycles = [cycle_impedance(motion.frictionless, frequency, speed, rubs, least) for frequency in each]
        pairs = [(one.stiffness, one.damping) for one in cycles]
        harmonics.append(HarmonicsTold.most_of([one.told for one in cycles]))
        by_harmonics = blocks(bearing, [one.changes for one in cycles])
        changes = {f"{name}_harmonics_change": by_harmonics[name] for name in MATRICES}
    cost = effort(current_run().seconds)
    return record_of(
        "coefficients",
        case,
        *state_parts(case, found),
        Amplitudes(asked.amplitude),
        *harmonics,
        ContactModel.of_motion(motion),
        RunOutcome(residual=found.answer.reported_residual),
        cost,
        fields={**blocks(bearing, pairs), **changes},
        coords={"whirl_frequency": asked.frequencies, "row": np.arange(2), "column": np.arange(2)},
    )


def state_parts(case: Case, found: OperatingPoint) -> tuple[object, ...]:
    """What is told of the equilibrium that small motions are about."""
    bearing = bearing_of(case, found.answer)
    contact = SolidContact(Evaluation.of(bearing, found.answer).contact_fraction)
    hot = heat_results(bearing, found.answer)
    told = (*(() if hot is None else (hot,)), *rotor_parts(case, found.answer), FrictionTold.of(case, found.answer))
    return *geometry(bearing), position(bearing, found.answer), contact, found.branch, *found.loaded, *told
