"""Tables of a case that say what bounds the film: `[petals]`, and those that are registered at run time."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import ClassVar, TypeVar

from pydantic import create_model

from petalfoil.case.definition import Definition
from petalfoil.case.problems import Problem


class WallTable(Definition):
    """Base of the tables that describe a wall."""

    solid_height: ClassVar[float | None] = None
    """Height over the bushing of a wall that has bottomed out [m]; None where it never does."""

    @property
    def travel(self) -> float:
        """How far the surface of the wall can be pressed beyond the bushing radius [m]."""
        return 0.0

    def problems(self) -> Iterable[Problem]:
        """What keeps the wall from being built that no single key shows."""
        return ()


AnyCase = TypeVar("AnyCase", bound=Definition)

_registered: dict[str, type[WallTable]] = {}


def register_table(table: type[WallTable]) -> None:
    """Let cases have the table `[section]` of `table`.

    Raises
    ------
    ValueError
        It has no name, or the name is taken.
    """
    from petalfoil.case.definitions import Case  # a case reads the tables that are registered here

    if not table.section:
        raise ValueError(f"the table {table.__name__} has no section, the name of its table in a case")
    if table.section in {*Case.model_fields, *_registered}:
        raise ValueError(f"a case has a table [{table.section}] already")
    _registered[table.section] = table


def registered_tables() -> tuple[type[WallTable], ...]:
    """All tables that were registered."""
    return tuple(_registered.values())


def unregister_table(table: type[WallTable]) -> None:
    """Forget a table that was registered."""
    del _registered[table.section]


def with_table(case: type[AnyCase], names: Iterable[str]) -> type[AnyCase]:
    """The type of case that has the registered table among `names`; `case` itself where none is."""
    wanted = [_registered[name] for name in names if name in _registered and name not in case.model_fields]
    return _extended(case, *wanted) if wanted else case


@cache
def _extended(case: type[AnyCase], *tables: type[WallTable]) -> type[AnyCase]:
    fields = {table.section: (table | None, None) for table in tables}
    return create_model(case.__name__, __base__=case, __doc__=case.__doc__, __module__=case.__module__, **fields)  # type: ignore[call-overload,no-any-return]
