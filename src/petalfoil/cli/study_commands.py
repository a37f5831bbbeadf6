"""The commands of studies: their own options beside those of the analysis that they ask."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from petalfoil.analysis.declaration import Analysis
from petalfoil.analysis.progress_bar import bar
from petalfoil.case import Case
from petalfoil.cli.commands import CASE_FILE, JSON, KEYWORD, argument_options, command, note_bare_numbers
from petalfoil.cli.failures import handled
from petalfoil.cli.signals import exit_code_of
from petalfoil.cli.streams import say
from petalfoil.cli.study_outputs import deliver
from petalfoil.errors import UnitError, UsageError
from petalfoil.studies.question import Question, analysis_of
from petalfoil.studies.study_definition import Study
from petalfoil.units import parse_quantity
from petalfoil.units.reading import shown

if TYPE_CHECKING:
    from petalfoil.studies.run import Execution

ASK = "--ask"
DEFAULT_VERB = "solve"
VARY_HELP = 'What varies, as often as needed: petals.thickness="0.1 mm : 0.2 mm : 11", petals.count=6,8,10.'
Vary = Annotated[list[str], typer.Option("--vary", metavar="PATH=VALUES", help=VARY_HELP)]
Ask = Annotated[
    str, typer.Option(ASK, metavar="VERB", help="Analysis that is asked; its own options are listed here too.")
]
Out = Annotated[
    Path, typer.Option("--out", metavar="FOLDER", help="Folder of the study; one that was stopped goes on.")
]
Workers = Annotated[
    int | None,
    typer.Option(
        "--workers", metavar="N", help="Worker processes, by default one a processor; 0: this one alone.", min=0
    ),
]
Scheduler = Annotated[
    str, typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler that runs already: tcp://10.0.0.1:8786.")
]
MemoryLimit = Annotated[
    str | None,
    typer.Option("--memory", metavar="SIZE", help='Memory of each worker: "2 GB"; by default an equal part.'),
]
Fields = Annotated[bool, typer.Option("--fields", help="Write film and petals of each case too, one file a case.")]
Anew = Annotated[bool, typer.Option("--anew", help="Replace another study in the folder.")]
NEIGHBOURS_HELP = (
    "Begin cases at the nearest solution where that is quicker: results differ by 1e-9 of themselves at most."
)
Neighbours = Annotated[bool, typer.Option("--neighbours", help=NEIGHBOURS_HELP)]
Sample = Annotated[
    str,
    typer.Option("--sample", metavar="SAMPLE", help='A sample instead of all combinations: "lhs 200", "sobol 256".'),
]
SCATTER_HELP = (
    'What scatters, as often as needed: petals.thickness="± 5 um" (uniform), "normal 0.2 mm" (standard deviation), '
    '"triangular ± 2 %"; "each" behind it for one value a petal.'
)
ScatterOption = Annotated[list[str], typer.Option("--scatter", metavar="PATH=SCATTER", help=SCATTER_HELP)]
LimitOption = Annotated[
    list[str],
    typer.Option("--limit", metavar="LIMIT", help='A limit: "liftoff_speed < 15000 rpm"; as often as needed.'),
]
Samples = Annotated[
    str, typer.Option("--samples", metavar="SAMPLE", help='Number of bearings, or a sample: "lhs 500, seed 2".')
]
Of = Annotated[
    list[str], typer.Option("--of", metavar="RESULT", help="A result whose variance is told; by default all.")
]
BaseSamples = Annotated[int, typer.Option("--samples", metavar="N", help="Base samples, a power of two.")]
RANGES_HELP = 'What varies, as often as needed: petals.thickness="0.1 mm : 0.3 mm", petals.count="6 : 12".'
Ranges = Annotated[list[str], typer.Option("--vary", metavar="PATH=RANGE", help=RANGES_HELP)]
Maximize = Annotated[list[str], typer.Option("--maximize", metavar="RESULT", help="A result that is to be large.")]
Minimize = Annotated[list[str], typer.Option("--minimize", metavar="RESULT", help="A result that is to be small.")]
Subject = Annotated[
    list[str],
    typer.Option("--subject", metavar="LIMIT", help='A limit: "min_film_thickness > 5 um"; as often as needed.'),
]
Budget = Annotated[int, typer.Option("--budget", metavar="N", help="Designs that may be answered.", min=1)]
SearchMethod = Annotated[
    str,
    typer.Option("--method", metavar="METHOD", help="slsqp along gradients, tpe or nsga2 by sampling; auto chooses."),
]
Seed = Annotated[int, typer.Option("--seed", metavar="N", help="Seed of what is drawn at random.", min=0)]
RUNNING = {
    "out": (Out, Path("study")),
    "workers": (Workers, None),
    "scheduler": (Scheduler, ""),
    "memory": (MemoryLimit, None),
    "fields": (Fields, False),
    "anew": (Anew, False),
    "neighbours": (Neighbours, False),
    "as_json": (JSON, False),
}
"""Options of every study, with their defaults."""


@dataclass(frozen=True)
class StudyCommand:
    """A command that begins a study.

    Attributes
    ----------
    help : str
        Its help text.
    options : dict
        Its own options with their defaults.
    define : callable
        Makes the study from case, question and own options.
    default : str
        Analysis that is asked unless another is given.
    """

    help: str
    options: dict[str, tuple[Any, Any]]
    define: Callable[[Case, Question, dict[str, Any]], Study]
    default: str = DEFAULT_VERB
    hidden: tuple[str, ...] = field(default=("error", "restart"))


def define_sweep(case: Case, question: Question, own: dict[str, Any]) -> Study:
    """The study of ``petalfoil sweep``."""
    from petalfoil.studies.sweep import sweep_study

    return sweep_study(case, assignments("--vary", own["vary"]), question, own["sample"])


def define_tolerance(case: Case, question: Question, own: dict[str, Any]) -> Study:
    """The study of ``petalfoil tolerance``."""
    from petalfoil.studies.tolerance import tolerance_study

    scatter, sample = assignments("--scatter", own["scatter"]), own["samples"]
    sample = f"sobol {sample}" if sample.strip().isdigit() else sample
    return tolerance_study(case, scatter, question, limits=own["limit"], sample=sample)


def define_sobol(case: Case, question: Question, own: dict[str, Any]) -> Study:
    """The study of ``petalfoil sensitivity --samples``."""
    from petalfoil.studies.sobol import sobol_study

    return sobol_study(case, assignments("--vary", own["vary"]), question, samples=own["samples"], of=own["of"])


def define_optimize(case: Case, question: Question, own: dict[str, Any]) -> Study:
    """The study of ``petalfoil optimize``."""
    from petalfoil.studies.optimize import optimize_study

    settings = {name: own[name] for name in ("maximize", "minimize", "subject", "budget", "method", "seed")}
    return optimize_study(case, assignments("--vary", own["vary"]), question, settings)


COMMANDS = {
    "sweep": StudyCommand(
        help="""Run an analysis on many cases: over a grid of parameters, or a sample of them.

