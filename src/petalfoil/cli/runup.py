"""``petalfoil runup``: from rest to speed under a load, and back."""

from __future__ import annotations

from petalfoil.cli import parsing
from petalfoil.cli.autosave import Autosave
from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, Json, Load, Out, Plot, Points, Top
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def runup(  # noqa: PLR0913 - one argument for each option the user sees
    case: CaseFile,
    to: Top,
    load: Load = None,
    points: Points = 25,
    as_json: Json = False,
    out: Out = None,
    plot: Plot = None,
) -> None:
    """Follow torque, contact, film and position from rest to a speed, and back.

    Each point is followed from the one before. With --out the file is
    rewritten as points finish; Ctrl-C keeps what is finished.

    Example: petalfoil runup case.toml --load "46.4 N" --to "30000 rpm"
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)
        force, fastest = parsing.load(load), parsing.top(to)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import runup as legs
        from petalfoil.cli.kinds import RunupAnswer
        from petalfoil.cli.series import collect

        with bar("runup") as report:
            records = (record for _, record in legs.iterate(definition, force, fastest, points=points, progress=report))
            answer = collect(records, 2 * points - 1, Autosave(out, "runup"), report, RunupAnswer)
        outputs.deliver(answer)
