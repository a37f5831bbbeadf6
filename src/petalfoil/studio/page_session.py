"""What one page is about: its design, what is computed for it, what was tried; knows no widgets.

How answers follow the design is in `live.py`.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import deque
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import replace
from typing import Any

from petalfoil.case import Case
from petalfoil.errors import DefinitionError
from petalfoil.studio.design import Design
from petalfoil.studio.live import Live, live_verb
from petalfoil.studio.protocol import Done, Failure, FoundAnswer, Mapped, Searched, Work
from petalfoil.studio.state import Aspect, ShownResult, Status, Tried
from petalfoil.studio.worker_pool import Job, WorkerPool, words_of

MOST_TRIED, MOST_LINES = 40, 200
"""Designs and lines of the log that a session remembers."""


MAP, OPTIMUM = "map", "search"
"""Names under which the failures of studies stand among those of the analyses."""


class Session:
    """The state behind one tab of a browser.

    Parameters
    ----------
    engine : WorkerPool
        Who computes.
    design : Design
        The case to begin with.
    """

    def __init__(self, engine: WorkerPool, design: Design) -> None:
        self.key = secrets.token_urlsafe(16)
        self.design = design
        self.problems: dict[str, str] = {}
        self.state: ShownResult | None = None
        self.pinned: ShownResult | None = None
        self.answers: dict[str, ShownResult] = {}
        self.failures: dict[str, str] = {}
        self.map: Mapped | None = None
        self.optimum: Searched | None = None
        self.tried: list[Tried] = []
        self.status = Status()
        self.log: deque[str] = deque(maxlen=MOST_LINES)
        self.is_dark = False
        self.listener: Callable[[Aspect], None] | None = None
        self._engine = engine
        self._question: Job | None = None
        self._live = Live(self, engine)
        self._questions: set[asyncio.Task[None]] = set()

    # ------------------------------------------------------------------------------------------ the design

    def change(self, path: str, value: Any) -> None:
        """Give a key another value; None takes it away."""
        before = self.design.get(path)
        if before == value and type(before) is type(value):
            return
        self.design = self.design.with_value(path, value)
        self.refresh()

    def open(self, design: Design, words: str) -> None:
        """Go on with another design."""
        self.design = design
        self.note(words)
        self.tell(Aspect.DESIGN)
        self.refresh()

    def case(self) -> Case | None:
        """The case; None where it is refused, with `problems` by key."""
        try:
            case = self.design.case()
        except DefinitionError as error:
            self.problems = _by_key(error)
            self.tell(Aspect.PROBLEMS)
            return None
        if self.problems:
            self.problems = {}
            self.tell(Aspect.PROBLEMS)
        return case

    def refresh(self) -> None:
        """Answer the design as it is now; a fine answer under way belongs to a former one."""
        self._live.refresh()

    def go_on(self) -> None:
        """Answer the design unless it is answered: a page that is loaded again shows what it had."""
        if self.state is None or self.state.is_coarse or self.state.toml != self.design.to_toml():
            self.refresh()

    def pin(self) -> None:
        """Keep the present state as A, or forget A where it is the present one."""
        shown, same = self.state, self.pinned is not None and self.state is not None
        if same and self.pinned is not None and shown is not None and self.pinned.toml == shown.toml:
            self.pinned = None
        elif shown is not None:
            self.pinned = replace(shown, found=replace(shown.found, records=()))
        self.tell(Aspect.STATE)

    def go_back(self, number: int) -> None:
        """Open a design that was tried."""
        tried = next((one for one in self.tried if one.number == number), None)
        if tried is not None:
            self.open(tried.design, f"back to {number}")

    # ------------------------------------------------------------------------------------------ questions

    def ask(self, verb: str, arguments: Mapping[str, Any]) -> None:
        """Run an analysis of the design; one that still runs is cancelled."""
        if self.case() is None:
            self.failures[verb] = "the case is refused: mend the fields that are marked"
            self.tell(Aspect.ANSWERS)
            return
        self._start(self._answer(verb, work=Work.ANSWER, verb=verb, arguments=dict(arguments)))

    def study(self, vary: Mapping[str, str]) -> None:
        """Map the design over one or two parameters; a question that still runs is cancelled."""
        self._begin_study(MAP, Work.STUDY, vary=dict(vary))

    def search(self, vary: Mapping[str, str], goals: Mapping[str, Any], budget: str) -> None:
        """Look for the best design; a question that still runs is cancelled."""
        if not budget.strip().isdigit():
            self.failures[OPTIMUM] = f"designs: {budget!r} is no number of designs; write a whole number, such as 40"
            self.tell(Aspect.ANSWERS)
            return
        self._begin_study(OPTIMUM, Work.OPTIMUM, vary=dict(vary), goals={**goals, "budget": int(budget)})

    def _begin_study(self, name: str, work: Work, **asked: Any) -> None:
        case = self.case()
        if case is None:
            self.failures[name] = "the case is refused: mend the fields that are marked"
            self.tell(Aspect.ANSWERS)
            return
        self._start(self._answer(name, work=work, verb=live_verb(case), **asked))

    def open_place(self, place: Mapping[str, Any]) -> None:
        """Open the design at a place of a map or a search: values by path."""
        design = self.design
        for path, value in place.items():
            design = design.with_value(path, value)
        self.open(design, "opened from a study")

    def ask_bars(self) -> None:
        """Compute the error bars of the present state, which in 3-D takes some times as long as the state did."""
        self._live.ask_bars()

    def cancel(self) -> None:
        """Stop whatever is computed for this session."""
        self._live.forget()
        self._engine.leave(self.key)
        self.say("cancelled", None)

    async def file(self, work: Work, shown: ShownResult) -> bytes | str:
        """A file of a result, or why there is none; a result that was slimmed down is computed again."""
        records = shown.found.records
        asked: dict[str, Any] = {"verb": shown.found.verb, "case_toml": shown.toml}
        if not records:
            again = self._engine.submit(self.key, Work.ANSWER, is_long=True, arguments=shown.arguments, **asked)
            outcome = await again.outcome
            if not isinstance(outcome, Done) or not isinstance(outcome.result, FoundAnswer):
                return words_of(outcome)
            records = outcome.result.records
        outcome = await self._engine.submit(self.key, work, records=records, **asked).outcome
        return outcome.result if isinstance(outcome, Done) and isinstance(outcome.result, bytes) else words_of(outcome)

    # ------------------------------------------------------------------------------------------ inside

    def _start(self, answer: Coroutine[Any, Any, None]) -> None:
        """Begin a question; one that still runs is cancelled."""
        if self._question is not None:
            self._engine.cancel(self._question)
        task = asyncio.get_running_loop().create_task(answer)
        self._questions.add(task)
        task.add_done_callback(self._questions.discard)

    async def _answer(self, name: str, *, work: Work, **asked: Any) -> None:
        toml = self.design.to_toml()
        self.failures.pop(name, None)
        self._question = job = self._engine.submit(
            self.key, work, is_long=True, on_progress=self.progress, case_toml=toml, **asked
        )
        self.say(f"{name}: computing", 0.0)
        self.tell_queue(job)
        outcome = await job.outcome
        if self._question is job:
            self._question = None
        if isinstance(outcome, Failure):
            self.failures[name] = words_of(outcome)
            self.say(f"{name}: no answer", None)
            self.note(f"{name}: {words_of(outcome)}")
        elif isinstance(outcome, Done) and not isinstance(outcome.result, bytes):
            if isinstance(outcome.result, Mapped):
                self.map = outcome.result
            elif isinstance(outcome.result, Searched):
                self.optimum = outcome.result
            else:
                self.answers[name] = ShownResult(outcome.result, toml, asked["arguments"])
            self.say(f"{name}: done in {outcome.result.seconds:.2g} s", None)
        self.tell(Aspect.ANSWERS)

    def remember(self, design: Design, found: FoundAnswer) -> None:
        """Add a design and its results to those that were tried."""
        if self.tried and self.tried[-1].design.tables == design.tables:
            return
        change = design.changes_from(self.tried[-1].design) if self.tried else "start"
        number = self.tried[-1].number + 1 if self.tried else 1
        self.tried.append(Tried(number, change, design, dict(found.scalars), found.grid))
        del self.tried[:-MOST_TRIED]
        self.note(f"{number}: {change} ({found.verb}, {found.grid}, {found.seconds:.2g} s)")
        self.tell(Aspect.TRIED)

    def tell_queue(self, job: Job) -> None:
        """Tell how many runs are before one."""
        ahead = self._engine.ahead_of(job)
        if ahead:
            self.say(f"waiting: {ahead} before this one", 0.0)

    def progress(self, part: float, text: str) -> None:
        """Tell how far a run is."""
        self.say(text, part)

    def say(self, words: str, part: float | None, failure: str = "") -> None:
        """Tell what is under way: in words, the part done, and why there is no answer."""
        if failure and failure != self.status.failure:
            self.note(failure)
        self.status = Status(words, part, failure)
        self.tell(Aspect.STATUS)

    def note(self, line: str) -> None:
        """Add a line to the log."""
        self.log.append(f"{time.strftime('%H:%M:%S')}  {line}")
        self.tell(Aspect.LOG)

    def tell(self, aspect: Aspect) -> None:
        """Tell the page what has changed."""
        if self.listener is not None:
            self.listener(aspect)


def _by_key(error: DefinitionError) -> dict[str, str]:
    """What is wrong by key; components of a pair belong to the pair's key."""
    found: dict[str, str] = {}
    for key, text in error.problems:
        name = key.partition("[")[0]
        found[name] = f"{found[name]}; {text}" if name in found else text
    return found
