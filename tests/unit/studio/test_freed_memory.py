"""Memory of a worker is given back where its C library can."""

from __future__ import annotations

import platform
import sys

import numpy as np
import psutil
import pytest

from petalfoil.studio import freed_memory


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="the C library keeps memory in its own way")
def test_freed_memory_below_something_in_use_is_given_back() -> None:
    """Arrays of 100 kB lie on the heap; one in a hundred stays."""
    process = psutil.Process()
    arrays = [np.ones(12_500) for _ in range(2000)]
    full, kept = process.memory_info().rss, arrays[::100]
    del arrays
    freed_memory.give_back()
    assert process.memory_info().rss < full - 150e6
    assert len(kept) == 20


def test_other_systems_are_left_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    freed_memory.trimming.cache_clear()
    assert freed_memory.trimming() is None
    freed_memory.give_back()
    freed_memory.trimming.cache_clear()
