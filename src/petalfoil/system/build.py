"""Case -> coupled problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, ModelKind
from petalfoil.memory import check_memory, grid_of
from petalfoil.physics.mass_balance import FilmBalance
from petalfoil.system.bearing_layout import BearingLayout
from petalfoil.system.coupled import CoupledProblem
from petalfoil.system.on_shaft import ShaftStep
from petalfoil.system.scales import Scales, scales_of
from petalfoil.system.shaft_layout import ShaftLayout
from petalfoil.walls import Wall, build_wall
from petalfoil.walls.tilting import tilting

Array = NDArray[np.float64]


def build_problem(case: Case) -> CoupledProblem:
    """Discretise `case` at its speed and eccentricity; a grid beyond the memory there is is refused first.

    A journal under a moment is free to tilt, and starts parallel to the bushing.
    """
    check_memory(case)
    if case.operation.moment is not None:
        return build_tilting(case)
    return discretised(case, build_wall(case), np.array(case.operation.eccentricity))


def on_the_same_wall(problem: CoupledProblem, case: Case) -> CoupledProblem:
    """Discretise a case on the wall of another problem.

    Parameters
    ----------
    problem : CoupledProblem
        A bearing at a position of its journal.
    case : Case
        The same bearing but for its gas, speed, load, position and the friction of its journal: what no wall reads.
    """
    return discretised(case, problem.layout.wall, np.array(case.operation.eccentricity))


def build_tilting(case: Case) -> CoupledProblem:
    """Discretise the whole length of `case` under a journal that is free to tilt, at the slopes of the case."""
    whole = case.replace(**{"model.symmetry": False, "operation.tilt": None})
    slopes = lever_of(case) * np.array(case.operation.tilt or (0.0, 0.0))
    wall = tilting(build_wall(whole), lever_of(case))
    return discretised(whole, wall, np.append(case.operation.eccentricity, slopes))


def lever_of(case: Case) -> float:
    """Lever of the slopes of a journal that tilts about the bearing's centre, half the length [m]."""
    return 0.5 * case.bearing.length


def build_pair(case: Case, supports: Sequence[Case] = ()) -> ShaftStep:
    """Both bearings of `case` on a shaft that tilts, as its rotor has them; the whole length of each.

    `supports` are the bearings by themselves where they are not those of the case, at temperatures of their own.
    """
    if case.rotor is None or case.rotor.span is None:
        raise ValueError("this rotor runs in one bearing")
    both = [one.replace(**{"model.symmetry": False}) for one in supports or case.supports]
    check_memory(max(both, key=lambda one: grid_of(one).memory), bearings=2)
    first = layout_on_shaft(both[0])
    second = first if same_wall(*both) else layout_on_shaft(both[1], first.scales)
    length, levers = first.scales.length, np.array([1.0, 1.0, case.rotor.lever, case.rotor.lever])
    arms = [arm_of(one, place) / levers for one, place in zip(both, case.rotor.places, strict=True)]
    askew = [askew_of(one) / length for one in both]
    layout = ShaftLayout((first, second), (arms[0], arms[1]), (askew[0], askew[1]))
    position = np.append(case.operation.eccentricity, np.zeros(2)) / length
    return ShaftStep(layout, first.bearing_number(case.operation.speed), position)


def layout_on_shaft(case: Case, units: Scales | None = None) -> BearingLayout:
    """The layout of a bearing on a shaft that tilts; lengths and forces in the units of another one, if given."""
    bare = case.replace(**{"operation.tilt": None})
    wall = build_wall(bare)
    wall = wall if case.model.kind is ModelKind.TWO_D else tilting(wall, lever_of(case))
    own = discretised(bare, wall, np.zeros(wall.n_position)).layout
    return own if units is None else replace(own, scales=replace(own.scales, length=units.length, force=units.force))


def arm_of(case: Case, place: float) -> Array:
    """Position of a journal `place` [m] along a shaft, slopes times the lever, by (x, y, a_x, a_y); (n_position, 4).

    A 2-D film does not feel the slopes.
    """
    one, none = np.eye(2), np.zeros((2, 2))
    own = [] if case.model.kind is ModelKind.TWO_D else [[none, lever_of(case) * one]]
    return np.block([[one, place * one], *own])


def askew_of(case: Case) -> Array:
    """Position of a journal, slopes times the lever, under a shaft at the origin: how it stands askew; [m]."""
    tilt = np.array(case.operation.tilt or (0.0, 0.0)) * lever_of(case)
    return np.zeros(2) if case.model.kind is ModelKind.TWO_D else np.concatenate([np.zeros(2), tilt])


def same_wall(one: Case, other: Case) -> bool:
    """Whether two bearings differ by how they stand askew at most."""
    straight = {"operation.tilt": None}
    return one.replace(**straight) == other.replace(**straight)


def discretised(case: Case, wall: Wall, displacement: NDArray[np.float64]) -> CoupledProblem:
    """The equations on a wall at a displacement [m]."""
    scales = scales_of(case, wall)
    balance = FilmBalance(wall.film, case.bearing.journal_radius, case.slip_length / scales.length)
    layout = BearingLayout(case, wall, balance, scales)
    return CoupledProblem(layout, layout.bearing_number(case.operation.speed), displacement / scales.length)
