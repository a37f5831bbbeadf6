"""The declaration of an analysis as a command: its options, and what a call of it does."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Annotated, Any

import typer

from petalfoil.analysis import known_verbs
from petalfoil.analysis.arguments import Argument, Flag, LoadVector, Measured, NumbersWithUnit, Pair, StoredResult
from petalfoil.analysis.declaration import RESUME, Analysis
from petalfoil.analysis.progress_bar import bar
from petalfoil.case import Case
from petalfoil.cli.exports import chosen, export_options
from petalfoil.cli.failures import handled
from petalfoil.cli.keeping import Autosave, earlier_set_aside, follow
from petalfoil.cli.outputs import Outputs
from petalfoil.cli.streams import be_verbose, say
from petalfoil.errors import UsageError
from petalfoil.units.reading import note_on_bare

KEYWORD = inspect.Parameter.KEYWORD_ONLY
REQUIRED = inspect.Parameter.empty

CASE_FILE = Annotated[Path, typer.Argument(metavar="CASE", help="Case to run, a TOML file.")]
JSON = Annotated[bool, typer.Option("--json", help="Print one JSON object in SI units instead of the table.")]
OUT = Annotated[Path | None, typer.Option("--out", metavar="FILE.nc", help="Write the whole result to a NetCDF file.")]
PLOT = Annotated[Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw a figure: .png, .svg or .pdf.")]
RESUME_FILE = Annotated[Path | None, typer.Option("--resume", metavar=RESUME.metavar, help=RESUME.help)]
VERBOSE = Annotated[
    bool,
    typer.Option("-v", "--verbose", callback=be_verbose, expose_value=False, help="Log every step of the solvers."),
]
HELP = ["-h", "--help"]
"""Options that print the help text."""
OUTPUTS = {"as_json": (JSON, False), "out": (OUT, None), "plot": (PLOT, None)}
"""Options that every command has, with their defaults."""


def command_of(verb: str) -> Any:
    """The command of an analysis."""
    analysis = known_verbs.find(verb)
    if analysis is None:
        raise ValueError(f"no analysis is called {verb!r}")

    def ask(**given: Any) -> None:
        call(analysis, given)

    options = [inspect.Parameter("case", KEYWORD, annotation=CASE_FILE), *argument_options(analysis)]
    if analysis.is_series:
        options.append(inspect.Parameter("resume", KEYWORD, annotation=RESUME_FILE, default=None))
    for name, (annotation, default) in OUTPUTS.items():
        options.append(inspect.Parameter(name, KEYWORD, annotation=annotation, default=default))
    options += export_options(analysis.exports)
    return command(verb, ask, options, analysis.help)


def command(name: str, function: Callable[..., None], options: list[inspect.Parameter], text: str) -> Any:
    """A command of its own: its options, its help text, and the function that is called with them."""
    options = [*options, inspect.Parameter("verbose", KEYWORD, annotation=VERBOSE, default=False)]
    ordered = sorted(options, key=lambda option: option.default is not REQUIRED)
    function.__signature__ = inspect.Signature(ordered)  # type: ignore[attr-defined]
    function.__annotations__ = {option.name: option.annotation for option in options}
    function.__doc__ = text
    alone = typer.Typer(
        add_completion=False,
        pretty_exceptions_enable=False,
        rich_markup_mode="rich",
        context_settings={"help_option_names": HELP},
    )
    alone.command(name)(function)
    return typer.main.get_command(alone)


def call(analysis: Analysis, given: dict[str, Any]) -> None:
    """Run an analysis with the options of a call, and give its answer out."""
    path, as_json, out, plot = (given.pop(name) for name in ("case", *OUTPUTS))
    resume = given.pop("resume", None)
    with handled(as_json):
        outputs = Outputs.checked(as_json=as_json, out=out, plot=plot, exports=chosen(analysis.exports, given))
        known_as = {name: argument.option_name(name) for name, argument in analysis.arguments.items()}
        _refuse_overwriting(analysis, given, out)
        values = analysis.read({name: given[name] for name in known_as}, known_as)
        values = _fit_exports(analysis, given, values, known_as)
        note_bare_numbers(analysis, given, known_as)
        case = Case.load(path)
        with ExitStack() as ending:
            with bar(analysis.verb) as report:
                run = analysis.start(case, values, report, None if resume is None else RESUME.named("--resume", resume))
                ending.enter_context(earlier_set_aside(out, resume))
                answer, stopped = follow(analysis, run, Autosave(out), report)
            outputs.deliver(answer, stopped=stopped)


def argument_options(analysis: Analysis) -> list[inspect.Parameter]:
    """The options of the arguments, in their order: texts and flags, absent where nothing is given."""
    options = []
    taken = {argument.option_name(name) for name, argument in analysis.arguments.items()}
    for name, argument in analysis.arguments.items():
        default, is_flag = analysis.default(name), isinstance(argument, Flag)
        shown = argument.text(default) if default not in (REQUIRED, None) and not is_flag else False
        option = typer.Option(
            *_names(name, argument, taken),
            metavar=None if is_flag else argument.metavar,
            help=argument.help,
            show_default=shown,
        )
        kind = bool if is_flag else Path | None if isinstance(argument, StoredResult) else str | None
        absent = REQUIRED if default is REQUIRED else False if is_flag else None
        options.append(inspect.Parameter(name, KEYWORD, annotation=Annotated[kind, option], default=absent))
    return options


def _names(name: str, argument: Argument, taken: set[str]) -> list[str]:
    """The names of an option; its second one, and that of the Python argument, only where no other argument has it."""
    others = [f"--{argument.also}"] if argument.also else []
    others.append(f"--{name.replace('_', '-')}")
    return [argument.option_name(name), *(other for other in dict.fromkeys(others) if other not in taken)]


def _refuse_overwriting(analysis: Analysis, given: dict[str, Any], out: Path | None) -> None:
    """Refuse to write where a result is read from."""
    for name, argument in analysis.arguments.items():
        source = given[name]
        if isinstance(argument, StoredResult) and out is not None and source is not None:
            if out.resolve() == source.resolve():
                raise UsageError(
                    f"--out: {out} is what {argument.option_name(name)} reads; give another name, or it would be lost"
                )


def note_bare_numbers(analysis: Analysis, given: Mapping[str, Any], known_as: Mapping[str, str]) -> None:
    """Say of each option with a number without a unit how it was read: a speed of 60000 is in rad/s, not in rpm."""
    for name, argument in analysis.arguments.items():
        if isinstance(argument, Measured | Pair | LoadVector):
            whirl = isinstance(argument, NumbersWithUnit) and argument.whirl
            note_bare_number(known_as[name], given.get(name), argument.unit, whirl=whirl)


def note_bare_number(option: str, given: object, unit: str, *, whirl: bool = False) -> None:
    """Say how the text of one option was read, where it has a number without a unit."""
    if isinstance(given, str) and (note := note_on_bare(given, unit, whirl=whirl)):
        say(f"Note: {option}: {note}")


def _fit_exports(
    analysis: Analysis, given: dict[str, Any], values: dict[str, Any], known_as: dict[str, str]
) -> dict[str, Any]:
    """Arguments that the exports asked for can be written with; what they could not write is refused."""
    wanted = [export for export in analysis.exports if given[export.option] is not None]
    for export in wanted:
        values = dict(export.fill(values)) if export.fill else values
    for export in wanted:
        try:
            if export.check is not None:
                export.check(values, known_as)
        except UsageError as refusal:
            raise UsageError(f"--{export.option}: {refusal}") from refusal
    return values
