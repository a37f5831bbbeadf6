"""What one page is about: its design, what is computed for it, what was tried; knows no widgets.

While a slider moves, answers follow it: a coarse 2-D one first, then one on the grid that the case asks for. A newer
change cancels the fine answer under way and lets the coarse one end, which takes a fraction of a second; so pictures
keep coming however fast the slider moves.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import deque
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from typing import Any

from petalfoil.case import Case, ModelKind
from petalfoil.errors import DefinitionError
from petalfoil.studio.design import Design
from petalfoil.studio.engine import Engine, Job, Outcome
from petalfoil.studio.protocol import Cancelled, Done, Failure, Found, Mapped, Work
from petalfoil.walls import Capability, wall_kind

FINE_CELLS = 64
"""Cells per pitch of a 2-D grid above which a coarse answer comes first: below, the answer itself is as quick."""
MOST_TRIED, MOST_LINES = 40, 200
"""Designs and lines of the log that a session remembers."""


MAP = "map"
"""Name under which the failure of a map stands among those of the analyses."""


class Aspect(Enum):
    """What of a session has changed."""

    DESIGN, PROBLEMS, STATE, STATUS, ANSWERS, TRIED, LOG = (auto() for _ in range(7))


@dataclass(frozen=True)
class Shown:
    """A result and the case that it belongs to.

    Attributes
    ----------
    found : Found
        The result.
    toml : str
        The case as it was typed.
    arguments : mapping
        Arguments of the analysis.
    is_coarse : bool
        Whether it is a first answer on a coarse 2-D grid.
    """

    found: Found
    toml: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    is_coarse: bool = False


@dataclass(frozen=True)
class Tried:
    """A design that was tried: what changed, and its main results."""

    number: int
    change: str
    design: Design
    scalars: Mapping[str, Any]
    grid: str


@dataclass
class Status:
    """What the session is doing.

    Attributes
    ----------
    words : str
        In words.
    part : float or None
        Part done (0 to 1); None where nothing runs.
    failure : str
        Why there is no answer; empty where there is one.
    """

    words: str = "starting"
    part: float | None = None
    failure: str = ""


class Session:
    """The state behind one tab of a browser.

    Parameters
    ----------
    engine : Engine
        Who computes.
    design : Design
        The case to begin with.
    """

    def __init__(self, engine: Engine, design: Design) -> None:
        self.key = secrets.token_urlsafe(16)
        self.design = design
        self.problems: dict[str, str] = {}
        self.state: Shown | None = None
        self.pinned: Shown | None = None
        self.answers: dict[str, Shown] = {}
        self.failures: dict[str, str] = {}
        self.map: Mapped | None = None
        self.tried: list[Tried] = []
        self.status = Status()
        self.log: deque[str] = deque(maxlen=MOST_LINES)
        self.is_dark = False
        self.listener: Callable[[Aspect], None] | None = None
        self._engine = engine
        self._is_due = False
        self._fine: Job | None = None
        self._question: Job | None = None
        self._live: asyncio.Task[None] | None = None
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
        self._note(words)
        self._tell(Aspect.DESIGN)
        self.refresh()

    def case(self) -> Case | None:
        """The case; None where it is refused, with `problems` by key."""
        try:
            case = self.design.case()
        except DefinitionError as error:
            self.problems = _by_key(error)
            self._tell(Aspect.PROBLEMS)
            return None
        if self.problems:
            self.problems = {}
            self._tell(Aspect.PROBLEMS)
        return case

    def refresh(self) -> None:
        """Answer the design as it is now; a fine answer under way belongs to a former one."""
        self._is_due = True
        if self._fine is not None:
            self._engine.cancel(self._fine)
        if self._live is None or self._live.done():
            self._live = asyncio.get_running_loop().create_task(self._follow())

    def pin(self) -> None:
        """Keep the present state as A, or forget A where it is the present one."""
        shown, same = self.state, self.pinned is not None and self.state is not None
        if same and self.pinned is not None and shown is not None and self.pinned.toml == shown.toml:
            self.pinned = None
        elif shown is not None:
            self.pinned = replace(shown, found=replace(shown.found, records=()))
        self._tell(Aspect.STATE)

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
            self._tell(Aspect.ANSWERS)
            return
        self._start(self._answer(verb, work=Work.ANSWER, verb=verb, arguments=dict(arguments)))

    def study(self, vary: Mapping[str, str]) -> None:
        """Map the design over one or two parameters; a question that still runs is cancelled."""
        case = self.case()
        if case is None:
            self.failures[MAP] = "the case is refused: mend the fields that are marked"
            self._tell(Aspect.ANSWERS)
            return
        self._start(self._answer(MAP, work=Work.STUDY, verb=live_verb(case), vary=dict(vary)))

    def open_place(self, place: Mapping[str, Any]) -> None:
        """Open the design at a place of the map: values by path."""
        design = self.design
        for path, value in place.items():
            design = design.with_value(path, value)
        self.open(design, "opened from the map")

    def cancel(self) -> None:
        """Stop whatever is computed for this session."""
        self._is_due = False
        self._engine.leave(self.key)
        self._say("cancelled", None)

    async def file(self, work: Work, shown: Shown) -> bytes | str:
        """A file of a result, or why there is none; a result that was slimmed down is computed again."""
        records = shown.found.records
        asked: dict[str, Any] = {"verb": shown.found.verb, "case_toml": shown.toml}
        if not records:
            again = self._engine.submit(self.key, Work.ANSWER, is_long=True, arguments=shown.arguments, **asked)
            outcome = await again.outcome
            if not isinstance(outcome, Done) or not isinstance(outcome.result, Found):
                return _words(outcome)
            records = outcome.result.records
        outcome = await self._engine.submit(self.key, work, records=records, **asked).outcome
        return outcome.result if isinstance(outcome, Done) and isinstance(outcome.result, bytes) else _words(outcome)

    # ------------------------------------------------------------------------------------------ inside

    async def _follow(self) -> None:
        """Answer the newest design until there is no newer one."""
        while self._is_due:
            self._is_due = False
            design = self.design
            case = self.case()
            if case is None:
                self._say("refused", None, failure="the case is refused: see the fields that are marked")
                continue
            verb = live_verb(case)
            if needs_coarse(case) and not await self._answer_coarse(design, verb):
                continue
            if not self._is_due:
                await self._answer_fine(design, verb)

    async def _answer_coarse(self, design: Design, verb: str) -> bool:
        """Show a coarse answer, if there is one; false where it was cancelled."""
        self._say("computing", 0.0)
        job = self._engine.submit(self.key, Work.ANSWER, verb=verb, case_toml=design.to_toml(), coarse=True)
        outcome = await job.outcome
        if isinstance(outcome, Done) and isinstance(outcome.result, Found):
            self.state = Shown(outcome.result, design.to_toml(), is_coarse=True)
            self._tell(Aspect.STATE)
        return not isinstance(outcome, Cancelled)

    async def _answer_fine(self, design: Design, verb: str) -> None:
        case, toml = design.case(), design.to_toml()
        is_long = case.model.kind is ModelKind.THREE_D
        self._say("computing", 0.0)
        self._fine = self._engine.submit(
            self.key, Work.ANSWER, is_long=is_long, on_progress=self._progress, verb=verb, case_toml=toml
        )
        self._tell_queue(self._fine)
        outcome = await self._fine.outcome
        self._fine = None
        if isinstance(outcome, Done) and isinstance(outcome.result, Found):
            self.state = Shown(outcome.result, toml)
            self._remember(design, outcome.result)
            self._tell(Aspect.STATE)
            self._say(f"converged in {outcome.result.seconds:.2g} s", None)
        elif isinstance(outcome, Failure):
            self._say("no answer", None, failure=_words(outcome))
            self.problems = {key: text for key, text in outcome.problems if key}
            self._tell(Aspect.PROBLEMS)

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
            self.key, work, is_long=True, on_progress=self._progress, case_toml=toml, **asked
        )
        self._say(f"{name}: computing", 0.0)
        self._tell_queue(job)
        outcome = await job.outcome
        if self._question is job:
            self._question = None
        if isinstance(outcome, Failure):
            self.failures[name] = _words(outcome)
            self._say(f"{name}: no answer", None)
            self._note(f"{name}: {_words(outcome)}")
        elif isinstance(outcome, Done) and not isinstance(outcome.result, bytes):
            if isinstance(outcome.result, Mapped):
                self.map = outcome.result
            else:
                self.answers[name] = Shown(outcome.result, toml, asked["arguments"])
            self._say(f"{name}: done in {outcome.result.seconds:.2g} s", None)
        self._tell(Aspect.ANSWERS)

    def _remember(self, design: Design, found: Found) -> None:
        if self.tried and self.tried[-1].design.tables == design.tables:
            return
        change = design.changes_from(self.tried[-1].design) if self.tried else "start"
        number = self.tried[-1].number + 1 if self.tried else 1
        self.tried.append(Tried(number, change, design, dict(found.scalars), found.grid))
        del self.tried[:-MOST_TRIED]
        self._note(f"{number}: {change} ({found.verb}, {found.grid}, {found.seconds:.2g} s)")
        self._tell(Aspect.TRIED)

    def _tell_queue(self, job: Job) -> None:
        ahead = self._engine.ahead_of(job)
        if ahead:
            self._say(f"waiting: {ahead} before this one", 0.0)

    def _progress(self, part: float, text: str) -> None:
        self._say(text, part)

    def _say(self, words: str, part: float | None, failure: str = "") -> None:
        if failure and failure != self.status.failure:
            self._note(failure)
        self.status = Status(words, part, failure)
        self._tell(Aspect.STATUS)

    def _note(self, line: str) -> None:
        self.log.append(f"{time.strftime('%H:%M:%S')}  {line}")
        self._tell(Aspect.LOG)

    def _tell(self, aspect: Aspect) -> None:
        if self.listener is not None:
            self.listener(aspect)


def live_verb(case: Case) -> str:
    """The analysis that answers while a slider moves: the position under the case's load, or at its displacement."""
    return "solve" if case.operation.load is None else "balance"


def needs_coarse(case: Case) -> bool:
    """Whether the case's grid is so fine that a coarse answer comes first."""
    return case.model.kind is ModelKind.THREE_D or (
        wall_kind(case).can(Capability.PACK) and case.cells_per_pitch > FINE_CELLS
    )


def _by_key(error: DefinitionError) -> dict[str, str]:
    """What is wrong by key; components of a pair belong to the pair's key."""
    found: dict[str, str] = {}
    for key, text in error.problems:
        name = key.partition("[")[0]
        found[name] = f"{found[name]}; {text}" if name in found else text
    return found


def _words(outcome: Outcome) -> str:
    """Why an outcome holds no answer."""
    if isinstance(outcome, Failure):
        text = f"{outcome.message}. {outcome.advice}" if outcome.advice else outcome.message
        return f"a fault of petalfoil, please report it: {text}" if outcome.is_fault else text
    return "cancelled" if isinstance(outcome, Cancelled) else "no answer"
