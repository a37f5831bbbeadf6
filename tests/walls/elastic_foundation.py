"""A bore lined with independent springs: `H = 1 + eps cos(theta) + alpha (P - 1)` with `alpha = p_a / (k c)`."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np
import scipy.sparse as sp

from petalfoil.case import Case, WallTable
from petalfoil.case.number_fields import Quantity
from petalfoil.physics.forces import node_area
from petalfoil.walls import Wall, WallKind
from petalfoil.walls.elasticity import Elasticity
from petalfoil.walls.rigid import RigidWall


class FoundationTable(WallTable):
    """Independent springs between film and bushing."""

    section: ClassVar[str] = "elastic_foundation"

    stiffness: Annotated[float, Quantity(unit="Pa/m", meaning="foundation stiffness", symbol="k", above=0.0)]


class ElasticFoundation(WallKind):
    """The wall of a case with [elastic_foundation]."""

    name: ClassVar[str] = "elastic foundation"
    table: ClassVar[type[FoundationTable]] = FoundationTable

    def build(self, case: Case) -> Wall:
        """The film of a plain bore, a spring under each of its nodes."""
        bore, table = RigidWall().build(case), case.wall
        assert isinstance(table, FoundationTable)
        area = np.broadcast_to(node_area(bore.film, case.bearing.journal_radius), bore.film.shape)
        n = area.size
        every = sp.csr_array(sp.eye_array(n))
        return replace(
            bore,
            elasticity=Elasticity(every, every, sp.csr_array(sp.diags_array(table.stiffness * area.ravel()))),
            film_unknown=np.arange(n).reshape(area.shape),
            load_area=area,
            contacts=replace(bore.contacts, G=every),
            free_motions=sp.csr_array((n, 0)),
            support=sp.csr_array((0, n)),
            slip=sp.csr_array((0, n)),
        )
