"""``petalfoil coefficients``: stiffness and damping over whirl frequency and speed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import Amplitude, CaseFile, Csv, Frequencies, Json, Load, Out, Plot, Ross, Speed, Speeds
from petalfoil.cli.outputs import Export, Outputs
from petalfoil.cli.progress import Report, bar
from petalfoil.errors import UsageError

if TYPE_CHECKING:
    from petalfoil.case import Case
    from petalfoil.cli.answer import Answer


def coefficients(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    frequency: Frequencies = None,
    load: Load = None,
    speed: Speed = None,
    speeds: Speeds = None,
    amplitude: Amplitude = None,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
    csv: Csv = None,
    ross: Ross = None,
) -> None:
    """Find stiffness and damping at whirl frequencies, at one speed or several.

    At the case's eccentricity, or under a load where one is given. Force on
    the journal: dF = -(K + i W C) de for a whirl de exp(i W t). Petals with
    friction stick, or rub in cycles of the --amplitude.

    Example: petalfoil coefficients case.toml --frequency "4000 rad/s, 8000 rad/s"
    """
    with handled(as_json):
        turn, whirl = parsing.speeds("--speeds", speeds), parsing.speeds("--frequency", frequency)
        if turn is not None and speed is not None:
            raise UsageError("--speed and --speeds: give one of them")
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot, exports=_exports(csv, ross, turn, whirl))
        omega, force, size = parsing.speed(speed), parsing.load(load), parsing.amplitude(amplitude)

        from petalfoil.case import Case
        from petalfoil.cli.kinds import CoefficientsAnswer

        definition = Case.load(case)

        with bar("coefficients") as report:
            if turn is not None:
                answer = _over_speeds(definition, (turn, whirl, force, size), Autosave(out, "coefficients"), report)
            else:
                from petalfoil.analysis import coefficients as impedances

                record = impedances.run(definition, whirl, load=force, speed=omega, amplitude=size, progress=report)
                answer = CoefficientsAnswer(verb="coefficients", records=(record,))
        outputs.deliver(answer)


Asked = tuple[list[float], list[float] | None, tuple[float, float] | None, float | None]


def _over_speeds(case: Case, asked: Asked, autosave: Autosave, report: Report) -> Answer:
    from petalfoil.analysis import coefficients as impedances
    from petalfoil.cli.kinds import CoefficientsAnswer
    from petalfoil.cli.series import collect

    turn, whirl, force, size = asked
    points = impedances.iterate(case, turn, whirl, load=force, amplitude=size, progress=report)
    return collect(points, len(turn), autosave, report, CoefficientsAnswer)


def _exports(
    csv: Path | None, ross: Path | None, turn: list[float] | None, whirl: list[float] | None
) -> tuple[Export, ...]:
    """Files for other programs, checked before the run."""
    return tuple(_wanted(csv, ross, turn or [], whirl))


def _wanted(csv: Path | None, ross: Path | None, turn: list[float], whirl: list[float] | None) -> Iterator[Export]:
    if csv is None and ross is None:
        return
    from petalfoil.results import export

    if csv is not None:
        yield Export(option="--csv", path=csv, suffixes=(".csv",), write=export.write_csv)
    if ross is not None:
        try:
            export.check_axes(turn, turn if whirl is None else whirl)
        except UsageError as error:
            raise UsageError(f"--ross: {error}; --speeds and --frequency give them") from error
        yield Export(option="--ross", path=ross, suffixes=(".toml", ".json"), write=export.write_ross)
