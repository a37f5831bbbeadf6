"""Derivatives of a clamped strip under a uniform load: tip free, on a stop, just touching, or lying on a flat wall."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, ClassVar, Self

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
CELLS, FINE = 64, 512
"""Cells of a strip whose tip is on a stop, and of one that lies on a flat wall from a place between nodes on."""


@dataclass(frozen=True)
class Strip:
    """A strip in the protocol of the coupled problem: no film, no journal, one stop outside its tip."""

    cells: ClassVar[int] = CELLS

    length: float = LENGTH
    modulus: float = MODULUS
    thickness: float = THICKNESS
    poisson: float = POISSON
    load: float = 0.0
    gap: float = STOP

    def __post_init__(self) -> None:
        rigidity = self.modulus * self.thickness**3 / (12.0 * (1.0 - self.poisson**2))
        phi = np.linspace(0.0, self.length / RADIUS, self.cells + 1)
        shell = PetalShell(phi, axis_2d(WIDTH), RADIUS, STRAIGHT, rigidity, self.poisson, clamped=True)
        weight = self.length / self.cells * np.append(np.ones(self.cells - 1), 0.5)
        object.__setattr__(self, "K", sp.csr_array(shell.stiffness[1:, 1:]))
        object.__setattr__(self, "force", self.load * weight)

    K: Any = None
    force: Any = None

    @property
    def nodes(self) -> Array:
        """Places of the unknowns [m]."""
        return self.length * np.arange(1, self.cells + 1) / self.cells

    @property
    def G(self) -> sp.csr_array:
        return sp.csr_array(([-1.0], ([0], [self.cells - 1])), shape=(1, self.cells))

    @property
    def acting(self) -> sp.csr_array:
        return self.G

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


# ---------------------------------------------------------------------------------------------- on a flat wall


@dataclass(frozen=True)
class Flat(Strip):
    """The same over a flat wall: it lies on the wall from some place on."""

    cells: ClassVar[int] = FINE
    weight = np.ones(FINE)

    @property
    def G(self) -> sp.csr_array:
        return sp.csr_array(-sp.eye_array(FINE))

    @property
    def border(self) -> Border:
        return no_border(FINE)

    def gaps(self, x: Array) -> Array:
        return self.gap - x


def lying(strip: Flat) -> SimpleNamespace:
    """The equilibrium on the wall: nodes are added and released until none pulls and none is beyond the wall."""
    K, active = sp.csc_array(strip.K), strip.nodes > 0.5 * strip.length
    for _ in range(FINE):
        x, free = np.full(FINE, strip.gap), ~active
        x[free] = sp.linalg.spsolve(K[free][:, free], strip.force[free] - K[free][:, active] @ x[active])
        lam = np.where(active, strip.force - K @ x, 0.0)
        renewed = np.where(active, lam > 0.0, x > strip.gap)
        if (renewed == active).all():
            return SimpleNamespace(
                problem=strip, state=RefinedState(x, np.zeros(FINE), lam), x=x, lam=lam, active=active, load=None
            )
        active = renewed
    raise AssertionError("the contact set did not settle")


def line_reaction(strip: Flat, lam: Array) -> float:
    """Reaction of the line where the contact begins [N/m].

    Behind the line at `a` the wall carries the load `q`. Force and moment of all reactions about the root leave `R` and
    `a`: `F = R + q (l - a)`, `M = R a + q (l^2 - a^2) / 2`. Nodes cannot tell them apart by themselves.
    """
    q, length = strip.load, strip.length
    force, moment = float(lam.sum()), float(lam @ strip.nodes)
    root = q * length - force
    a = (root + np.sqrt(root**2 - 2.0 * q * (0.5 * q * length**2 - moment))) / q
    return force - q * (length - a)


@pytest.mark.parametrize("name", COLUMNS)
def test_the_line_where_a_contact_begins(name: str) -> None:
    """Its place moves between nodes, and the contacts that are held at nodes do not: they tell how force and moment
    change all the same, to first order in the cells of the free span (118 of them)."""
    strip, exact = Flat(load=unit_load(), gap=1e-6), float(EXACT[2]["value"])
    found, value = lying(strip), getattr(strip, name)
    own = line_reaction(strip, found.lam)
    place = (72.0 * strip.gap / (8.0 * TIP)) ** 0.25 * strip.length
    assert_allclose(own, strip.load * place / 3.0, rtol=1e-4)
    size, reach = 1.0 if name in ("gap", "poisson") else value, 1e-3 * abs(value)
    there = {k: replace(strip, K=None, force=None, **{name: value + k * reach}) for k in (-2, -1, 1, 2)}
    values = [Equations(at, None).at_state(found) for at in there.values()]  # type: ignore[arg-type]
    weights = [w / reach for w in (1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0)]
    held = HeldEquilibrium.of(found, found.active)  # type: ignore[arg-type]
    rate = held.respond(EquationValues.combined(values, weights))
    ends = [line_reaction(there[side], found.lam + side * reach * rate.lam) for side in (-1, 1)]
    derivative = (ends[1] - ends[0]) / (2.0 * reach) * size / own
    scale = 1.0 if name != "gap" else 1.0 / strip.gap
    assert_allclose(derivative, float(EXACT[2][COLUMNS[name]]) / exact, rtol=0.0, atol=0.008 * scale)
