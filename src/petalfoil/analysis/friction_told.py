"""Which friction forces between petals an equilibrium has: whether its path is followed, and what results say of it."""

from __future__ import annotations

from dataclasses import dataclass

from petalfoil.case import Case, FrictionHistory
from petalfoil.equilibrium.friction_under_load import PATH
from petalfoil.equilibrium.solution import Solution
from petalfoil.errors import UsageError
from petalfoil.walls import wall_kind
from petalfoil.walls.kind import Capability

RELAXED = "relaxed: no friction forces between the petals, as vibrations leave the pack"
RELEASED = "without friction forces at the start, those of the motion from there"
RELEASED_LOADED = "assembled, loaded at rest and run up; from there those of the motion"
ASSEMBLED = "assembled round a thinner journal that grows, then moved from point to point"
TURNED = "assembled without friction, then moved from point to point"


@dataclass(frozen=True)
class FrictionTold:
    """Path that friction forces between petals are those of, None without friction; energy lost to it [J]."""

    friction_path: str | None
    petal_friction_work: float | None = None

    @classmethod
    def under_load(cls, case: Case) -> FrictionTold:
        """Those of balances of a case, wherever they are."""
        if not rubs(case):
            return cls(None)
        return cls(PATH if follows_path(case) else RELAXED)

    @classmethod
    def of(cls, case: Case, answer: Solution) -> FrictionTold:
        """Those of an equilibrium."""
        if not rubs(case):
            return cls(None)
        if answer.friction is None:
            return cls(RELAXED)
        scales = answer.problem.layout.scales
        return cls(answer.solution_path, answer.friction.lost * scales.force * scales.length)


@dataclass(frozen=True)
class ContactsOnPath:
    """Where contacts are, and in which share of the steps of the path up to there they were points between nodes."""

    contact_model: str | None = None
    point_share: float | None = None

    @classmethod
    def of(cls, answer: Solution, point_share: float | None) -> ContactsOnPath:
        """Those of a state of a path."""
        return cls(answer.contact_model, point_share)


def rubs(case: Case) -> bool:
    """Whether petals rub on each other."""
    return case.surface.petal_friction > 0.0 and wall_kind(case).can(Capability.RUBBING)


def follows_path(case: Case, *, by_default: bool = False) -> bool:
    """Whether equilibria keep the friction forces of the path that the pack has gone."""
    asked = case.surface.friction_history
    return case.follows_friction and (by_default if asked is None else asked is FrictionHistory.ASSEMBLED)


def refuse_path(case: Case, answers: str) -> None:
    """Refuse a pack that keeps the friction forces of its path, where `answers` have none.

    Raises
    ------
    UsageError
        It does.
    """
    if case.surface.friction_history is FrictionHistory.ASSEMBLED:
        raise UsageError(
            f"{answers} of a pack without friction forces, and surface.friction_history asks for those of "
            'its assembly: set it to "relaxed", or compare two runs'
        )
