"""Which kind of wall a case asks for, by its case table, and whether it can do what an analysis needs."""

from __future__ import annotations

from petalfoil.case import Case, WallTable, register_table, unregister_table
from petalfoil.errors import UsageError
from petalfoil.walls.base import Wall
from petalfoil.walls.bump_foil import BumpFoilWall
from petalfoil.walls.kind import Capability, WallKind
from petalfoil.walls.petals import PetalWall
from petalfoil.walls.rigid import RigidWall
from petalfoil.walls.tilting import misaligned

_KINDS: dict[type[WallTable] | None, WallKind] = {
    kind.table: kind for kind in (RigidWall(), PetalWall(), BumpFoilWall())
}


def register(kind: WallKind) -> None:
    """Make cases with the table of `kind` use it.

    Raises
    ------
    ValueError
        It has no table of its own, or the name of its table is taken.
    """
    if kind.table is None:
        raise ValueError(f"the {kind.name} wall needs a case table of its own: a case without one is a plain bearing")
    register_table(kind.table)
    _KINDS[kind.table] = kind


def unregister(kind: WallKind) -> None:
    """Forget a kind that was registered."""
    if kind.table is not None:
        unregister_table(kind.table)
    del _KINDS[kind.table]


def wall_kinds() -> tuple[WallKind, ...]:
    """All registered kinds."""
    return tuple(_KINDS.values())


def wall_kind(case: Case) -> WallKind:
    """The kind of wall that `case` describes."""
    table = case.wall
    return _KINDS[None if table is None else type(table)]


def build_wall(case: Case) -> Wall:
    """Discretise the wall of `case` on the grid it asks for, under the slopes that the journal's axis is held at."""
    wall, tilt = wall_kind(case).build(case), case.operation.tilt
    return wall if tilt is None else misaligned(wall, tilt)


def required(case: Case, capability: Capability, question: str) -> WallKind:
    """The kind of wall of `case`, if it can do what `question` needs.

    Raises
    ------
    UsageError
        It cannot; the message names the question, the wall, what it lacks, and the tables of walls that have it.
    """
    kind = wall_kind(case)
    if kind.can(capability):
        return kind
    able = [f"[{other.table.section}]" for other in wall_kinds() if other.table is not None and other.can(capability)]
    raise UsageError(
        f"{question} needs a wall that {capability.value}: the {kind.name} wall of this case does not. "
        f"Case tables of walls that do: {', '.join(able) or 'none'}"
    )
