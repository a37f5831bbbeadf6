"""A rigid bore: the film closes on itself all round. The limit that everything is checked against."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import scipy.sparse as sp

from petalfoil.case import Case
from petalfoil.mesh.strips import whole_circle
from petalfoil.physics.contact import bore_contacts
from petalfoil.walls.base import Wall, axial_grid
from petalfoil.walls.elasticity import no_elasticity
from petalfoil.walls.kind import WallKind


class RigidWall(WallKind):
    """The wall of a case without a wall table: a plain journal bearing."""

    name: ClassVar[str] = "rigid"

    def build(self, case: Case) -> Wall:
        """Discretise the plain bore of `case`."""
        axial = axial_grid(case)
        film = whole_circle(case.cells_per_pitch, axial)
        clearance, radius = case.bearing.clearance, case.bearing.journal_radius
        theta = np.broadcast_to(film.theta[:, :, None], film.shape)
        area = np.broadcast_to(radius * film.arc_weight[:, None] * axial.weight, film.shape)
        return Wall(
            film=film,
            elasticity=no_elasticity(),
            film_unknown=np.full(film.shape, -1),
            load_area=np.zeros(film.shape),
            rest_film=np.full(film.shape, clearance),
            contacts=bore_contacts(theta.ravel(), clearance - case.surface.contact_film_thickness, area.ravel()),
            node_area=radius * float(np.diff(film.phi)[0]) * float(axial.weight.max()),
            reference_film=clearance,
            free_motions=sp.csr_array((0, 0)),
            support=sp.csr_array((0, 0)),
            slip=sp.csr_array((0, 0)),
            reaction_share=sp.csr_array((0, theta.size)),
        )
