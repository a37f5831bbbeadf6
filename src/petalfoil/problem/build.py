"""Case -> coupled problem."""

from __future__ import annotations

import numpy as np

from petalfoil.case import Case
from petalfoil.physics.balance import FilmBalance
from petalfoil.problem.coupled import CoupledProblem, Layout
from petalfoil.problem.scales import scales_of
from petalfoil.structure import build_wall


def build_problem(case: Case) -> CoupledProblem:
    """Discretise `case` at its speed and eccentricity."""
    wall = build_wall(case)
    scales = scales_of(case, wall)
    radius, speed = case.bearing.journal_radius, case.operation.speed
    knudsen = case.slip_length / scales.length
    return CoupledProblem(
        layout=Layout(wall, FilmBalance(wall.film, radius, knudsen), scales),
        bearing_number=scales.bearing_number(case.gas.viscosity, speed, radius),
        displacement=np.array(case.operation.eccentricity) / scales.length,
    )
