"""``petalfoil static``: the package without rotation."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import DOWNWARD, CaseFile, Direction, Displacements, Json, Out, Plot
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def static(
    case: CaseFile,
    eccentricity: Displacements = "0 um",
    direction: Direction = DOWNWARD,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Press the journal into the package at rest: preload, load, starting torque.

    Preload and starting torque are those of the centred journal, so let the
    displacements begin at 0. With --out the file is rewritten as points
    finish; Ctrl-C keeps what is finished.

    Example: petalfoil static case.toml --eccentricity "0 um : 280 um : 15"
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        distances, angle = parsing.displacements(eccentricity), parsing.direction(direction)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import static as package_at_rest
        from petalfoil.cli.series import collect

        with bar("static") as report:
            points = package_at_rest.iterate(definition, distances, direction=angle, progress=report)
            answer = collect(points, len(distances), Autosave(out, "static"), report)
        outputs.deliver(answer)
