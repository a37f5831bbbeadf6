"""``petalfoil curve``: the load characteristic at one speed."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import DOWNWARD, CaseFile, Direction, Displacements, Json, Out, Plot, Speed
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def curve(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    eccentricity: Displacements,
    direction: Direction = DOWNWARD,
    speed: Speed = None,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Follow the load over the displacement of the journal, at one speed.

    Points that do not converge are named and left blank. With --out the file
    is rewritten as points finish; Ctrl-C keeps what is finished.

    Example: petalfoil curve case.toml --eccentricity "0 um : 280 um : 15"
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        distances, angle = parsing.displacements(eccentricity), parsing.direction(direction)
        omega = parsing.speed(speed)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import load_curve
        from petalfoil.cli.series import collect

        with bar("curve") as report:
            points = load_curve.iterate(definition, distances, direction=angle, speed=omega, progress=report)
            answer = collect(points, len(distances), Autosave(out, "curve"), report)
        outputs.deliver(answer)
