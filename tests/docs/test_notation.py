"""`docs/notation.md` against the definitions of a case and the schema of a result."""

from __future__ import annotations

import re
import typing
from dataclasses import dataclass

from pydantic import BaseModel

from petalfoil.analysis.known_verbs import find, summaries
from petalfoil.case import Case
from petalfoil.case.number_fields import Quantity
from petalfoil.results.schema import VARIABLES
from tests.docs.texts import DOCS, text


@dataclass(frozen=True)
class Row:
    """One row of the table."""

    symbol: str
    names: tuple[str, ...]
    meaning: str
    unit: str
    shape: str


def rows() -> list[Row]:
    """The rows of the one table."""
    lines = [line for line in text(DOCS / "notation.md").splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]
    return [Row(cell[0], tuple(re.findall(r"`([^`]+)`", cell[1])), *cell[2:]) for cell in cells]


def test_the_table_has_five_columns_and_no_empty_row() -> None:
    lines = [line for line in text(DOCS / "notation.md").splitlines() if line.startswith("|")]
    assert {line.count("|") for line in lines} == {6}
    assert all(row.meaning and row.unit and row.shape and (row.symbol or row.names) for row in rows())


def rows_of(name: str) -> list[Row]:
    """The rows that name `name`: there should be one."""
    return [row for row in rows() if name in row.names]


def normal(unit: str) -> str:
    """A unit in the spelling of result files: "J/(kg*K)" becomes "J kg-1 K-1", "kg/m^3" "kg m-3", no unit "–"."""
    over, _, under = unit.replace("(", "").replace(")", "").partition("/")
    below = [part.partition("^") for part in under.replace("*", " ").split()]
    parts = over.replace("*", " ").split() + [f"{name}-{power or 1}" for name, _, power in below]
    return " ".join(parts) or "–"


# ---------------------------------------------------------------------------------------------- results


def test_every_result_variable_has_one_row_with_its_unit_and_dimensions() -> None:
    assert all(find(verb) for verb in summaries())  # each declares its own results when it is loaded
    wrong = {}
    for name, variable in VARIABLES.items():
        declared = (normal(variable.units), f"({', '.join(variable.dims)})" if variable.dims else "no dimensions")
        listed = [(row.unit, row.shape if row.shape.startswith("(") else "no dimensions") for row in rows_of(name)]
        if listed != [declared]:
            wrong[name] = (listed, declared)
    assert wrong == {}


# ---------------------------------------------------------------------------------------------- cases


def case_fields() -> dict[str, set[str]]:
    """Dotted name of every field of a case, and the units declared in it."""
    found: dict[str, set[str]] = {}
    for name, info in Case.model_fields.items():
        section = sections(info.annotation)
        if section is None:
            found[name] = set()
            continue
        for field, declared in section.model_fields.items():
            found[f"{name}.{field}"] = units((declared.annotation, *declared.metadata))
    return found


def sections(annotation: object) -> type[BaseModel] | None:
    """The section that a field of a case holds, perhaps optionally."""
    for candidate in (annotation, *typing.get_args(annotation)):
        if isinstance(candidate, type) and issubclass(candidate, BaseModel):
            return candidate
    return None


def units(declared: typing.Iterable[object]) -> set[str]:
    """Units of all quantities in annotations, however deep."""
    found: set[str] = set()
    for item in declared:
        if isinstance(item, Quantity):
            found.add(normal(item.unit))
        found |= units((*typing.get_args(item), *getattr(item, "__metadata__", ())))
    return found


def test_every_case_field_has_one_row_with_its_unit() -> None:
    wrong = {}
    for name, declared in case_fields().items():
        listed = [set(row.unit.split(", ")) for row in rows_of(name)]
        allowed = [declared] if declared else [{"–"}, {"1"}]  # a number without a declared unit counts something
        if len(listed) != 1 or listed[0] not in allowed:
            wrong[name] = (listed, allowed)
    assert wrong == {}


def test_the_reader_of_cases_reads() -> None:
    fields = case_fields()
    assert fields["gas.gas_constant"] == {"J kg-1 K-1"}
    assert fields["petals.free_shape"] == {"rad", "m"}
    assert fields["operation.eccentricity"] == {"m"}
    assert fields["model.kind"] == set()


def test_every_dotted_name_of_the_table_is_a_field() -> None:
    prefixes = tuple(f"{name}." for name in Case.model_fields)
    dotted = {name for row in rows() for name in row.names if name.startswith(prefixes)}
    assert dotted - set(case_fields()) == set()
