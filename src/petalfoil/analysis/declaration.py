"""An analysis is declared once: a typed function of a case, under a decorator that says what it returns.

::

    @analysis(SinglePoint())
    def balance(case: Case, load: Load = None, speed: Speed = None, *, progress: Progress | None = None) -> Record:
        \"\"\"Find the position of the journal under a load.\"\"\"

From this follow the Python function ``petalfoil.balance``, the command ``petalfoil balance`` with its options, and all
outputs. The function gets SI numbers; who calls it may give texts with units.
"""

from __future__ import annotations

import inspect
import logging
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeAlias, get_type_hints

from petalfoil.analysis.adapted_stations import with_stations
from petalfoil.analysis.arguments import Accuracy, Argument, ErrorBars, StoredResult
from petalfoil.analysis.error_bars import WithErrorBars
from petalfoil.analysis.file_exports import TABLE, Export, Values
from petalfoil.analysis.known_verbs import register
from petalfoil.analysis.progress_bar import bar
from petalfoil.analysis.resume import asked_for, points_done
from petalfoil.analysis.runs import Points, Run, Single
from petalfoil.analysis.session import one_thread
from petalfoil.case import Case
from petalfoil.case.hints import nearest
from petalfoil.equilibrium.run_context import Progress, new_run
from petalfoil.errors import UsageError
from petalfoil.results.answer import Answer
from petalfoil.results.layout import Layout
from petalfoil.results.record import Record, warnings_of_all
from petalfoil.results.schema import declare
from petalfoil.results.variable import Variable
from petalfoil.units.reading import shown

if TYPE_CHECKING:
    import xarray as xr

QuestionFunction: TypeAlias = Callable[..., Record | Run]
LOG = logging.getLogger(__name__)
ERROR, ACCURACY = "error", "accuracy"
"""The arguments that ask for error bars, and for bars below a limit."""
HARMONICS = "harmonics"
"""The argument with the fewest harmonics of slips, of a question whose bars have a part from them."""


RESUME = StoredResult(metavar="FILE.nc", help="Go on from the points that --out wrote for the same question.")
"""Option of every series."""


