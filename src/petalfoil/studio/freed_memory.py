"""Memory that a worker has freed, given back to the operating system.

glibc keeps what is freed below something that is in use, and some arrays of each task are: a worker grew to several
times of what it needs. Other C libraries are left as they are.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache


def give_back() -> None:
    """Give back what the allocator keeps without need; nothing where the C library has no call for it."""
    trim = trimming()
    if trim is not None:
        trim(ctypes.c_size_t(0))


@cache
def trimming() -> ctypes._NamedFuncPointer | None:
    """`malloc_trim` of glibc (malloc_trim(3)); None elsewhere."""
    if sys.platform != "linux":
        return None
    return getattr(ctypes.CDLL(None), "malloc_trim", None)
