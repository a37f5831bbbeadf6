"""Exit codes, and what a user reads when something goes wrong: a message and advice, never a traceback."""

from __future__ import annotations

import json
import platform
import sys
import tempfile
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

import typer

from petalfoil import __version__
from petalfoil.cli.signals import exit_code_of, stopping_in_order
from petalfoil.cli.streams import emit, say, silence
from petalfoil.errors import ConvergenceError, DefinitionError, PetalfoilError

FAULT = 1
NOT_CONVERGED = 3
READER_GONE = 141  # 128 + SIGPIPE


@contextmanager
def handled(as_json: bool = False) -> Iterator[None]:
    """Turn every way a verb can fail into words on standard error and an exit code.

    Parameters
    ----------
    as_json : bool
        Give the error of a run that did not converge also as one JSON object on standard output.

    Raises
    ------
    typer.Exit
        With the exit code.
    """
    try:
        try:
            with stopping_in_order():
                yield
        except PetalfoilError as error:
            _explain(error, as_json)
            raise typer.Exit(error.exit_code) from error
        except KeyboardInterrupt as interrupt:
            say("interrupted: nothing was finished")
            raise typer.Exit(exit_code_of(interrupt)) from interrupt
        except (typer.Exit, BrokenPipeError):
            raise
        except Exception as error:
            _report_fault(error)
            raise typer.Exit(FAULT) from error
    except BrokenPipeError as error:  # the inner handlers write, too
        silence(sys.stdout, sys.stderr)
        raise typer.Exit(READER_GONE) from error


def _explain(error: PetalfoilError, as_json: bool) -> None:
    is_list = isinstance(error, DefinitionError)  # several problems, a line each; what they quote is on one line
    for line in f"Error: {error}".split("\n") if is_list else [f"Error: {error}"]:
        say(line)
    if not isinstance(error, ConvergenceError):
        return
    if error.advice:
        say(f"Advice: {error.advice}")
    if as_json:
        last = error.history[-1] if error.history else {}
        status = str(last.get("status", "not converged"))
        failure = {"error": str(error), "advice": error.advice, "status": status, "converged": False}
        emit(json.dumps(failure) + "\n")


def _report_fault(error: Exception) -> None:
    what = " ".join(f"{type(error).__name__}: {error}".split())
    try:
        with tempfile.NamedTemporaryFile("w", prefix="petalfoil-", suffix=".log", delete=False) as log:
            log.write(f"petalfoil {__version__}, Python {platform.python_version()}, {platform.platform()}\n")
            log.write(f"arguments: {sys.argv[1:]}\n\n")
            traceback.print_exception(error, file=log)
        where = f"the details are in {log.name}"
    except OSError as refusal:
        where = f"no log could be written ({refusal})"
    say(f"Internal error, please report it: {what}; {where}")