@dataclass(eq=False)
class Analysis:
    """A question about a case.

    Attributes
    ----------
    question : callable
        The function that answers it, in SI numbers.
    layouts : tuple of Layout
        What it returns: a point, a series, or either.
    exports : tuple of Export
        Files for other programs.
    excludes : mapping
        Arguments that say nothing beside others, with these.
    error_bars : bool
        Whether it has the arguments `error` and `accuracy`, which add error bars from a grid study.
    """

    question: QuestionFunction
    layouts: tuple[Layout, ...]
    exports: tuple[Export, ...] = ()
    excludes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    error_bars: bool = False

    def __post_init__(self) -> None:
        """Look like the function to `help` and to editors."""
        self.__name__, self.__module__ = self.question.__name__, self.question.__module__
        self.__doc__ = f"{inspect.getdoc(self.question)}\n\n{_parameters(self)}"
        self.__signature__ = self.signature

    @property
    def verb(self) -> str:
        """Its name."""
        return self.question.__name__

    @property
    def help(self) -> str:
        """The help text: the docstring down to its first section."""
        return inspect.getdoc(self.question).partition("\n\nRaises\n")[0]  # type: ignore[union-attr]

    @property
    def summary(self) -> str:
        """The first line of the help text."""
        return self.help.partition("\n")[0]

    @cached_property
    def arguments(self) -> dict[str, Argument]:
        """The arguments by name, in order, without the case."""
        hints = {**get_type_hints(self.question, include_extras=True), ERROR: ErrorBars, ACCURACY: Accuracy}
        declared = {
            name: [part for part in getattr(hint, "__metadata__", ()) if isinstance(part, Argument)]
            for name, hint in hints.items()
        }
        return {name: declared[name][0] for name in self.signature.parameters if declared.get(name)}

    @cached_property
    def signature(self) -> inspect.Signature:
        """The signature of the function, with the arguments for error bars before the progress."""
        own = inspect.signature(self.question)
        if not self.error_bars:
            return own
        added = [
            inspect.Parameter(ERROR, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=ErrorBars),
            inspect.Parameter(ACCURACY, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Accuracy),
        ]
        given = list(own.parameters.values())
        last = [parameter for parameter in given if parameter.name == "progress"]
        return own.replace(parameters=[*(parameter for parameter in given if parameter not in last), *added, *last])

    @property
    def _tells_progress(self) -> bool:
        return "progress" in self.signature.parameters

    def default(self, name: str) -> Any:
        """Default of an argument; `inspect.Parameter.empty` where it must be given."""
        return self.signature.parameters[name].default

    def read(self, given: Values, known_as: Mapping[str, str] | None = None) -> dict[str, Any]:
        """The arguments in SI numbers; what is None is left to its default.

        Parameters
        ----------
        given : mapping
            What the caller gave, by name.
        known_as : mapping, optional
            Names of the arguments as the caller knows them.

        Raises
        ------
        UnitError, UsageError
            An argument cannot be read, is outside its range, or does not go with another.
        """
        names = known_as or {name: name for name in self.arguments}
        there = {name: value for name, value in given.items() if value is not None}
        for name, others in self.excludes.items():
            for other in others:
                if name in there and other in there:
                    raise UsageError(f"{names[name]} says nothing beside {names[other]}: leave one of them out")
        return {name: self.arguments[name].named(names[name], value) for name, value in there.items()}

    @property
    def is_series(self) -> bool:
        """Whether it may return points in order."""
        return any(layout.dimension for layout in self.layouts)

    def start(
        self, case: Case, values: Values, progress: Progress | None = None, resume: xr.Dataset | None = None
    ) -> Run:
        """Ask the question; what is checked without a run has been checked when this returns.

        Parameters
        ----------
        case : Case
            The bearing.
        values : mapping
            Arguments by name, SI.
        progress : callable, optional
            Called with the part done and a text.
        resume : xarray.Dataset, optional
            What a series wrote before it was stopped, to go on from.

        Raises
        ------
        UsageError
            What is given is no case, or the result to go on from is not one of this question.
        """
        if not isinstance(case, Case):
            raise UsageError(f"{shown(case)} is not a Case; Case.load(path) reads one from a file")
        asked = {name: value for name, value in values.items() if name not in (ERROR, ACCURACY)}
        case = with_stations(case)
        with one_thread():
            begun = self.question(case, **asked, **({"progress": progress} if self._tells_progress else {}))
        run: Run = Single(begun) if isinstance(begun, Record) else begun
        if isinstance(run, Points):
            defaults = {name: self.default(name) for name in self.arguments if name not in (ERROR, ACCURACY)}
            run.asked = asked_for(case, defaults | asked)
        if resume is not None:
            if not isinstance(run, Points) or not callable(run.source):
                raise UsageError(f"{self.verb} with these arguments is no series that could go on: leave resume out")
            run.done.extend(points_done(resume, self.layout_of(resume), self.verb, run.asked))
        accuracy = values.get(ACCURACY)
        if not values.get(ERROR, False) and accuracy is None:
            return run
        if not self._layout(run).takes_error_bars:
            raise UsageError("error bars are for points, not for a table over load and speed: ask for one of each")
        continued = [name for name, value in asked.items() if value is not None and self._continues(name)]
        if continued:
            raise UsageError(f"error bars need the whole run on every grid: leave {continued[0]} out")

        def ask(other: Case, harmonics: int | None) -> tuple[Record, ...]:
            return self._whole(other, asked if harmonics is None else {**asked, HARMONICS: harmonics})

        return WithErrorBars(run, case, ask, accuracy)

    def _continues(self, name: str) -> bool:
        """Whether an argument is a result to go on from, which has the grid that it was computed on."""
        return isinstance(self.arguments[name], StoredResult)

    def _whole(self, case: Case, values: Values) -> tuple[Record, ...]:
        """All records of a case."""
        run = self.start(case, values)
        for _ in run.advance():
            pass
        return run.records()

    def _layout(self, run: Run) -> Layout:
        kind = run.layout if isinstance(run, Points) and run.layout is not None else Layout
        fitting = (layout for layout in self.layouts if bool(layout.dimension) is run.is_series)
        return next(layout for layout in fitting if isinstance(layout, kind))

    def advance(self, run: Run, progress: Progress | None = None) -> Iterator[None]:
        """Compute on, piece by piece."""
        with one_thread():
            for part, text in new_run().during(run.advance()):
                if progress is not None:
                    progress(part, f"{self.verb}: {text}")
                yield

    def answer(self, run: Run, ended: str = "") -> Answer:
        """What a run has computed, in its layout."""
        records = run.records(ended)
        layout = self._layout(run)
        estimates = layout.estimates(records)
        return Answer(
            verb=self.verb,
            layout=layout,
            records=records,
            estimates=estimates,
            warnings=warnings_of_all(records),
            asked=run.asked if isinstance(run, Points) else "",
            interrupted=ended == "interrupted",
        )

    def layout_of(self, ds: xr.Dataset) -> Layout:
        """The layout of a stored result."""
        return next((layout for layout in self.layouts if layout.dimension in ds.dims), self.layouts[0])

    def __call__(
        self, case: Case, *given: Any, progress: Progress | None = None, resume: Any = None, **named: Any
    ) -> xr.Dataset:
        """Answer the question: SI numbers or texts with units in, labelled data out.

        Without `progress`, a terminal or a notebook shows how far a long run has come.
        """
        with bar(self.verb) if progress is None else nullcontext(progress) as report:
            run = self._begin(case, given, named, report, resume)
            for _ in self.advance(run, report):
                pass
        answer = self.answer(run)
        LOG.info("%s: %s", self.verb, answer.records[-1].scalars.get("status", "done"))
        for remark in (remark for record in answer.records for remark in record.remarks):
            warnings.warn(remark, stacklevel=2)
        return answer.to_dataset()

    def records(self, case: Case, *given: Any, progress: Progress | None = None, **named: Any) -> Iterator[Record]:
        """The records one by one, as they are computed; arguments are checked at once."""
        return self._records(self._begin(case, given, named, progress), progress)

    def record(self, case: Case, *given: Any, progress: Progress | None = None, **named: Any) -> Record:
        """The only record."""
        (record,) = self.records(case, *given, progress=progress, **named)
        return record

    def _begin(
        self, case: Case, given: tuple[Any, ...], named: Values, progress: Progress | None, resume: Any = None
    ) -> Run:
        bound = self.signature.bind(case, *given, **self._by_name(named)).arguments
        values = self.read({k: v for k, v in bound.items() if k in self.arguments})
        return self.start(case, values, progress, None if resume is None else RESUME.named("resume", resume))

    def _by_name(self, named: Values) -> Values:
        """Arguments by the names of the function, where some are given by the name of their option.

        Raises
        ------
        TypeError
            One is no argument; the message has the nearest known one.
        """
        options = {argument.option.replace("-", "_"): name for name, argument in self.arguments.items()}
        options |= {argument.also: name for name, argument in self.arguments.items()}
        known = [name for name in self.signature.parameters if name != "case"]
        values = {key if key in known else options.get(key, key): value for key, value in named.items()}
        for key in values.keys() - set(known):
            raise TypeError(f"{self.verb}() has no argument {key!r}.{nearest(key, known) or f' Known: {known}.'}")
        return values

    def _records(self, run: Run, progress: Progress | None) -> Iterator[Record]:
        given = 0
        for _ in self.advance(run, progress):
            if run.is_series:
                yield from run.records()[given:]
                given = len(run.records())
        yield from run.records()[given:]


