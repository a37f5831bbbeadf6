"""``petalfoil liftoff``: the speed above which the journal floats."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, Json, Loads, Out, Plot, Share
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def liftoff(
    case: CaseFile,
    load: Loads,
    share: Share = "0.01",
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Find the speeds of lift-off and touch-down for each load along -y.

    The journal floats where contacts carry less than the share. Each speed is
    known to 0.1 %; how it depends on share and film floor is told with it.

    Example: petalfoil liftoff case.toml --load "46.4 N, 55.6 N" --plot liftoff.png
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        forces, least = parsing.loads("--load", load), parsing.share(share)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import liftoff as crossings
        from petalfoil.cli.kinds import LiftoffAnswer
        from petalfoil.cli.series import collect

        with bar("liftoff") as report:
            points = crossings.iterate(definition, forces, share=least, progress=report)
            answer = collect(points, len(forces), Autosave(out, "liftoff"), report, LiftoffAnswer)
        outputs.deliver(answer)