A parameter is any number of the case by its path. The folder holds the study
while it runs and afterwards: study.nc, table.csv, figures and a page. A case
without an answer is part of the result, with its reason.

Example: petalfoil sweep case.toml --vary petals.thickness="0.1 mm : 0.2 mm : 11" --ask balance --load "20 N"
""",
        options={"vary": (Vary, inspect.Parameter.empty), "sample": (Sample, "")},
        define=define_sweep,
    ),
    "tolerance": StudyCommand(
        help="""Run an analysis on bearings with manufacturing scatter, and find how likely limits are kept.

Mean, standard deviation and quantiles of the results, beside the estimate of
first order; of each limit the probability that it is kept, with its 95 %
confidence interval. A bearing without an answer does not keep a limit.

Example: petalfoil tolerance case.toml --scatter petals.thickness="± 5 um" --ask liftoff --load "20 N"
""",
        options={
            "scatter": (ScatterOption, inspect.Parameter.empty),
            "limit": (LimitOption, []),
            "samples": (Samples, "500"),
        },
        define=define_tolerance,
    ),
    "sensitivity": StudyCommand(
        help="""Compute Sobol' indices: the part of a result's variance that each parameter explains.

Without --samples the command gives exact derivatives at the case instead.
N base samples take N times the number of parameters plus two cases; blocks
with a case that has no answer are left out.

Example: petalfoil sensitivity case.toml --samples 256 --vary petals.thickness="± 5 %" --vary gas.viscosity="± 2 %"
""",
        options={"vary": (Ranges, inspect.Parameter.empty), "of": (Of, []), "samples": (BaseSamples, 256)},
        define=define_sobol,
    ),
    "optimize": StudyCommand(
        help="""Find the best design within limits, beginning at the case.

Along gradients (SLSQP, exact derivatives where the analysis has them) for
continuous parameters; by sampling (Optuna) for counts and several objectives,
of which a front is found. The best designs are case files in the folder.

