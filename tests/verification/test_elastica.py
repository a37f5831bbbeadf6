"""Geometric linearity: the preload of one petal between bore and journal against an elastica (`elastica.py`)."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from petalfoil.analysis.static import static
from petalfoil.case import Case
from petalfoil.errors import DefinitionError
from petalfoil.physics.petal_elements import PetalElements
from petalfoil.solvers.lcp import solve_lcp
from tests.cases import case
from tests.verification.elastica import PressedPetal

Array = NDArray[np.float64]

NODES = 128
"""Elements of the linear petal; its gaps are looked at on their nodes."""


def pressed_radius(of: Case) -> float:
    """Radius of the mid-surface of a petal on the centred journal [m]."""
    assert of.pack is not None
    return of.bearing.journal_radius + 0.5 * of.pack.thickness + of.surface.contact_film_thickness


def linear_force(of: Case, radius: float) -> float:
    """Force of the journal on one hinged petal whose free edge lies on the bore [N]."""
    assert of.pack is not None
    assert of.petals is not None
    pack, D = of.pack, of.petals.bending_stiffness
    phi = np.linspace(0.0, pack.petal_angle, NODES + 1)
    petal = PetalElements(phi, of.bearing.length, pack.metric_radius, pack.reference_radius, D, clamped=False)
    K = petal.stiffness.toarray()
    free = np.delete(np.arange(len(K)), len(K) - 2)  # the free edge lies on the bore
    inner = np.searchsorted(free, 1 + 2 * np.arange(NODES - 1))
    compliance = np.linalg.inv(K[np.ix_(free, free)])[np.ix_(inner, inner)]
    gaps = pack.free_radius(phi[1:-1]) - radius
    scale = float(np.max(compliance))
    lam = solve_lcp(compliance / scale, gaps, gaps < 0.0)
    assert lam is not None
    return float(lam.sum()) / scale


def elastica_force(of: Case, radius: float) -> float:
    """The same of an elastica of the petal's length [N]."""
    assert of.pack is not None
    assert of.petals is not None
    r_m = of.pack.metric_radius
    petal = PressedPetal(of.petals.arc_length / r_m, of.pack.bend_radius / r_m)
    return petal.normal_force(radius / r_m) * of.petals.bending_stiffness * of.bearing.length / r_m**2


@pytest.mark.slow
@pytest.mark.parametrize(("name", "elastica", "about_free"), [("paper_n8", 5.4411, 6.961), ("rig", 11.7532, 12.441)])
def test_preload_of_a_petal_against_an_elastica(name: str, elastica: float, about_free: float) -> None:
    """Linear about the bore within 1.1 %; about the free shape 28 and 6 % too much."""
    about_bore = case(name, **{"petals.linear_about": "bore"})
    radius = pressed_radius(about_bore)
    exact = elastica_force(about_bore, radius)
    assert exact == pytest.approx(elastica, rel=1e-4)
    assert linear_force(about_bore, radius) == pytest.approx(exact, rel=1.1e-2)
    assert linear_force(case(name), radius) == pytest.approx(about_free, rel=1e-3)


def test_bending_about_the_bore_is_for_petals_bent_to_an_arc() -> None:
    """Its free edge lies on the bore, and the pack is solved; a measured shape is refused."""
    of = case("paper_n8", **{"petals.linear_about": "bore", "model.cells_per_pitch": 16})
    assert of.pack is not None
    ends = of.pack.free_radius([0.0, of.pack.petal_angle])
    assert ends == pytest.approx(of.pack.metric_radius, rel=1e-12)
    (bore,), (free,) = static.records(of), static.records(of.replace(**{"petals.linear_about": "free_shape"}))
    assert bore.converged
    assert float(bore.scalars["contact_normal_force"]) < 0.95 * float(free.scalars["contact_normal_force"])
    rows = tuple((phi, 0.0259 - 0.002 * phi * (1.74 - phi)) for phi in (0.0, 0.5, 1.0, 1.75))
    with pytest.raises(DefinitionError, match=r'petals\.linear_about: .* allowed: "free_shape"'):
        of.replace(**{"petals.free_shape": rows, "petals.bend_radius": None})


def test_the_work_of_the_journal_is_the_energy_of_the_elastica() -> None:
    """Of the paper's petal on one contact, pressed by a tenth of its radius: `int N dr = int M^2 / 2D ds`."""
    petal = PressedPetal(1.7367, 1.5437)
    middle, start = petal.free()
    way, forces = np.linspace(middle, middle + 0.1, 21), [0.0]
    for here in way[1:]:
        start = petal.one_contact(here, start)
        F, a = start[2]
        forces.append(2.0 * F * np.cos(a))
    s, (_, _, angle), _ = start
    moment = np.gradient(angle, s, edge_order=2) / (0.5 * petal.length) - 1.0 / petal.bend_radius
    energy = float(np.trapezoid(moment**2, s)) * 0.5 * petal.length
    assert float(np.trapezoid(forces, way)) == pytest.approx(energy, rel=2e-3)
