"""``petalfoil new``: a case to begin with."""

from __future__ import annotations

from enum import StrEnum
from importlib.resources import files
from pathlib import Path
from typing import Annotated

import typer

from petalfoil.cli.failures import handled
from petalfoil.cli.streams import emit
from petalfoil.errors import UsageError


class StartingWall(StrEnum):
    """What the starting case has between journal and housing."""

    PETALS = "petals"
    BUMP_FOIL = "bump-foil"
    PLAIN = "plain"


NewCaseFile = Annotated[Path, typer.Argument(metavar="{CASE}", help="File to write; one that exists is not touched.")]
WallChoice = Annotated[StartingWall, typer.Option("--wall", help="What carries the film.")]


def new(case: NewCaseFile = Path("case.toml"), wall: WallChoice = StartingWall.PETALS) -> None:
    """Write a case to begin with: a bearing that runs, a comment beside each key.

    Change it in an editor; "petalfoil check" then tells what is wrong with it.

    Example: petalfoil new case.toml --wall bump-foil
    """
    with handled():
        write_new(case, starting_case(wall))
        emit(f"{case} is written: change what your bearing has, then petalfoil check {case} --plot check.png\n")


def starting_case(wall: StartingWall) -> str:
    """Text of the starting case."""
    name = f"{wall.value.replace('-', '_')}.toml"
    return (files("petalfoil.cli") / "starting_cases" / name).read_text(encoding="utf-8")


def write_new(path: Path, text: str) -> None:
    """Write a file that is not there yet.

    Raises
    ------
    UsageError
        It exists, or cannot be written.
    """
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise UsageError(f"{path} exists, and is not touched; name another file") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be written: {error.strerror}") from error
