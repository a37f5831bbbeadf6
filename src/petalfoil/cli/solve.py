"""``petalfoil solve``: film and petals in equilibrium at one position of the journal."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, Json, Out, Plot, Position, Speed
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def solve(
    case: CaseFile,
    speed: Speed = None,
    eccentricity: Position = None,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Find film and petals in equilibrium at one position of the journal.

    Gives the force on the journal, film, contacts, torque, leakage and stress.

    Example: petalfoil solve case.toml --eccentricity "0 um, -100 um" --json
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        omega, position = parsing.speed(speed), parsing.position(eccentricity)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import equilibrium
        from petalfoil.cli.answer import Answer

        with bar("solve") as report:
            record = equilibrium.run(definition, speed=omega, eccentricity=position, progress=report)
        outputs.deliver(Answer(verb="solve", records=(record,)))
