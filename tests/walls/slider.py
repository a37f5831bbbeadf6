"""A taper slider as a wall: one strip `0 <= X <= 1` with ambient edges under the film `H = a - (a - 1) X`."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, ClassVar

import numpy as np

from petalfoil.case import Case, WallTable
from petalfoil.case.number_fields import Quantity
from petalfoil.mesh.strips import FilmMesh, pressure_numbers
from petalfoil.physics.contact import bore_contacts
from petalfoil.walls import Wall, WallKind
from petalfoil.walls.rigid import RigidWall


class SliderTable(WallTable):
    """Films of a slider whose length is the journal's radius."""

    section: ClassVar[str] = "slider"

    film_ratio: Annotated[float, Quantity(unit="1", meaning="inlet over outlet film", symbol="a", above=0.0)]
    outlet_film: Annotated[float, Quantity(unit="m", meaning="outlet film thickness", symbol="h_2", above=0.0)]


class Slider(WallKind):
    """The wall of a case with [slider]."""

    name: ClassVar[str] = "slider"
    table: ClassVar[type[SliderTable]] = SliderTable

    def build(self, case: Case) -> Wall:
        """A rigid wall over one strip of the length of the journal's radius."""
        bore, table = RigidWall().build(case), case.wall
        assert isinstance(table, SliderTable)
        X = np.linspace(0.0, 1.0, case.cells_per_pitch + 1)
        film = FilmMesh(
            X, X[None, :], bore.film.axial, pressure_numbers((1, len(X), 1), bore.film.axial, continuous=False)
        )
        rest = table.outlet_film * (table.film_ratio - (table.film_ratio - 1.0) * X)
        area = np.full(len(X), case.bearing.journal_radius * case.bearing.length / (len(X) - 1))
        floor = float(rest.min()) - case.surface.contact_film_thickness
        return replace(
            bore,
            film=film,
            rest_film=rest[None, :, None],
            reference_film=table.outlet_film,
            contacts=bore_contacts(X, floor, area),
        )
