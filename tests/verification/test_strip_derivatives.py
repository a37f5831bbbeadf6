"""Derivatives of a clamped strip under a uniform load, its tip free, on a stop, or just touching it: one-sided."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, Self

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from petalfoil.equilibrium.parameter_response import (
    Equations,
    EquationValues,
    HeldEquilibrium,
    ParameterResponse,
    parameter_response,
)
from petalfoil.equilibrium.solution import RefinedState
from petalfoil.mesh.axial import axis_2d
from petalfoil.physics.shell import PetalShell
from petalfoil.solvers.problem import Border, no_border
from tests.verification.film_helpers import table

Array = NDArray[np.float64]

LENGTH, WIDTH, MODULUS, THICKNESS, POISSON = 0.02, 1.0, 2e11, 1e-4, 0.3
TIP, STOP = 0.003235555555556, 2e-5
"""Deflection of the free tip of the table, and its stop [m]."""
RADIUS, STRAIGHT = 1e3, 1e9
"""A strip is a petal in a bore so large that it is flat, and that was made straight [m]."""
CELLS = 64


@dataclass(frozen=True)
class Strip:
    """A strip in the protocol of the coupled problem: no film, no journal, one stop outside its tip."""

    length: float = LENGTH
    modulus: float = MODULUS
    thickness: float = THICKNESS
    poisson: float = POISSON
    load: float = 0.0
    gap: float = STOP

    def __post_init__(self) -> None:
        rigidity = self.modulus * self.thickness**3 / (12.0 * (1.0 - self.poisson**2))
        phi = np.linspace(0.0, self.length / RADIUS, CELLS + 1)
        shell = PetalShell(phi, axis_2d(WIDTH), RADIUS, STRAIGHT, rigidity, self.poisson, clamped=True)
        weight = self.length / CELLS * np.append(np.ones(CELLS - 1), 0.5)
        object.__setattr__(self, "K", sp.csr_array(shell.stiffness[1:, 1:]))
        object.__setattr__(self, "force", self.load * weight)

    K: Any = None
    force: Any = None

    @property
    def G(self) -> sp.csr_array:
        return sp.csr_array(([-1.0], ([0], [CELLS - 1])), shape=(1, CELLS))

    weight = np.ones(1)
    displacement = np.zeros(0)
    elimination_key = None
    layout = SimpleNamespace(
        n_position=0, wall=SimpleNamespace(contacts=SimpleNamespace(journal=slice(0, 0), lines=()))
    )

    @property
    def border(self) -> Border:
        return no_border(1)

    def at(self, **_: object) -> Self:
        return self

    def gaps(self, x: Array) -> Array:
        return np.array([self.gap - x[-1]])

    def journal_force(self, x: Array, lam: Array) -> Array:
        return np.zeros(0)

    def contact_force(self, lam: Array) -> Array:
        return np.zeros(0)

    def linearize(self, x: Array, **_: object) -> SimpleNamespace:
        return SimpleNamespace(
            residual=self.K @ x - self.force, row_scale=np.ones(len(x)), matrix=lambda _: sp.csc_array(self.K)
        )


def unit_load() -> float:
    """The uniform load under which the free tip deflects as in the table [Pa]."""
    rigidity = MODULUS * THICKNESS**3 / (12.0 * (1.0 - POISSON**2))
    return 8.0 * rigidity * TIP / LENGTH**4


def solved(strip: Strip, *, touching: bool) -> SimpleNamespace:
    """The equilibrium with the tip free, or on its stop."""
    x = np.asarray(sp.linalg.spsolve(sp.csc_array(strip.K), strip.force))
    lam, active = np.zeros(1), np.array([touching])
    if touching:
        unit = np.asarray(sp.linalg.spsolve(sp.csc_array(strip.K), np.eye(CELLS)[-1]))
        lam[0] = (x[-1] - strip.gap) / unit[-1]
        x = x - lam[0] * unit
    return SimpleNamespace(
        problem=strip, state=RefinedState(x, np.zeros(CELLS), lam), x=x, lam=lam, active=active, load=None
    )


def response(strip: Strip, name: str, *, touching: bool, step: float = 1e-4) -> ParameterResponse:
    """How the strip follows one of its sizes: relative, the gap and Poisson's ratio absolute."""
    found, value = solved(strip, touching=touching), getattr(strip, name)
    size = 1.0 if name in ("gap", "poisson") else value
    reach = step * abs(value)
    values = [
        Equations(replace(strip, K=None, force=None, **{name: value + k * reach}), None).at_state(found)  # type: ignore[arg-type]
        for k in (-2, -1, 1, 2)
    ]
    weights = [w * size / reach for w in (1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0)]
    held = HeldEquilibrium.of(found, found.active)  # type: ignore[arg-type]
    return parameter_response(held, EquationValues.combined(values, weights), 1e-6)


COLUMNS = {
    "load": "d/dlnq",
    "length": "d/dlnl",
    "modulus": "d/dlnE",
    "thickness": "d/dlnt",
    "poisson": "d/dnu",
    "gap": "d/dg",
}
EXACT = table("r5b_strip.csv")


@pytest.mark.parametrize("name", COLUMNS)
def test_the_tip_without_a_stop(name: str) -> None:
    free = Strip(load=unit_load(), gap=1.0)
    found = response(free, name, touching=False)
    assert solved(free, touching=False).x[-1] == pytest.approx(TIP, rel=1e-3)
    assert_allclose(found.above.x[-1] / TIP, float(EXACT[0][COLUMNS[name]]) / TIP, rtol=2e-3, atol=1e-9)


@pytest.mark.parametrize("name", COLUMNS)
def test_the_reaction_of_a_stop(name: str) -> None:
    held = Strip(load=unit_load())
    exact = float(EXACT[1]["value"])
    found = solved(held, touching=True)
    scale = exact / float(
        found.lam[0]
    )  # the table's strip has another stiffness: forces are compared over the reaction
    assert_allclose(response(held, name, touching=True).above.lam[0] * scale, float(EXACT[1][COLUMNS[name]]), rtol=3e-3)


def test_a_tip_that_just_touches_has_two_derivatives() -> None:
    """A larger load presses the tip onto the stop, whose reaction grows; a smaller one lets it rise freely."""
    free = Strip(load=unit_load(), gap=1.0)
    tip = float(solved(free, touching=False).x[-1])
    touching = replace(free, K=None, force=None, gap=tip)
    found = response(touching, "load", touching=True)
    assert found.at_kink
    assert_allclose(found.below.x[-1], tip, rtol=1e-9)
    assert found.below.lam[0] == 0.0
    assert_allclose(found.above.x[-1], 0.0, atol=1e-12 * tip)
    assert_allclose(found.above.lam[0], 3.0 / 8.0 * unit_load() * LENGTH, rtol=1e-3)
