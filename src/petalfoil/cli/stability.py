"""``petalfoil stability``: which rotor whirls on the bearing, from which speed on, and its natural frequencies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, ChartLoads, Json, Load, Mass, Out, Plot, Speed, Speeds
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import Report, bar
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    from petalfoil.case import Case
    from petalfoil.cli.answer import Answer


def stability(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    load: Load = None,
    mass: Mass = None,
    speed: Speed = None,
    speeds: Speeds = None,
    loads: ChartLoads = None,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Find the smallest mass of a rigid rotor that whirls, threshold speed and damped natural frequencies.

    At the case's eccentricity, or under a load where one is given; with
    --speeds or --loads as a table over load and speed. Petals with friction
    stick, as in the smallest motions.

    Example: petalfoil stability case.toml --load "20 N" --mass "2 kg"
    """
    answer: Answer
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        turn, forces = parsing.speeds("--speeds", speeds), None if loads is None else parsing.loads("--loads", loads)
        _refuse_both(("--speed", speed, speeds), ("--load", load, loads), ("--mass", mass, speeds or loads))
        omega, force, rotor = parsing.speed(speed), parsing.load(load), parsing.mass(mass)

        from petalfoil.case import Case

        definition = Case.load(case)

        with bar("stability") as report:
            if turn is None and forces is None:
                from petalfoil.analysis import stability as whirl
                from petalfoil.cli.kinds import StabilityAnswer

                record = whirl.run(definition, load=force, mass=rotor, speed=omega, progress=report)
                answer = StabilityAnswer(verb="stability", records=(record,))
            else:
                answer = _chart(definition, (turn or _one(omega), forces, force), (outputs, report))
        outputs.deliver(answer)


Asked = tuple[list[float] | None, list[float] | None, tuple[float, float] | None]


def _chart(case: Case, asked: Asked, to: tuple[Outputs, Report]) -> Answer:
    from petalfoil.analysis import stability as whirl
    from petalfoil.cli.kinds import ChartAnswer
    from petalfoil.cli.series import collect
    from petalfoil.results.chart import chart_dataset

    (turn, forces, force), (outputs, report) = asked, to
    points = whirl.iterate(case, turn, forces, load=force, progress=report)
    autosave = Autosave(outputs.out, "stability", layout=chart_dataset)
    return collect(points, len(turn or [0]) * len(forces or [0]), autosave, report, ChartAnswer)


def _one(speed: float | None) -> list[float] | None:
    return None if speed is None else [speed]


def _refuse_both(*pairs: tuple[str, str | None, str | None]) -> None:
    for option, one, several in pairs:
        if one is not None and several is not None:
            raise UsageError(f"{option} says nothing beside --speeds or --loads: leave it out")
