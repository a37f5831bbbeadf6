"""Geometric linearity: the preload of one petal between bore and journal against an elastica (`elastica.py`)."""

from __future__ import annotations

import numpy as np
import pytest

from petalfoil.analysis.static import static
from petalfoil.errors import DefinitionError
from tests.cases import case
from tests.verification.elastica import PressedPetal, elastica_force, linear_force, pressed_radius


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
