"""``petalfoil check``: the case itself, before anything is run."""

from __future__ import annotations

from petalfoil.cli.failures import handled
from petalfoil.cli.options import CaseFile, Json, Out, Plot
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.progress import bar


def check(case: CaseFile, as_json: Json = False, out: Out = None, plot: Plot = None) -> None:
    """Validate a case: derived figures such as overlap and room, cross-section.

    Nothing is run beyond the package at rest that the cross-section shows.

    Example: petalfoil check case.toml --plot section.svg
    """
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot)

        from petalfoil.case import Case

        definition = Case.load(case)

        from petalfoil.analysis import check as derived
        from petalfoil.cli.answer import Answer

        with bar("check"):
            record = derived.run(definition)
        outputs.deliver(Answer(verb="check", records=(record,)))
