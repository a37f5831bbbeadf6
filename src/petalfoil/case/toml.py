"""TOML in and out of a case, and the files that a case is read from."""

from __future__ import annotations

import os
import stat
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from petalfoil.errors import DefinitionError

MAX_BYTES = 2**20
"""Size of the largest file that is read; a case has some kilobytes, a measured shape of 10 000 rows has 300."""

_CURES = {
    "Cannot overwrite a value": "the key of this line stands twice in its table: leave one",
    "Cannot declare": "the table stands twice: put its keys under one heading",
    "Illegal character '\\n'": "a text of this line has no closing quote",
    "Unterminated string": "a text has no closing quote",
    "Invalid value": "a value is missing, or a text has no quotes: write quantities as '25 um', with the quotes",
    "Expected newline or end of document after a statement": "quantities are texts: write '25 um', with the quotes",
}
"""Signs in errors of the TOML parser, and what to do about them."""

_AS_UTF_8 = "save it as UTF-8 (in an editor: save as, encoding UTF-8; or: iconv -f LATIN1 -t UTF-8 old > new)"

_NO_TEXT = "it is no text but a picture, a result or a program; a case is a text file in TOML"


def read_file(path: str | os.PathLike[str]) -> str:
    """Return the text of a case file or of a table beside it, or say why there is none."""
    try:
        return _read_regular(Path(path)).decode("utf-8-sig")  # editors on Windows put a mark in front
    except FileNotFoundError:
        raise DefinitionError("there is no such file") from None
    except UnicodeDecodeError as error:
        cure = _NO_TEXT if b"\0" in error.object else _AS_UTF_8
        raise DefinitionError(f"is not a text in UTF-8 ({_first_wrong(error)}): {cure}") from None
    except (OSError, ValueError) as error:  # a ValueError is a path with a null character
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise DefinitionError(f"cannot be read: {reason}") from None


def _read_regular(path: Path) -> bytes:
    """Bytes of a file of ordinary size; devices and pipes, which may never end, are not opened."""
    kind = path.stat().st_mode
    if stat.S_ISDIR(kind):
        raise DefinitionError("is a directory; expected a file")
    if not stat.S_ISREG(kind):
        raise DefinitionError("is a device, a pipe or a socket; expected a file")
    with path.open("rb") as file:
        content = file.read(MAX_BYTES + 1)
    if len(content) > MAX_BYTES:
        raise DefinitionError(f"has more than {MAX_BYTES // 2**20} MiB; expected a text of some kilobytes")
    return content


def _first_wrong(error: UnicodeDecodeError) -> str:
    line = error.object.count(b"\n", 0, error.start) + 1
    return f"line {line}, byte 0x{error.object[error.start]:02x}"


def parse(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text; what is broken is told with its line."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise DefinitionError("is not valid TOML: it is nested too deeply") from None
    except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
        raise DefinitionError(f"is not valid TOML: {error}{_cure(str(error))}") from None


def _cure(error: str) -> str:
    """What is usually behind an error of the TOML parser; nothing where that is not known."""
    return next((f"; {cure}" for sign, cure in _CURES.items() if sign in error), "")


def write(tables: Mapping[str, Any]) -> str:
    """Return the TOML text of `tables`; floats come back exactly as they were."""
    return tomli_w.dumps(tables)
