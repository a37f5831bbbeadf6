"""Shares of the time of a run: factorisations, assembly, solves, the rest. Functions are wrapped from outside."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from petalfoil.analysis import curve
from petalfoil.solvers import contact_newton
from petalfoil.solvers.constraints import ContactConstraints
from petalfoil.solvers.sparse_lu import Factor, LinearSolver
from petalfoil.system.coupled import Linearization
from petalfoil.system.foil_pack import FoilPackLinearization

Place = tuple[Any, str]

PLACES: dict[str, tuple[Place, ...]] = {
    "factorisation": ((LinearSolver, "factor"),),
    "assembly": ((Linearization, "matrix"), (FoilPackLinearization, "matrix"), (ContactConstraints, "reduce")),
    "solves": ((Factor, "solve"),),
    "stability": ((curve, "leading_eigenvalue"),),
    "contact_search": ((contact_newton, "search"),),
}
"""Functions by the name of their share. The last two contain parts of the first three."""


APART = ("factorisation", "assembly", "solves")
"""Shares that do not overlap. A solve inside a factorisation counts as factorisation."""


@dataclass
class Share:
    """Number of calls and their processor time."""

    calls: int = 0
    seconds: float = 0.0


@dataclass
class Watch:
    """Processor time since creation, and the shares of functions."""

    shares: dict[str, Share] = field(default_factory=lambda: {name: Share() for name in PLACES})
    start: float = field(default_factory=time.process_time)
    busy: bool = False

    @property
    def seconds(self) -> float:
        """The whole time [s]."""
        return time.process_time() - self.start

    def wrapped(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        """`call`, counted and timed under `name`."""
        share, apart = self.shares[name], name in APART

        def timed(*args: Any, **kwargs: Any) -> Any:
            if apart and self.busy:
                return call(*args, **kwargs)
            self.busy, start = self.busy or apart, time.process_time()
            try:
                return call(*args, **kwargs)
            finally:
                self.busy = self.busy and not apart
                share.calls += 1
                share.seconds += time.process_time() - start

        return timed


@contextmanager
def watched() -> Iterator[Watch]:
    """Measure the calls in the block."""
    watch = Watch()
    places = [(name, *place) for name, found in PLACES.items() for place in found]
    before = [getattr(owner, function) for _, owner, function in places]
    for (name, owner, function), call in zip(places, before, strict=True):
        setattr(owner, function, watch.wrapped(name, call))
    try:
        yield watch
    finally:
        for (_, owner, function), call in zip(places, before, strict=True):
            setattr(owner, function, call)
