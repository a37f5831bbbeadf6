"""How answers follow a design that changes: a coarse 2-D one first, then one on the grid that the case asks for.

A newer change cancels the fine answer under way and lets the coarse one end, which takes a fraction of a second; so
pictures keep coming however fast the slider moves. Once a 2-D design rests, its error bars are computed too.
"""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from petalfoil.analysis.declaration import ERROR
from petalfoil.case import Case, Method, ModelKind
from petalfoil.studio.protocol import Cancelled, Done, Failure, FoundAnswer, Work
from petalfoil.studio.state import Aspect, ShownResult
from petalfoil.studio.worker_pool import Job, WorkerPool, words_of
from petalfoil.walls import Capability, wall_kind

if TYPE_CHECKING:
    from petalfoil.studio.design import Design
    from petalfoil.studio.page_session import Session

FINE_CELLS = 64
"""Cells per pitch of a 2-D grid above which a coarse answer comes first: below, the answer itself is as quick."""
BARS_AFTER = 1.0
"""Time without a change after which the error bars of a 2-D answer are computed [s]: a hand may rest on the slider."""


class Live:
    """The answers that follow the design of a session.

    Parameters
    ----------
    session : Session
        Whose design is followed, and who is told.
    engine : WorkerPool
        Who computes.
    """

    def __init__(self, session: Session, engine: WorkerPool) -> None:
        self._session, self._engine = session, engine
        self._is_due = False
        self._change = asyncio.Event()
        self._fine: Job | None = None
        self._task: asyncio.Task[None] | None = None

    def refresh(self) -> None:
        """Answer the design as it is now; a fine answer under way belongs to a former one."""
        self._is_due = True
        self._change.set()
        if self._fine is not None:
            self._engine.cancel(self._fine)
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._follow())

    def forget(self) -> None:
        """Ask nothing more until the next change."""
        self._is_due = False
        self._change.set()

    def ask_bars(self) -> None:
        """Compute the error bars of the present state, unless an answer is under way."""
        shown = self._session.state
        if shown is not None and (self._task is None or self._task.done()):
            self._task = asyncio.get_running_loop().create_task(self._add_bars(shown))

    # ------------------------------------------------------------------------------------------ inside

    async def _follow(self) -> None:
        """Answer the newest design until there is no newer one."""
        while self._is_due:
            self._is_due = False
            design = self._session.design
            case = self._session.case()
            if case is None:
                self._session.say("refused", None, failure="the case is refused: see the fields that are marked")
                continue
            verb = live_verb(case)
            if needs_coarse(case) and not await self._answer_coarse(design, verb):
                continue
            shown = None if self._is_due else await self._answer_fine(design, verb)
            is_quick = case.model.kind is ModelKind.TWO_D and case.model.method is Method.NEWTON
            if shown is not None and is_quick and await self._rests():
                await self._add_bars(shown)

    async def _rests(self) -> bool:
        """Whether nothing changes for a while."""
        self._change.clear()
        try:
            await asyncio.wait_for(self._change.wait(), BARS_AFTER)
        except TimeoutError:
            return self._session.listener is not None
        return False

    async def _answer_coarse(self, design: Design, verb: str) -> bool:
        """Show a coarse answer, if there is one; false where it was cancelled."""
        self._session.say("computing", 0.0)
        job = self._engine.submit(self._session.key, Work.ANSWER, verb=verb, case_toml=design.to_toml(), coarse=True)
        outcome = await job.outcome
        if isinstance(outcome, Done) and isinstance(outcome.result, FoundAnswer):
            self._session.state = ShownResult(outcome.result, design.to_toml(), is_coarse=True)
            self._session.tell(Aspect.STATE)
        return not isinstance(outcome, Cancelled)

    async def _answer_fine(self, design: Design, verb: str) -> ShownResult | None:
        """Show the answer on the case's own grid; None where there is none."""
        case, toml = design.case(), design.to_toml()
        is_long = case.model.kind is ModelKind.THREE_D
        self._session.say("computing", 0.0)
        asked: dict[str, Any] = {"verb": verb, "case_toml": toml, "on_progress": self._session.progress}
        self._fine = self._engine.submit(self._session.key, Work.ANSWER, is_long=is_long, **asked)
        self._session.tell_queue(self._fine)
        outcome = await self._fine.outcome
        self._fine = None
        if isinstance(outcome, Done) and isinstance(outcome.result, FoundAnswer):
            self._session.state = ShownResult(outcome.result, toml)
            self._session.remember(design, outcome.result)
            self._session.tell(Aspect.STATE)
            self._session.say(f"converged in {outcome.result.seconds:.2g} s", None)
            return self._session.state
        if isinstance(outcome, Failure):
            self._session.say("no answer", None, failure=words_of(outcome))
            self._session.problems = {key: text for key, text in outcome.problems if key}
            self._session.tell(Aspect.PROBLEMS)
        return None

    async def _add_bars(self, shown: ShownResult) -> None:
        """Compute the answer with error bars, and show it where nothing newer is."""
        before = self._session.status
        asked: dict[str, Any] = {"verb": shown.found.verb, "case_toml": shown.toml}
        self._fine = self._engine.submit(self._session.key, Work.ANSWER, is_long=True, arguments={ERROR: True}, **asked)
        self._session.say(f"{before.words}, error bars follow", 0.0)
        outcome = await self._fine.outcome
        self._fine = None
        if isinstance(outcome, Done) and isinstance(outcome.result, FoundAnswer) and self._session.state is shown:
            self._session.state = replace(shown, found=outcome.result, arguments={ERROR: True})
            self._session.tell(Aspect.STATE)
            self._session.say(f"{before.words}, with error bars in {outcome.result.seconds:.2g} s", None)
        elif isinstance(outcome, Failure):
            self._session.say(f"{before.words}, no error bars", None)
            self._session.note(f"error bars: {words_of(outcome)}")
        elif self._session.status.part is not None:  # given up, by a change or because the page was left
            self._session.say(before.words, None)


def live_verb(case: Case) -> str:
    """The analysis that answers while a slider moves: the position under the case's load, or at its displacement."""
    return "solve" if case.operation.load is None else "balance"


def needs_coarse(case: Case) -> bool:
    """Whether the case's grid is so fine that a coarse answer comes first."""
    return case.model.kind is ModelKind.THREE_D or (
        wall_kind(case).can(Capability.PACK) and case.cells_per_pitch > FINE_CELLS
    )
