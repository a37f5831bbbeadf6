"""What bounds the film in a drawn section: springs behind petals, a foil without load, a journal that stays round."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.lines import Line2D

import petalfoil
from petalfoil import plot
from petalfoil.plot.stretch import round_scale
from tests.cases import case


def lines(name: str, gid: str) -> list[Line2D]:
    """Lines of the section of `check` that are marked so."""
    figure = plot.summary(petalfoil.check(case(name, **{"model.cells_per_pitch": 16, "model.axial_cells": 4})))
    found = [line for line in figure.axes[0].lines if line.get_gid() == gid]
    plt.close(figure)
    return found


def test_springs_are_drawn_behind_every_petal_from_their_start_on() -> None:
    """Crowns 300 um inside the bushing, ten times as far in the drawing; feet on the bushing."""
    springs = lines("backed_petals", "backing")
    assert len(springs) == 8
    radius = np.hypot(*springs[0].get_xydata().T)
    assert radius.max() == pytest.approx(26e-3, rel=1e-6)
    assert radius.min() == pytest.approx(26e-3 - 10 * 300e-6, rel=1e-3)
    angle = np.arctan2(*springs[0].get_xydata().T[::-1])
    assert (angle.min(), angle.max()) == pytest.approx((6.0 / 26.0, np.pi / 4.0), rel=1e-6)


def test_a_foil_without_load_is_a_circle_on_its_bumps() -> None:
    (foil,), (bumps,) = lines("bump_foil", "top foil"), lines("bump_foil", "bumps")
    assert np.hypot(*foil.get_xydata().T) == pytest.approx(25.025e-3)
    assert np.hypot(*bumps.get_xydata().T).min() == pytest.approx(25.025e-3, rel=1e-6)


def test_the_scale_leaves_a_displaced_journal_round() -> None:
    assert round_scale(25.025e-3, 25e-3) == 500.0
    assert round_scale(25.025e-3, 25e-3, 10e-6) == 200.0
    assert round_scale(26e-3, 25e-3, 100e-6) == 10.0
