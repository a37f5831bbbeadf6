"""3-D states whose gaps are given, for tests of what is concluded from gaps along contact lines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from petalfoil.equilibrium.line_contacts import LineContacts
from petalfoil.physics.line_points import LinePoints
from petalfoil.system.build import build_problem
from tests.cases import case

LINE = 2
"""The line of the first kind along which gaps are given."""


def without_contacts() -> LineContacts:
    """A state of eight petals without contacts."""
    grid = {"model.cells_per_pitch": 12, "model.axial_cells": 4, "model.axial_density": "uniform"}
    problem = build_problem(case("paper_n8_spatial", **grid))
    contacts = problem.layout.wall.contacts
    none = np.zeros(0, dtype=np.intp)
    points = LinePoints(contacts.lines, len(contacts.rest), none, none, np.zeros(0))
    held = np.zeros(len(contacts.rest), dtype=np.bool_)
    return LineContacts(problem, np.ones(problem.layout.unknowns.n), points, np.zeros(0), held, np.zeros(0), load=None)


def give_gaps(state: LineContacts, along: NDArray[np.float64]) -> None:
    """Let the gaps of a state be those `along` the line (node,), and open elsewhere."""
    gaps = np.ones(len(state.held))
    gaps[state.points.lines[0].number[LINE]] = along
    vars(state)["gaps"] = gaps
