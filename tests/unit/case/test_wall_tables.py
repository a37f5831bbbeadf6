"""Case tables of walls that are registered at run time."""

from __future__ import annotations

import pytest

from petalfoil.case import Case, WallTable, register_table, unregister_table
from petalfoil.errors import DefinitionError
from petalfoil.walls import WallKind, register
from tests.cases import case, tables
from tests.walls.elastic_foundation import ElasticFoundation, FoundationTable


def test_a_case_keeps_the_table_of_a_registered_wall(foundation: Case) -> None:
    assert isinstance(foundation, Case)
    assert foundation.wall == FoundationTable(stiffness="4 GPa/m")
    assert Case.from_toml(foundation.to_toml()) == foundation
    assert hash(Case.from_toml(foundation.to_toml())) == hash(foundation)


def test_dotted_changes_reach_it(foundation: Case) -> None:
    softer = foundation.replace(**{"elastic_foundation.stiffness": "2 GPa/m", "operation.speed": 100.0})
    assert softer.wall == FoundationTable(stiffness=2e9)
    plain = case("plain_journal")
    assert plain.wall is None
    assert plain.replace(elastic_foundation={"stiffness": 2e9}).wall == softer.wall


def test_its_problems_are_told_with_those_of_the_case(foundation: Case) -> None:
    data = tables("plain_journal") | {"elastic_foundation": {"stiffness": "-1 Pa/m", "stifness": 1}}
    data["bearing"]["length"] = "-1 m"
    with pytest.raises(DefinitionError) as refusal:
        Case(**data)
    text = str(refusal.value)
    assert "3 problems" in text
    assert "elastic_foundation.stiffness: '-1 Pa/m' is outside its range" in text
    assert "Did you mean 'stiffness'?" in text


def test_a_case_has_one_wall(foundation: Case) -> None:
    with pytest.raises(DefinitionError, match=r"\[petals\] and \[elastic_foundation\] both describe the wall"):
        case("paper_n8", elastic_foundation={"stiffness": 1e9})


def test_a_table_is_known_while_it_is_registered() -> None:
    class Liner(WallTable):
        section = "liner"

    data = tables("plain_journal") | {"liner": {}}
    with pytest.raises(DefinitionError, match="liner: is not a known key"):
        Case(**data)
    register_table(Liner)
    assert Case(**data).wall == Liner()
    unregister_table(Liner)
    with pytest.raises(DefinitionError, match="liner: is not a known key"):
        Case(**data)


def test_a_name_is_taken_once(foundation: Case) -> None:
    with pytest.raises(ValueError, match="already"):
        register_table(FoundationTable)

    class Second(WallTable):
        section = "petals"

    with pytest.raises(ValueError, match="already"):
        register_table(Second)


def test_a_wall_that_no_table_asks_for_is_refused() -> None:
    class Nameless(WallTable):
        """Without a section."""

    with pytest.raises(ValueError, match="no section"):
        register_table(Nameless)

    class WithoutTable(ElasticFoundation):
        table = None

    kind: WallKind = WithoutTable()
    with pytest.raises(ValueError, match="a case without one is a plain bearing"):
        register(kind)
