"""A bump foil: springs side by side under a smooth top foil, which may bend around the shaft.

    k_b W + D_t W'''' / R_B^4 = p - p_a       at rest                                       (B4)
    k_b (1 + i gamma) W + ...                 in a whirl of any frequency                   (B5)

`k_b` is pressure over deflection, `gamma` the structural loss factor.
"""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from petalfoil.case import BumpFoil, Case, Feet, Springs
from petalfoil.mesh.strips import FilmMesh
from petalfoil.physics.bump_strip import BumpStrip
from petalfoil.physics.forces import node_area
from petalfoil.walls.base import Wall
from petalfoil.walls.elasticity import Elasticity
from petalfoil.walls.kind import Capability, Fields, Scalars, WallKind
from petalfoil.walls.rigid import RigidWall

Array = NDArray[np.float64]


def bump_foil_of(case: Case) -> BumpFoil:
    """The bump foil of a case that has one."""
    if case.bump_foil is None:
        raise ValueError("this case has no [bump_foil]")
    return case.bump_foil


def foundation_stiffness(springs: Springs) -> float:
    """Pressure over deflection, `k_b`: as given, or that of a bump over its pitch [Pa/m]."""
    if springs.foundation_stiffness is not None:
        return springs.foundation_stiffness
    pitch, half_length, thickness = springs.bump_pitch, springs.bump_half_length, springs.thickness
    assert pitch is not None  # a case refuses a strip that is not whole
    assert half_length is not None
    assert thickness is not None
    rigidity = springs.rigidity(thickness)
    if springs.bump_half_angle is None:
        return 6.0 * rigidity / (half_length**3 * pitch)
    bump = BumpStrip(half_length, springs.bump_half_angle, thickness, rigidity)
    return (bump.held_stiffness() if springs.feet is Feet.HELD else bump.free_stiffness) / pitch


class BumpFoilWall(WallKind):
    """The wall of a case with [bump_foil]."""

    name: ClassVar[str] = "bump foil"
    table: ClassVar[type[BumpFoil]] = BumpFoil
    capabilities: ClassVar[frozenset[Capability]] = frozenset({Capability.LIFT_OFF})

    def build(self, case: Case) -> Wall:
        """The film of a plain bore, a spring under each of its nodes; the top foil has its seam at the angle 0."""
        bore, foil = RigidWall().build(case), bump_foil_of(case)
        area = np.broadcast_to(node_area(bore.film, case.bearing.journal_radius), bore.film.shape)
        n = area.size
        springs = sp.diags_array(foundation_stiffness(foil) * area.ravel())
        return replace(
            bore,
            elasticity=elasticity(case, springs, bore.film),
            film_unknown=np.arange(n).reshape(area.shape),
            load_area=area,
            contacts=replace(bore.contacts, G=sp.csr_array(sp.eye_array(n))),
            free_motions=sp.csr_array((n, 0)),
            support=sp.csr_array((0, n)),
            slip=sp.csr_array((0, n)),
            loss=sp.csr_array(foil.loss_factor * springs) if foil.loss_factor else None,
        )

    def pitch(self, case: Case) -> float | None:
        """The whole circle where a top foil that bends has its seam [rad]."""
        return 2.0 * np.pi if bump_foil_of(case).top_foil_thickness else None

    def loses_energy(self, case: Case) -> bool:
        """By its loss factor."""
        return bump_foil_of(case).loss_factor > 0.0

    def scalars(self, fields: Fields) -> Scalars:
        """Largest deflection."""
        return {"max_deflection": float(np.max(fields["deflection"]))}

    def check_scalars(self, case: Case) -> Scalars:
        """Stiffness of the foil."""
        return {"foundation_stiffness": foundation_stiffness(bump_foil_of(case))}


def elasticity(case: Case, springs: sp.dia_array, film: FilmMesh) -> Elasticity:
    """Springs under the nodes of the film, and the bending around the shaft of a top foil on them (B4).

    Its ends at the seam are free.

    Parameters
    ----------
    case : Case
        The bearing.
    springs : (n, n) sparse
        Their stiffness [N/m].
    film : FilmMesh
        The film: one strip round the bore, in equal cells.
    """
    foil, n = bump_foil_of(case), springs.shape[0]
    every = sp.csr_array(sp.eye_array(n))
    if not foil.top_foil_thickness:
        return Elasticity(every, every, sp.csr_array(springs))
    _, around, along = film.shape
    arc, station = case.bearing.bushing_radius * float(np.diff(film.phi)[0]), sp.eye_array(along)
    rise = sp.kron(difference(around), station, format="csr")
    curvature = sp.kron(difference(around - 1) / arc**2, station, format="csr")
    bending = foil.rigidity(foil.top_foil_thickness) * arc * np.tile(film.axial.load_weight, around - 2)
    return Elasticity(
        sp.csr_array(sp.vstack([every, rise])),
        sp.csr_array(sp.block_diag([every, curvature])),
        sp.csr_array(sp.block_diag([springs, sp.diags_array(bending)])),
    )


def difference(n: int) -> sp.csr_array:
    """Differences of `n` neighbours, (n - 1, n)."""
    return sp.csr_array(sp.diags_array([-np.ones(n - 1), np.ones(n - 1)], offsets=[0, 1], shape=(n - 1, n)))
