"""The two doors to the outside: the answer to standard output, everything else to standard error.

What is said of a run may quote titles, keys and file names of strangers: control characters are shown by their codes.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from io import TextIOWrapper, UnsupportedOperation
from typing import TextIO

from petalfoil.errors import StoreError
from petalfoil.text import for_terminal


def emit(text: str) -> None:
    """Write a piece of the answer, and at once: a reader that went away is noticed here, not when Python ends.

    Raises
    ------
    BrokenPipeError
        The reader went away.
    StoreError
        Standard output takes nothing, for want of space, say.
    """
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        silence(sys.stdout)
        raise StoreError(f"cannot write to standard output: {error.strerror}") from error


def say(text: str) -> None:
    """Write one line about the run to standard error; to a terminal that is gone, nothing.

    Raises
    ------
    BrokenPipeError
        The reader went away.
    """
    try:
        sys.stderr.write(for_terminal(text) + "\n")
        sys.stderr.flush()
    except BrokenPipeError:
        raise
    except OSError:  # the terminal was closed: nobody reads any more, and files are still to be written
        silence(sys.stderr)


def be_verbose(wanted: bool) -> None:
    """Let every step of the solvers be told on standard error, by the standard library's logging."""
    if wanted:
        import logging

        logging.basicConfig(stream=sys.stderr, format="%(asctime)s %(message)s", datefmt="%H:%M:%S")
        logging.getLogger("petalfoil").setLevel(logging.DEBUG)


def accept_any_text() -> None:
    """Let a terminal that knows no Greek show a question mark instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def silence(*streams: TextIO) -> None:
    """Send what streams still hold nowhere, so that Python's last flush does not fail and complain."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in streams:
        with suppress(UnsupportedOperation):  # streams of a test have no number
            os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
