"""The journal displaced along a direction, point by point: what `curve` and `static` share."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from petalfoil.analysis.operating_point import at
from petalfoil.case import Case
from petalfoil.errors import UsageError

CHARACTERISTIC = {
    "eccentricity_x": "e_x",
    "eccentricity_y": "e_y",
    "bearing_force": "force",
    "attitude_angle": "attitude",
    "contact_normal_force": "normal force",
    "contact_fraction": "contact\nfraction",
    "min_film_thickness": "min. film",
    "peak_pressure": "peak\npressure",
    "friction_torque": "torque",
    "starting_torque": "starting\ntorque",
    "max_bending_stress": "max. stress",
    "petal_friction_work": "friction\nwork",
}
"""Columns of a characteristic with their headings."""


def displaced(case: Case, distances: Sequence[float], direction: float, speed: float | None) -> list[Case]:
    """The case at every displacement [m] along a direction [rad], each checked.

    Raises
    ------
    UsageError
        The case gives a moment, under which the journal is free to tilt.
    """
    if case.operation.moment is not None:
        raise UsageError(
            "operation.moment is for a journal that is free to tilt, here it is held: give operation.tilt instead"
        )
    n = np.round([math.cos(direction), math.sin(direction)], 15)  # -90 deg means straight down
    return [at(case, speed, (float(e * n[0]), float(e * n[1]))) for e in distances]
