"""A worker: a process that runs one task after another and ends when the server does.

A thread reads what the server sends while the main thread computes, so that a task can be cancelled on its way. The
server may be killed without a word: then the pipe of tasks ends, and the thread ends the process, if the system has not
done so before (`lifeline.py`).
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable
from queue import SimpleQueue
from typing import BinaryIO

from petalfoil.errors import ConvergenceError, DefinitionError, PetalfoilError
from petalfoil.studio.freed_memory import give_back
from petalfoil.studio.protocol import (
    Cancel,
    Cancelled,
    Done,
    Failure,
    Message,
    ProgressMessage,
    Ready,
    WorkerTask,
    read_frame,
)
from petalfoil.studio.protocol import frame as framed
from petalfoil.studio.tasks import perform, warm_up

PROGRESS_STEP = 0.01
"""Part of a task after which its progress is told again: a hundred messages a task."""


class Stop(BaseException):
    """Raised by the progress callback of a task that is cancelled; no handler of errors catches it."""


class Inbox:
    """Messages of the server, read by a thread."""

    def __init__(self, stream: BinaryIO) -> None:
        self.tasks: SimpleQueue[WorkerTask] = SimpleQueue()
        self.cancelled: set[int] = set()
        self._stream = stream
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        while True:
            try:
                message = read_frame(self._stream)
            except EOFError:
                os._exit(0)  # the server is gone, and nobody waits for the task at work
            if isinstance(message, Cancel):
                self.cancelled.add(message.number)
            elif isinstance(message, WorkerTask):
                self.tasks.put(message)


def run(inbox: Inbox, tell: Callable[[Message], None]) -> None:
    """Perform one task after another, until the process ends."""
    while True:
        task = inbox.tasks.get()
        tell(outcome(task, inbox, tell))
        inbox.cancelled.discard(task.number)
        give_back()


def outcome(task: WorkerTask, inbox: Inbox, tell: Callable[[Message], None]) -> Message:
    """Perform a task; whatever happens is told."""
    told = [-1.0]

    def progress(part: float, text: str) -> None:
        if task.number in inbox.cancelled:
            raise Stop
        if abs(part - told[0]) >= PROGRESS_STEP:
            told[0] = part
            tell(ProgressMessage(task.number, part, text))

    try:
        progress(0.0, task.verb)
        return Done(task.number, perform(task, progress))
    except Stop:
        return Cancelled(task.number)
    except DefinitionError as error:
        return Failure(task.number, str(error), problems=error.problems)
    except PetalfoilError as error:
        advice = error.advice if isinstance(error, ConvergenceError) else ""
        return Failure(task.number, str(error), advice)
    except MemoryError:
        return Failure(task.number, "the machine has too little memory for this grid", "choose a coarser grid")
    except Exception as error:  # told on the page as a fault of the program, with its traceback on standard error
        sys.excepthook(type(error), error, error.__traceback__)
        return Failure(task.number, f"{type(error).__name__}: {error}", is_fault=True)


def main() -> None:
    """Serve the process that started this one: tasks on standard input, reports on standard output."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the server's to handle
    reports = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a library prints must not stand between the frames
    lock = threading.Lock()

    def tell(message: Message) -> None:
        with lock:
            reports.write(framed(message))
            reports.flush()

    inbox = Inbox(sys.stdin.buffer)
    warm_up()
    tell(Ready())
    run(inbox, tell)
