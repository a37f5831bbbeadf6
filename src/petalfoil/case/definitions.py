"""A case: everything that is asked of petalfoil, frozen and validated."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self

from pydantic import Field, model_validator

from petalfoil.case import toml
from petalfoil.case.bump_foil_table import Backing, BumpFoil
from petalfoil.case.definition import Definition
from petalfoil.case.gas import Gas
from petalfoil.case.growth import Bushing, Growth, Shaft
from petalfoil.case.heat_table import Heat
from petalfoil.case.pack_geometry import (
    PackGeometry,
    pack_of,
    packs_of,
    solid_height,
)
from petalfoil.case.petal_table import Petals, PetalTheory
from petalfoil.case.rotor import Rotor
from petalfoil.case.sections import (
    ADAPTED,
    Bearing,
    ContactDiscretization,
    JournalRubbing,
    Method,
    Model,
    ModelKind,
    Operation,
    Surface,
)
from petalfoil.case.wall_tables import WallTable, with_table
from petalfoil.case.whole_case import refuse_unsolvable
from petalfoil.errors import DefinitionError
from petalfoil.text import for_terminal

# Grids whose error in the bearing force stays under 1 %: measured on the paper's foil packs (six to ten petals,
# displaced by 0 to 280 um: at most 0.3 % in 2-D and in 3-D) and on plain bearings (L/D 1/2 to 2).
DEFAULT_CELLS = {ModelKind.TWO_D: 128, ModelKind.THREE_D: 64}  # along a pitch
DEFAULT_AXIAL_CELLS = 24
ADAPTED_FROM = 8
"""Cells over the length from which stations are adapted: fewer do not resolve where the solution bends."""
DEFAULT_PLAIN_CELLS = 128  # a plain bearing's pitch is the whole circle
DEFAULT_PLAIN_AXIAL_CELLS = 32
DEFAULT_BUMP_AXIAL_CELLS = 64  # over a foil the pressure stays high up to its ends
DEFAULT_PLAIN_GRADING = 0.6
"""The pressure in a plain bearing is steepest at its ends; petals bend as much elsewhere (docs/decisions/014)."""


class Case(Definition):
    """One bearing, its gas, what its journal does, and how it is modelled.

    All numbers are floats in SI units; a quantity may be given as a text with a unit, such as ``"25 um"``. Without
    `petals`, or another table that describes a wall, the case is a plain rigid journal bearing.

    Raises
    ------
    DefinitionError
        Unknown or missing keys, wrong types or units, values outside their range: all problems in one message.
    PackError
        The petals do not overlap, do not fit, or have no free shape.
    """

    title: str = Field(default="", max_length=500)
    """Title of the case, shown above tables and in figures; at most 500 characters."""
    bearing: Bearing
    shaft: Shaft | None = None
    bushing: Bushing | None = None
    petals: Petals | None = None
    backing: Backing | None = None
    bump_foil: BumpFoil | None = None
    gas: Gas
    heat: Heat | None = None
    surface: Surface = Field(default_factory=Surface)
    operation: Operation
    rotor: Rotor | None = None
    model: Model

    def __new__(cls, **data: Any) -> Self:
        """Add a field for the table of a registered wall, if `data` has one."""
        return super().__new__(with_table(cls, data))

    # ------------------------------------------------------------------------------------------ in and out

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read a case from a TOML file; the name of a CSV file in it counts from the folder of the case."""
        try:
            return cls(**_from_folder(toml.parse(toml.read_file(path)), Path(path).parent))
        except DefinitionError as error:
            message = f"{for_terminal(str(path))}: {error}"
            given, allowed, problems = error.given, error.allowed, error.problems
            raise type(error)(message, key=error.key, given=given, allowed=allowed, problems=problems) from None

    @classmethod
    def tables_of_file(cls, path: str | os.PathLike[str]) -> dict[str, Any]:
        """The tables of a case file as they are written; a measured shape in a file of its own as rows."""
        petals = cls.load(path).petals
        tables = toml.parse(toml.read_file(path))
        if petals is not None and petals.free_shape is not None:
            tables["petals"]["free_shape"] = [list(row) for row in petals.free_shape]
        return tables

    @classmethod
    def from_toml(cls, text: str) -> Self:
        """Read a case from a TOML text."""
        return cls(**toml.parse(text))

    def to_toml(self) -> str:
        """Write the case as a TOML text in SI units, from which `from_toml` makes an equal case."""
        return toml.write(self.model_dump(mode="json", exclude_none=True))

    def replace(self, **changes: object) -> Self:
        """Return a validated variant.

        Parameters
        ----------
        **changes
            New values by dotted path, as in ``case.replace(**{"operation.speed": "60000 rpm", "petals.count": 10})``;
            a name without a dot replaces a whole section.
        """
        data: dict[str, Any] = {name: getattr(self, name) for name in type(self).model_fields}
        for path, value in changes.items():
            section, dot, field = path.partition(".")
            data[section] = {**_entries(data.get(section)), field: value} if dot else value
        return type(self)(**data)

    def _repr_html_(self) -> str:
        from petalfoil.case.keys import as_html  # keys are read from this class

        return as_html(self)

    # ------------------------------------------------------------------------------------------ derived

    @property
    def walls(self) -> list[WallTable]:
        """Tables given that describe a wall: at most one in a valid case."""
        sections = [getattr(self, name) for name in type(self).model_fields]
        return [section for section in sections if isinstance(section, WallTable)]

    @property
    def wall(self) -> WallTable | None:
        """Table of the wall that bounds the film, such as `petals`; None for a plain bearing."""
        return next(iter(self.walls), None)

    @property
    def pack(self) -> PackGeometry | None:
        """Geometry of the assembled petals; None for a plain bearing."""
        return None if self.petals is None else pack_of(self.bearing, self.petals)

    @property
    def side_length(self) -> float | None:
        """Length sqrt(R_m delta) over which a petal's bow at its free side dies out [m]; None for a plain bearing."""
        if self.petals is None or self.pack is None:
            return None
        return math.sqrt(self.pack.metric_radius * self.petals.mean.thickness)

    @property
    def packs(self) -> tuple[PackGeometry, ...]:
        """The same as seen by each petal, where they are unequal; none for a plain bearing."""
        return () if self.petals is None else packs_of(self.bearing, self.petals)

    @property
    def petal_theory(self) -> PetalTheory:
        """Whether petals slide along themselves and stretch, the default filled in.

        By default they do wherever that changes anything and is modelled: in 3-D, and in 2-D with friction.
        """
        if self.petals is not None and self.petals.theory is not None:
            return self.petals.theory
        rubs = self.surface.petal_friction > 0.0 or self.drags_petals
        matters = self.model.kind is ModelKind.THREE_D or rubs
        is_modelled = self.backing is None and self.model.method is Method.NEWTON
        return PetalTheory.SHELL if matters and is_modelled else PetalTheory.INEXTENSIBLE

    @property
    def rubbing_pulls(self) -> bool:
        """Whether the turning journal pulls at what it touches, and is held back (D6), (D7)."""
        return self.surface.journal_rubbing is JournalRubbing.FORCE

    @property
    def drags_petals(self) -> bool:
        """Whether what it pulls at are petals."""
        return self.rubbing_pulls and self.petals is not None

    @property
    def follows_friction(self) -> bool:
        """Whether equilibria can keep the friction forces of the path that the pack has gone (M6)."""
        slides = self.surface.petal_friction > 0.0 and self.petal_theory is PetalTheory.SHELL
        return slides and self.petals is not None and self.heat is None and self.shares_evenly

    @property
    def growth(self) -> Growth:
        """How shaft and bushing have grown (G5); nothing without their tables."""
        return Growth.of(self.shaft, self.bushing, (self.bearing.journal_radius, self.bearing.bushing_radius))

    def growth_at(self, shaft: float, bushing: float) -> Growth:
        """Growth with the mean temperatures of shaft and bushing [K] in place of those of the case."""
        journal = None if self.shaft is None else self.shaft.model_copy(update={"temperature": shaft})
        bore = None if self.bushing is None else self.bushing.model_copy(update={"temperature": bushing})
        return Growth.of(journal, bore, (self.bearing.journal_radius, self.bearing.bushing_radius))

    @property
    def grown_bearing(self) -> Bearing:
        """The bearing with the clearance that growth leaves at the case's speed, all of it given to the journal."""
        radius = self.bearing.journal_radius + self.growth.closing(self.operation.speed)
        return self.bearing.model_copy(update={"journal_radius": radius})

    @property
    def radial_clearance(self) -> float:
        """Radial clearance of journal and bushing as grown where it is narrowest, ``R_B − R_j − |e|`` [m]."""
        return self.grown_bearing.clearance - self.operation.farthest(self.bearing.length)

    @property
    def symmetric(self) -> bool:
        """Whether half the length is solved: not where the axis of the journal tilts."""
        return self.model.symmetry and self.operation.tilt is None and self.operation.moment is None

    @property
    def travel(self) -> float:
        """How far the surface of the wall can be pressed beyond the bushing radius; 0 of petals and bores [m]."""
        return 0.0 if self.wall is None else self.wall.travel

    @property
    def solid_height(self) -> float | None:
        """Height over the bushing of the wall that has bottomed out: 0 of a plain bearing, None if unknown [m]."""
        if self.petals is not None and (pack := self.pack) is not None:
            return solid_height(self.petals, pack.layers)
        return 0.0 if self.wall is None else self.wall.solid_height

    @property
    def pack_clearance(self) -> float:
        """Clearance above the solid wall and the contact film thickness, never negative [m]."""
        return self.radial_clearance + self.travel - (self.solid_height or 0.0) - self.surface.contact_film_thickness

    @property
    def bearings(self) -> int:
        """Bearings that share the load: 2 where the case has a rotor with a span."""
        return 1 if self.rotor is None else self.rotor.bearings

    @property
    def shares_evenly(self) -> bool:
        """Whether one bearing tells the state of all: no second one that differs, stands askew or carries otherwise."""
        operation = self.operation
        askew = operation.tilt is not None or operation.moment is not None
        return self.rotor is None or self.bearings == 1 or (self.rotor.is_even and not askew)

    @property
    def supports(self) -> tuple[Self, ...]:
        """Each bearing of the rotor by itself, centred and without load, its slopes those at which it stands askew."""
        bare = {"rotor": None, "operation": self.operation.alone(self.operation.tilt)}
        second = None if self.rotor is None else self.rotor.second
        found = (self.replace(**bare),)
        if self.bearings == 1:
            return found
        if second is None:
            return (*found, *found)
        tilt = self.operation.tilt if second.tilt is None else second.tilt
        return (*found, self.replace(**bare | {"operation": self.operation.alone(tilt)} | second.replaced))

    @property
    def slip_length(self) -> float:
        """Mean free path at ambient pressure by which the film slips at its walls (F7); zero without slip [m]."""
        return self.gas.mean_free_path if self.model.slip else 0.0

    @property
    def cells_per_pitch(self) -> int:
        """Cells per pitch (of a plain bearing: round the whole circle), the default filled in."""
        if self.model.cells_per_pitch is not None:
            return self.model.cells_per_pitch
        return DEFAULT_PLAIN_CELLS if self.petals is None else DEFAULT_CELLS[self.model.kind]

    @property
    def axial_cells(self) -> int:
        """Cells over the whole length, the default filled in; of no effect in a 2-D model."""
        if self.model.axial_cells is not None:
            return self.model.axial_cells
        if self.bump_foil is not None:
            return DEFAULT_BUMP_AXIAL_CELLS
        return DEFAULT_PLAIN_AXIAL_CELLS if self.petals is None else DEFAULT_AXIAL_CELLS

    @property
    def axial_grading(self) -> float:
        """How far cells shrink toward the ends, the default filled in; of no effect in a 2-D model [1]."""
        if self.model.axial_grading is not None:
            return self.model.axial_grading
        if self.model.axial_density is not None:
            return 0.0
        return DEFAULT_PLAIN_GRADING if self.petals is None else 0.0

    @property
    def axial_density(self) -> tuple[float, ...]:
        """Density of the stations from an end to the middle; empty where cells follow `axial_grading` [1]."""
        density = self.model.axial_density
        return density if isinstance(density, tuple) else ()

    @property
    def has_contact_points(self) -> bool:
        """Whether contacts are looked for between nodes: of petals in 2-D on a rigid bushing."""
        model, on_bushing = self.model, self.petals is not None and self.backing is None
        newton_2d = model.kind is ModelKind.TWO_D and model.method is Method.NEWTON
        return on_bushing and newton_2d and model.contacts is ContactDiscretization.POINTS

    @property
    def has_contact_lines(self) -> bool:
        """Whether contact lines may cross axial stations between nodes: of petals without backing springs in 3-D."""
        model = self.model
        newton_3d = model.kind is ModelKind.THREE_D and model.method is Method.NEWTON
        unbacked = self.petals is not None and self.backing is None
        points = model.contacts is ContactDiscretization.POINTS and not self.rubbing_pulls
        return newton_3d and points and unbacked

    @property
    def adapts_stations(self) -> bool:
        """Whether the stations are to be placed where a solution on a coarse grid bends most."""
        model = self.model
        if model.kind is not ModelKind.THREE_D or self.petals is None or self.axial_cells < ADAPTED_FROM:
            return False
        return model.axial_density == ADAPTED or (model.axial_density is None and model.axial_grading is None)

    # ------------------------------------------------------------------------------------------ validation

    @model_validator(mode="after")
    def _can_be_solved(self) -> Self:
        """Refuse what no single field shows: geometry that cannot be assembled, a grid that cannot be halved."""
        refuse_unsolvable(self)
        return self


def _from_folder(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Put `folder` in front of the files that hold a measured free shape or the second bearing of the rotor."""
    petals, rotor = data.get("petals"), data.get("rotor")
    if isinstance(petals, dict) and isinstance(petals.get("free_shape"), str):
        data = {**data, "petals": {**petals, "free_shape": str(folder / petals["free_shape"])}}
    second = rotor.get("second") if isinstance(rotor, dict) else None
    if isinstance(rotor, dict) and isinstance(second, dict) and isinstance(second.get("file"), str):
        data = {**data, "rotor": {**rotor, "second": {**second, "file": str(folder / second["file"])}}}
    return data


def _entries(section: object) -> dict[str, object]:
    """Entries of a section by name; none where there is no section yet."""
    if isinstance(section, Definition):
        return section.entries()
    return dict(section) if isinstance(section, Mapping) else {}
