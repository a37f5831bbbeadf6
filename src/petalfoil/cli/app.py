"""The verbs under one name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from petalfoil import __version__
from petalfoil.analysis import known_verbs
from petalfoil.cli.docs import docs
from petalfoil.cli.failures import handled
from petalfoil.cli.new import new
from petalfoil.cli.report import report
from petalfoil.cli.reproduce import reproduce
from petalfoil.cli.streams import accept_any_text, be_verbose, emit
from petalfoil.cli.studio import studio
from petalfoil.text import for_terminal

if TYPE_CHECKING:
    Context = Any


SHOW = "Show a stored result without computing it again: table, figure, files for other programs."


STUDIES = {
    "sweep": "Run an analysis on many cases: over a grid of parameters, or a sample of them.",
    "tolerance": "Run an analysis on bearings with manufacturing scatter, and find how likely limits are kept.",
    "optimize": "Find the best design within limits, beginning at the case.",
    "study": "Show, resume or export the study in a folder.",
}
"""Commands of studies and the first lines of their help texts."""


def is_sampled(name: str, words: list[str]) -> bool:
    """Whether a call asks `sensitivity` for Sobol' indices, which is a study, instead of derivatives."""
    return name == "sensitivity" and any(word.partition("=")[0] == "--samples" for word in words)


class Verbs(TyperGroup):
    """The analyses, read from their declarations, and the commands that are none.

    The list of commands needs names and one line each; only the analysis that is called is loaded.
    """

    def list_commands(self, ctx: Context) -> list[str]:
        """Names of all verbs."""
        return [*known_verbs.summaries(), "show", *STUDIES, *super().list_commands(ctx)]

    def get_command(self, ctx: Context, cmd_name: str) -> Any:
        """The command of a verb as the list of commands shows it."""
        if cmd_name in known_verbs.summaries():
            return TyperCommand(cmd_name, help=known_verbs.summaries()[cmd_name])
        if cmd_name == "show" or cmd_name in STUDIES:
            return TyperCommand(cmd_name, help={"show": SHOW, **STUDIES}[cmd_name])
        return super().get_command(ctx, cmd_name)

    def resolve_command(self, ctx: Context, args: list[str]) -> Any:
        """The command that is called, with all its options."""
        if args and args[0] not in self.list_commands(ctx):
            from petalfoil.case.hints import nearest

            ctx.fail(f"No such command '{for_terminal(args[0])}'.{nearest(args[0], self.list_commands(ctx))}")
        name, command, rest = super().resolve_command(ctx, args)
        if name in STUDIES or is_sampled(str(name), rest):
            from petalfoil.cli.study_commands import study_command

            command = study_command(str(name), rest)
        elif name in known_verbs.summaries():
            from petalfoil.cli.commands import command_of

            command = command_of(str(name))
        elif name == "show":
            from petalfoil.cli.show import show_command

            command = show_command()
        return name, command, rest


app = typer.Typer(
    cls=Verbs,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,  # `failures` speaks to the user, not a decorated traceback
    rich_markup_mode="rich",
)
app.command()(new)
app.command()(report)
app.command()(reproduce)
app.command()(studio)
app.command()(docs)


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
    verbose: Annotated[bool, typer.Option("-v", "--verbose", help="Log every step of the solvers.")] = False,
) -> None:
    """Simulate petal (multi-leaf foil) gas bearings.

    A case is a TOML file with quantities such as "25 um". Every command prints a
    short table or, with --json, one JSON object in SI units.

    Exit codes: 0 done, 2 bad case or bad usage, 3 no converged answer,
    130 interrupted, 143 terminated, 129 hung up.

    Example: petalfoil solve case.toml --speed "8000 rad/s" --plot petals.png
    """
    be_verbose(verbose)


def main() -> None:
    """Run the command line with the arguments of the process, and leave with its exit code."""
    accept_any_text()
    app(prog_name="petalfoil")
