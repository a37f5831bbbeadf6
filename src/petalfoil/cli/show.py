"""``petalfoil show``: a result file once more, without running anything."""

from __future__ import annotations

from petalfoil.cli.failures import handled
from petalfoil.cli.options import Json, Plot, ResultFile
from petalfoil.cli.outputs import Outputs


def show(result: ResultFile, as_json: Json = False, plot: Plot = None) -> None:
    """Show a result file once more: table and figure, without running anything.

    Example: petalfoil show curve.nc --plot curve.pdf
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, plot=plot)

        from petalfoil.cli.stored import answer_of
        from petalfoil.results.store import load

        dataset = load(result)
        outputs.deliver(answer_of(dataset), dataset)
