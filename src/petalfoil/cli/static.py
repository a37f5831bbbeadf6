"""``petalfoil static``: the package without rotation."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import DOWNWARD, CaseFile, Direction, Displacements, Json, Loop, Out, Plot
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def static(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    eccentricity: Displacements = "0 um",
    direction: Direction = DOWNWARD,
    loop: Loop = False,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Press the journal into the package at rest: preload, load, starting torque.

    Preload and starting torque are those of the centred journal, so let the
    displacements begin at 0. With --out the file is rewritten as points
    finish; Ctrl-C keeps what is finished.

    With friction between the petals (surface.petal_friction) each point
    comes from the one before; --loop goes back and there again.

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
            points = package_at_rest.iterate(definition, distances, direction=angle, loop=loop, progress=report)
            count = 3 * len(distances) - 2 if loop else len(distances)
            answer = collect(points, count, Autosave(out, "static"), report)
        outputs.deliver(answer)
