"""What callers may give for an argument: numbers or text, and a typed refusal of everything else."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from petalfoil.analysis import known_verbs
from petalfoil.analysis.declaration import Analysis
from petalfoil.analysis.liftoff import own_load
from petalfoil.errors import PetalfoilError, UnitError, UsageError
from tests.cases import case

ODD: list[Any] = [
    *("abc", "", "1 m, 2", "0 : 1", "1 : 2 : 1000000000", "1e400"),
    *([], {}, [1, "x"], [[1]], [object()], ((0,),), (0, 1, 2), [(0, "x")]),
    *(object(), float("nan"), float("inf"), b"x", 1 + 2j, {1, 2}, np.datetime64("2020")),
    *(np.array([1.0, np.nan]), np.array("x"), np.array(np.nan)),
]
ARGUMENTS = [
    (verb, name) for verb in known_verbs.summaries() for name in known_verbs.find(verb).arguments if name != "restart"
]


def refusal_of(declared: Analysis, name: str, value: Any) -> PetalfoilError | None:
    """The typed refusal of a value; None where it is read."""
    try:
        declared.read({name: value})
    except PetalfoilError as refusal:
        return refusal
    return None


@pytest.mark.parametrize(("verb", "name"), ARGUMENTS)
def test_odd_values_are_read_or_refused_by_name(verb: str, name: str) -> None:
    declared = known_verbs.find(verb)
    assert declared is not None
    refusals = [str(refusal) for value in ODD if (refusal := refusal_of(declared, name, value)) is not None]
    assert refusals
    assert all(refusal.startswith(name) for refusal in refusals)


@pytest.mark.parametrize(("verb", "name"), [("converge", "levels"), ("runup", "points"), ("orbit", "revolutions")])
def test_text_that_is_no_number_is_refused_where_a_number_is_meant(verb: str, name: str) -> None:
    declared = known_verbs.find(verb)
    assert declared is not None
    with pytest.raises((UsageError, UnitError), match=f"{name}: 'many'"):
        declared.read({name: "many"})


def test_an_array_without_dimensions_is_no_list() -> None:
    declared = known_verbs.find("liftoff")
    assert declared is not None
    with pytest.raises(UnitError, match="loads"):
        declared.read({"loads": np.array(3.0)})
    assert declared.read({"loads": np.float64(3.0)}) == {"loads": [3.0]}


def test_a_lift_off_takes_the_load_of_the_case() -> None:
    assert own_load(case(**{"operation.load": (0.0, -15.0)})) == 15.0


@pytest.mark.parametrize("load", [None, (1.0, -15.0), (0.0, 15.0), (0.0, 0.0)])
def test_a_lift_off_needs_a_load_along_its_line(load: tuple[float, float] | None) -> None:
    changes = {} if load is None else {"operation.load": load}
    with pytest.raises(UsageError, match=r"operation\.load"):
        own_load(case(**changes))