def analysis(
    *layouts: Layout,
    exports: tuple[Export, ...] = (),
    excludes: Mapping[str, tuple[str, ...]] | None = None,
    results: Mapping[str, Variable] | None = None,
    error_bars: bool = False,
) -> Callable[[QuestionFunction], Analysis]:
    """Declare the function below as an analysis.

    Parameters
    ----------
    *layouts : Layout
        What it returns: one for a point, one for several, or both.
    exports : tuple of Export
        Files for other programs.
    excludes : mapping, optional
        Arguments that say nothing beside others, with these.
    results : mapping, optional
        Results that it introduces, by name.
    error_bars : bool
        Whether it has the arguments `error` and `accuracy`, which add error bars from a grid study.
    """

    def declared(question: QuestionFunction) -> Analysis:
        declare(results or {})
        made = Analysis(question, layouts, (TABLE, *exports), excludes or {}, error_bars)
        register(made)
        return made

    return declared


def _parameters(declared: Analysis) -> str:
    """The arguments as a section of the docstring."""
    lines = ["Parameters", "----------", "case : Case", "    The bearing."]
    for name, argument in declared.arguments.items():
        optional = "" if declared.default(name) is inspect.Parameter.empty else ", optional"
        lines += [f"{name} : {type(argument).__name__}{optional}", f"    {argument.help}"]
    lines += ["progress : callable, optional", "    Called with the part done (0 to 1) and a text."]
    if declared.is_series:
        lines += ["resume : result or its file, optional", "    Points to go on from, of the same question."]
    return "\n".join([*lines, "", "Returns", "-------", "xarray.Dataset", "    The results, in SI units."])
