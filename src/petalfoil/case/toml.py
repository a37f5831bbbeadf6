"""TOML in and out of a case."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from petalfoil.errors import DefinitionError


def read_file(path: str | os.PathLike[str]) -> str:
    """Return the text of a case file, or say why there is none."""
    try:
        return Path(path).read_bytes().decode("utf-8-sig")  # editors on Windows put a mark in front
    except FileNotFoundError:
        raise DefinitionError("there is no such file") from None
    except IsADirectoryError:
        raise DefinitionError("is a directory; a case is one TOML file") from None
    except UnicodeDecodeError as error:
        raise DefinitionError(f"is not a text in UTF-8 (byte {error.start})") from None
    except (OSError, ValueError) as error:  # a ValueError is a path with a null character
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise DefinitionError(f"cannot be read: {reason}") from None


def parse(text: str) -> dict[str, Any]:
    """Return the tables of a TOML text; what is broken is told with its line."""
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise DefinitionError("is not valid TOML: it is nested too deeply") from None
    except ValueError as error:  # TOMLDecodeError, and integers of thousands of digits
        raise DefinitionError(f"is not valid TOML: {error}") from None


def write(tables: Mapping[str, Any]) -> str:
    """Return the TOML text of `tables`; floats come back exactly as they were."""
    return tomli_w.dumps(tables)
