"""The verbs under one name."""

from __future__ import annotations

from typing import Annotated

import typer

from petalfoil import __version__
from petalfoil.cli.balance import balance
from petalfoil.cli.check import check
from petalfoil.cli.coefficients import coefficients
from petalfoil.cli.converge import converge
from petalfoil.cli.curve import curve
from petalfoil.cli.failures import handled
from petalfoil.cli.liftoff import liftoff
from petalfoil.cli.orbit import orbit
from petalfoil.cli.reproduce import reproduce
from petalfoil.cli.runup import runup
from petalfoil.cli.show import show
from petalfoil.cli.solve import solve
from petalfoil.cli.stability import stability
from petalfoil.cli.static import static
from petalfoil.cli.streams import accept_any_text, emit

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,  # `failures` speaks to the user, not a decorated traceback
    rich_markup_mode="rich",
)
VERBS = (
    *(solve, curve, static, balance, liftoff, runup, coefficients, stability, orbit),
    *(check, converge, show, reproduce),
)
for verb in VERBS:
    app.command()(verb)


def _print_version(wanted: bool) -> None:
    if wanted:
        with handled():
            emit(f"petalfoil {__version__}\n")
            raise typer.Exit


@app.callback()
def petalfoil(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Simulate petal (multi-leaf foil) gas bearings.

    A case is a TOML file with quantities such as "25 um". Every verb prints a
    short table or, with --json, one JSON object in SI units.

    Exit codes: 0 done, 2 bad case or bad usage, 3 no converged answer,
    130 interrupted.

    Example: petalfoil solve case.toml --speed "8000 rad/s" --plot petals.png
    """


def main() -> None:
    """Run the command line with the arguments of the process, and leave with its exit code."""
    accept_any_text()
    app(prog_name="petalfoil")
