"""Which wall a case asks for. A new kind is one new file with `build(case)`, and one line here."""

from __future__ import annotations

from collections.abc import Callable

from petalfoil.case import Case
from petalfoil.walls import petals, rigid
from petalfoil.walls.base import Wall

WALLS: dict[str, Callable[[Case], Wall]] = {"petals": petals.build, "rigid": rigid.build}


def wall_name(case: Case) -> str:
    """ModelKind of wall that `case` describes."""
    return "rigid" if case.petals is None else "petals"


def build_wall(case: Case) -> Wall:
    """Discretise the wall of `case` on the grid it asks for."""
    return WALLS[wall_name(case)](case)
