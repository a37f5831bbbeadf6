"""A file is replaced whole or left alone: written under a temporary name beside its place, then renamed."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give a temporary name beside ``path``, renamed to ``path`` when the block ends without an exception.

    The temporary file is removed when the block fails; a former file at ``path`` is then untouched.

    Parameters
    ----------
    path : Path
        Where the finished file goes; a symbolic link stays, what it points to is replaced.

    Yields
    ------
    Path
        The name to write under.
    """
    target = path.resolve()  # a link stays a link: what it points to is replaced
    temporary = target.with_name(f".{target.name}.{os.getpid()}-{secrets.token_hex(4)}.part")
    try:
        yield temporary
        os.replace(temporary, target)
    finally:
        temporary.unlink(missing_ok=True)
