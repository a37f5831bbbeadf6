"""``petalfoil balance``: where the journal sits under a load."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, Json, Load, Out, Plot, Speed
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def balance(
    case: CaseFile,
    load: Load = None,
    speed: Speed = None,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Find the position of the journal under a load.

    Figures as from solve, at that position. A load that the film does not
    carry alone is an answer too: "carried by" tells the share of the contacts.

    Example: petalfoil balance case.toml --load "0 N, -50 N" --speed "60000 rpm"
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        omega, force = parsing.speed(speed), parsing.load(load)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import balance as operating_point
        from petalfoil.cli.answer import Answer

        with bar("balance") as report:
            record = operating_point.run(definition, force, speed=omega, progress=report)
        outputs.deliver(Answer(verb="balance", records=(record,)))
