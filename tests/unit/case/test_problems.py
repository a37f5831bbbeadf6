"""A refused case tells every problem by its key, for whoever shows each beside its field."""

from __future__ import annotations

from pathlib import Path

import pytest

from petalfoil.case import Case
from petalfoil.errors import DefinitionError, UnitError
from tests.cases import EXAMPLES, case, put, tables


def test_every_problem_is_told_by_key() -> None:
    data = put(put(tables(), "petals.thickness", "1 N"), "gas.viscosty", 1.0)
    with pytest.raises(DefinitionError) as caught:
        Case(**data)
    problems = dict(caught.value.problems)
    assert set(problems) == {"petals.thickness", "gas.viscosty"}
    assert all(text in str(caught.value) for text in problems.values())


def test_one_problem_is_that_of_the_message() -> None:
    with pytest.raises(UnitError) as caught:
        case(**{"petals.thickness": "1 N"})
    ((key, text),) = caught.value.problems
    assert key == caught.value.key == "petals.thickness"
    assert str(caught.value) == f"{key}: {text}"


def test_the_problems_of_a_file_are_those_of_its_case(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text((EXAMPLES / "paper_n8.toml").read_text().replace("count = 8", "count = 1"))
    with pytest.raises(DefinitionError) as caught:
        Case.load(path)
    assert [key for key, _ in caught.value.problems] == ["petals.count"]
    assert str(path) in str(caught.value)


def test_an_error_without_a_list_has_one_problem() -> None:
    assert DefinitionError("petals: no overlap", key="petals").problems == (("petals", "no overlap"),)


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("petals.leaf_length", "1 in", "'arc_length'"),
        ("petals.number_of_leaves", 8, "'count'"),
        ("petals.mount", "cantilever", "'clamped'"),
        ("petals.chord", "1 in", "2 R asin(chord / (2 R))"),
        ("petals.preload", "1 N", "Preload follows"),
    ],
)
def test_words_of_drawings_lead_to_keys(key: str, value: object, told: str) -> None:
    with pytest.raises(DefinitionError) as caught:
        Case(**put(tables(), key, value))
    assert told in dict(caught.value.problems)[key]


def test_a_misspelt_key_that_is_needed_is_one_mistake() -> None:
    text = (EXAMPLES / "paper_n8.toml").read_text()
    with pytest.raises(DefinitionError) as error:
        Case.from_toml(text.replace("\nthickness =", "\nthicknes ="))
    assert [key for key, _ in error.value.problems] == ["petals.thicknes"]
    assert "Did you mean 'thickness'?" in str(error.value)
