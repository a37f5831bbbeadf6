"""Commands that pages show with what they print."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from typer.testing import CliRunner

from petalfoil.cli.app import app
from tests.docs.texts import text


def blocks(page: Path, language: str) -> list[str]:
    """Fenced blocks of a language on a page."""
    return re.findall(rf"^```{language}\n(.*?)^```", text(page), re.MULTILINE | re.DOTALL)


def shown(block: str) -> tuple[str, list[str]]:
    """The command of a console block, its continued lines joined, and the lines that it prints."""
    call, *printed = block.replace("\\\n", " ").splitlines()
    return call.removeprefix("$ "), printed


def missing(block: str) -> list[str]:
    """Lines of a console block that its command does not print, in this order; "..." stands for any others.

    Columns may be wider than on the page.
    """
    call, lines = shown(block)
    program, *arguments = shlex.split(call)
    result = CliRunner().invoke(app, arguments, prog_name=program)
    assert (result.exit_code, result.stderr) == (0, "")
    printed = iter([line.split() for line in result.stdout.splitlines()])  # an iterator keeps the order
    return [line for line in lines if line != "..." and line.split() not in printed]
