"""The protocol of a kind of wall: what it has and can do. A new kind is one class and one call of `register`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from enum import Enum
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from petalfoil.case import Case, WallTable
from petalfoil.walls.base import Wall, WallState, axial_grid
from petalfoil.walls.element_pack import ElementPack

Array = NDArray[np.float64]
Fields = dict[str, Array]
Scalars = dict[str, float | int | bool | str]


class Capability(Enum):
    """What an analysis may need of a wall; the value completes "a wall that ..."."""

    PACK = "has a pack on the journal at zero speed"
    LIFT_OFF = "rests on the journal at zero speed and lifts off at speed"
    SEVERAL_EQUILIBRIA = "can have several equilibria at one journal position"
    RUBBING = "has petals that rub on each other and on the bushing"


class WallKind(ABC):
    """One kind of wall. The defaults are those of a simple wall: a film over nodes that may deflect.

    Fields, coordinates and scalars go into results: their names are declared in `results.schema`. Fields on the wall
    have the dimensions (petal, phi, z) over the whole length.
    """

    name: ClassVar[str]
    """Name in messages, as "the <name> wall"."""
    table: ClassVar[type[WallTable] | None] = None
    """Definition of the case table that asks for this wall; None for the wall of a case without one."""
    capabilities: ClassVar[frozenset[Capability]] = frozenset()
    """What it can do beyond bounding a film."""
    has_stress: ClassVar[bool] = False
    """Whether `scalars` has a `max_bending_stress`."""

    @abstractmethod
    def build(self, case: Case) -> Wall:
        """Discretise the wall of `case` on the grid it asks for."""

    def elements(self, case: Case, wall: Wall) -> ElementPack | None:
        """The same wall with continuous slopes, where the kind has it: contacts then are points between nodes."""
        return None

    def can(self, capability: Capability) -> bool:
        """Whether the wall has the capability."""
        return capability in self.capabilities

    def fields(self, case: Case, wall: Wall, state: WallState) -> Fields:
        """Fields of an answer beside pressure and film thickness: deflection and contact pressure if the wall moves."""
        if not wall.n_unknown:
            return {}
        whole, touching = wall.film.axial.whole, state.contact_pressure[wall.contacts.journal]
        fields = {"deflection": whole(np.append(state.deflection, 0.0)[wall.film_unknown])}
        if len(touching):
            fields["journal_contact_pressure"] = whole(touching.reshape(wall.film.shape))
        return fields

    def over_whole_length(self, case: Case, deflection: Array) -> Array:
        """Deflections (n,) on half of a length, `case`, mirrored over the whole; stations are in the last place."""
        axial = axial_grid(case)
        return axial.whole(deflection.reshape(-1, len(axial.z))).ravel()

    def interpolates(self, case: Case) -> bool:
        """Whether deflections on one grid are known on another by `interpolated`."""
        return False

    def interpolated(self, case: Case, to: Case, deflection: Array) -> Array:
        """Deflections (n,) on the grid of `case` at the unknowns of `to`, which only differs in cells per pitch.

        Raises
        ------
        ValueError
            The wall does not interpolate.
        """
        raise ValueError(f"the {self.name} wall does not interpolate from grid to grid")

    def prolonged(self, case: Case, to: Case, deflection: Array) -> Array:
        """Deflections (n,) on the grid of `case` in 3-D at the unknowns of `to`, which only differs in its grid.

        Raises
        ------
        ValueError
            The wall has none on other grids.
        """
        raise ValueError(f"the {self.name} wall is not carried over to other grids")

    def pitch(self, case: Case) -> float | None:
        """Angle by which the wall repeats round the shaft [rad]; None where it is the same all round."""
        return None

    def loses_energy(self, case: Case) -> bool:
        """Whether its stiffness has an imaginary part, whatever the frequency (B5)."""
        return False

    def coordinates(self, case: Case, wall: Wall) -> Fields:
        """Coordinates of these fields beside the film's: `phi` [rad] if the wall moves."""
        return {"phi": wall.film.phi} if wall.n_unknown else {}

    def cross_section(self, case: Case, deflection: Array) -> Fields:
        """Free and deformed radius of a wall that is drawn; nothing for a simple wall.

        From its deflections (n,) [m], or those of many states (..., n).
        """
        return {}

    def scalars(self, fields: Fields) -> Scalars:
        """Scalars of an answer that follow from its fields."""
        return {}

    def geometry(self, case: Case) -> Scalars:
        """Sizes of the wall that every result states."""
        return {}

    def check_scalars(self, case: Case) -> Scalars:
        """What `check` derives from the case without a run."""
        return {}
