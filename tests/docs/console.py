"""Commands that pages show with what they print."""

from __future__ import annotations

import re
import shlex
from decimal import Decimal
from pathlib import Path

from typer.testing import CliRunner

from petalfoil.cli.app import app
from tests.docs.texts import text

NUMBER = re.compile(r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def blocks(page: Path, language: str) -> list[str]:
    """Fenced blocks of a language on a page."""
    return re.findall(rf"^```{language}\n(.*?)^```", text(page), re.MULTILINE | re.DOTALL)


def shown(block: str) -> tuple[str, list[str]]:
    """The command of a console block, its continued lines joined, and the lines that it prints."""
    call, *printed = block.replace("\\\n", " ").splitlines()
    return call.removeprefix("$ "), printed


def missing(block: str) -> list[str]:
    """Lines of a console block that its command does not print, in this order; "..." stands for any others.

    Columns may be wider than on the page, and a number may differ by one in its last digit: that is rounding, which
    another machine does otherwise.
    """
    call, lines = shown(block)
    program, *arguments = shlex.split(call)
    result = CliRunner().invoke(app, arguments, prog_name=program)
    assert (result.exit_code, result.stderr) == (0, "")
    printed = iter(result.stdout.splitlines())  # an iterator keeps the order
    return [line for line in lines if line != "..." and not any(alike(line, other) for other in printed)]


def alike(line: str, other: str) -> bool:
    """Whether two lines have the same words, numbers but for one in the last digit."""
    pairs = zip(line.split(), other.split(), strict=False)
    return len(line.split()) == len(other.split()) and all(one == two or near(one, two) for one, two in pairs)


def near(one: str, other: str) -> bool:
    """Whether two words are numbers of equal digits that differ by at most one in the last."""
    if not (NUMBER.fullmatch(one) and NUMBER.fullmatch(other)):
        return False
    first, second = Decimal(one), Decimal(other)
    unit = Decimal(1).scaleb(int(first.as_tuple().exponent))
    return first.as_tuple().exponent == second.as_tuple().exponent and abs(first - second) <= unit
