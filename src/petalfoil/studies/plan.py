"""Which cases a study has: a grid over levels, or a sample of intervals; known before anything runs."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from petalfoil.errors import UsageError
from petalfoil.studies.variation import Levels, Number, Variation
from petalfoil.units.reading import shown

MAX_CASES = 1_000_000
"""Cases of a study: more are a typing mistake."""
SAMPLES = ("lhs", "sobol", "halton", "random")

Point = dict[str, Number]
"""Values by path, SI."""


@dataclass(frozen=True)
class Plan:
    """The cases of a study in order.

    Attributes
    ----------
    variations : tuple of Variation
        What varies.
    points : sequence of Point
        Values of each case by path.
    shape : tuple of int
        Numbers of levels, whose product is the number of cases; empty of a sample.
    """

    variations: tuple[Variation, ...]
    points: Sequence[Point]
    shape: tuple[int, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters in a dataset."""
        return names_of(self.variations)

    @property
    def dims(self) -> tuple[str, ...]:
        """Dimensions of a dataset: the parameters of a grid, ``case`` of a sample."""
        return self.names if self.shape else ("case",)


class LevelGrid(Sequence[Point]):
    """All combinations of levels; the last parameter runs fastest."""

    def __init__(self, levels: Sequence[Levels]) -> None:
        self._paths = [level.path for level in levels]
        self._values = [level.values for level in levels]
        self._shape = tuple(map(len, self._values))

    def __len__(self) -> int:
        return int(np.prod(self._shape, dtype=np.int64))

    def __getitem__(self, number: Any) -> Any:
        if isinstance(number, slice):
            return [self[k] for k in range(*number.indices(len(self)))]
        places = np.unravel_index(range(len(self))[number], self._shape)
        return {path: values[k] for path, values, k in zip(self._paths, self._values, places, strict=True)}

    def __iter__(self) -> Iterator[Point]:
        for values in itertools.product(*self._values):
            yield dict(zip(self._paths, values, strict=True))


def grid(levels: Sequence[Variation]) -> Plan:
    """All combinations of the levels.

    Raises
    ------
    UsageError
        A parameter has an interval instead of levels, or there are too many combinations.
    """
    for level in levels:
        if not isinstance(level, Levels):
            raise UsageError(f"{level.path}: an interval is for samples; write start : stop : count, or add --sample")
    chosen = [level for level in levels if isinstance(level, Levels)]
    refuse_repeated(chosen)
    points = LevelGrid(chosen)
    refuse_too_many(len(points))
    return Plan(tuple(chosen), points, tuple(len(level.values) for level in chosen))


def sample(variations: Sequence[Variation], text: str) -> Plan:
    """A sample of the parameters' distributions, such as ``"lhs 200"`` or ``"sobol 256, seed 3"``.

    Raises
    ------
    UsageError
        The text has another form.
    """
    kind, count, seed = read_sample(text)
    refuse_repeated(variations)
    return Plan(tuple(variations), points_at(variations, unit_sample(kind, count, len(variations), seed)))


def read_sample(text: str) -> tuple[str, int, int]:
    """Kind, size and seed of a sample."""
    form = re.fullmatch(r"\s*([a-z]+)\s+([0-9]{1,7})(?:\s*,\s*seed\s+([0-9]{1,9}))?\s*", text.lower())
    if form is None or form[1] not in SAMPLES or int(form[2]) < 1:
        raise UsageError(
            f"{shown(text)} is no sample; write one of {', '.join(SAMPLES)} and a number, such as 'lhs 200' or "
            "'sobol 256, seed 1'"
        )
    refuse_too_many(int(form[2]))
    return form[1], int(form[2]), int(form[3] or 0)


def unit_sample(kind: str, count: int, dimensions: int, seed: int) -> NDArray[np.float64]:
    """Points in the unit cube, shape (count, dimensions)."""
    from scipy.stats import qmc

    rng = np.random.default_rng(seed)
    if kind == "random":
        return rng.random((count, dimensions))
    if kind == "sobol":  # the balance of a Sobol' sequence holds for powers of two: the rest is cut off
        whole = qmc.Sobol(dimensions, rng=rng).random_base2(max(count - 1, 0).bit_length())
        return np.asarray(whole[:count], dtype=np.float64)
    sampler = qmc.LatinHypercube(dimensions, rng=rng) if kind == "lhs" else qmc.Halton(dimensions, rng=rng)
    return np.asarray(sampler.random(count), dtype=np.float64)


def points_at(variations: Sequence[Variation], unit: NDArray[np.float64]) -> list[Point]:
    """Points of a sample from those in the unit cube."""
    columns = [variation.at(unit[:, number]) for number, variation in enumerate(variations)]
    paths = [variation.path for variation in variations]
    return [dict(zip(paths, values, strict=True)) for values in zip(*columns, strict=True)]


def names_of(variations: Sequence[Variation]) -> tuple[str, ...]:
    """Names in a dataset; those of two tables that are alike get the name of their table in front."""
    short = [variation.name for variation in variations]
    whole = [re.sub(r"\W+", "_", variation.path).strip("_") for variation in variations]
    return tuple(w if short.count(s) > 1 else s for s, w in zip(short, whole, strict=True))


def refuse_repeated(variations: Sequence[Variation]) -> None:
    """Refuse a study that varies nothing, or one parameter twice."""
    paths = [variation.path for variation in variations]
    if not paths:
        raise UsageError(
            "nothing varies: give at least one parameter, such as petals.thickness = '0.1 mm : 0.2 mm : 5'"
        )
    for path in paths:
        if paths.count(path) > 1:
            raise UsageError(f"{path} is varied twice: leave one of them out")


def refuse_too_many(count: int) -> None:
    """Refuse what is no study any more."""
    if count > MAX_CASES:
        raise UsageError(f"{count} cases are more than {MAX_CASES}: fewer levels, or a sample")