Example: petalfoil optimize case.toml --vary petals.thickness="0.1 mm : 0.3 mm" --maximize bearing_force
""",
        options={
            "vary": (Ranges, inspect.Parameter.empty),
            "maximize": (Maximize, []),
            "minimize": (Minimize, []),
            "subject": (Subject, []),
            "budget": (Budget, 200),
            "method": (SearchMethod, "auto"),
            "seed": (Seed, 0),
        },
        define=define_optimize,
    ),
}
"""Commands that begin a study, by name."""


def study_command(name: str, words: list[str]) -> Any:
    """The command of a name, with the options of the analysis that the call asks."""
    if name == "study":
        from petalfoil.cli.study_folder import study_commands

        return study_commands()
    declared = COMMANDS[name]
    with handled():
        analysis = analysis_of(asked_verb(words, declared.default))
    own = {**declared.options, "ask": (Ask, declared.default), **RUNNING}
    known = {names for annotation, _ in own.values() for names in annotation.__metadata__[0].param_decls or ()}
    options = [inspect.Parameter("case", KEYWORD, annotation=CASE_FILE)]
    options += [inspect.Parameter(key, KEYWORD, annotation=a, default=d) for key, (a, d) in own.items()]
    for option in argument_options(analysis):
        taken = analysis.arguments[option.name].option_name(option.name) in known or option.name in own
        if not taken and option.name not in declared.hidden:
            options.append(option)

    def ask(**given: Any) -> None:
        call(declared, analysis, given)

    return command(name, ask, options, declared.help)


def asked_verb(words: list[str], default: str) -> str:
    """The analysis that a call asks, read before its options are known."""
    for word, following in pairwise([*words, ""]):
        if word == ASK:
            return following
        if word.startswith(f"{ASK}="):
            return word.removeprefix(f"{ASK}=")
    return default


def call(declared: StudyCommand, analysis: Analysis, given: dict[str, Any]) -> None:
    """Run a study with the options of a call, and tell what came of it."""
    out, as_json = given["out"], given["as_json"]
    with handled(as_json):
        arguments = {name: given[name] for name in analysis.arguments if name in given and name not in declared.options}
        known_as = {name: argument.option_name(name) for name, argument in analysis.arguments.items()}
        required = [n for n in known_as if analysis.default(n) is inspect.Parameter.empty and arguments.get(n) is None]
        if required:
            raise UsageError(f"{known_as[required[0]]} is missing: {analysis.verb} needs it")
        question = Question.read(analysis.verb, {k: v for k, v in arguments.items() if v is not None}, known_as)
        note_bare_numbers(analysis, arguments, known_as)
        study = declared.define(Case.load(given["case"]), question, given)
        run_and_tell(study, out, given)


def run_and_tell(study: Study, out: Path, given: dict[str, Any]) -> None:
    """Run a study in its folder with a progress bar; what is finished stays when it is interrupted."""
    from petalfoil.studies.run import run_with_effort

    with executing(study.kind, given) as execution:
        try:
            ds, effort = run_with_effort(study, out, execution)
        except KeyboardInterrupt as interrupt:
            say(f"interrupted: what is finished is kept in {out}; 'petalfoil study resume {out}' goes on")
            raise typer.Exit(exit_code_of(interrupt)) from interrupt
    deliver(ds, out, as_json=given["as_json"], effort=effort)


@contextmanager
def executing(title: str, given: dict[str, Any]) -> Iterator[Execution]:
    """How the study is run, with its progress on the terminal."""
    from petalfoil.studies.run import Execution

    memory = None if given["memory"] is None else memory_of(given["memory"])
    with bar(title) as report:
        yield Execution(
            given["workers"],
            given["scheduler"],
            memory,
            given["fields"],
            given["anew"],
            given["neighbours"],
            report,
        )


def memory_of(text: str) -> float:
    """A size of memory [byte]."""
    try:
        size = parse_quantity(text, "byte")
    except UnitError as error:
        raise UsageError(f"--memory: {error}") from error
    if not size >= 2**28:
        raise UsageError(f"--memory: {shown(text)} is too little for a worker; allowed: at least 256 MiB")
    return size


def assignments(option: str, given: list[str]) -> dict[str, str]:
    """Paths and texts of ``PATH=VALUES``.

    Raises
    ------
    UsageError
        A text has no ``=``, or a path comes twice.
    """
    found: dict[str, str] = {}
    for text in given:
        path, sign, values = (part.strip() for part in text.partition("="))
        if not sign or not path or not values:
            raise UsageError(
                f"{option}: {shown(text)} is no PATH=VALUES, such as petals.thickness='0.1 mm : 0.2 mm : 5'"
            )
        if path in found:
            raise UsageError(f"{option}: {path} is given twice")
        found[path] = values
    return found
