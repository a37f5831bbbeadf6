"""The second bearing of a rotor: what of it differs from the first, as tables or as a case file of its own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, StrictBool, model_validator

from petalfoil.case import toml
from petalfoil.case.bump_foil_table import BumpFoil
from petalfoil.case.definition import Definition
from petalfoil.case.gas import Gas
from petalfoil.case.growth import Bushing, Shaft
from petalfoil.case.heat_table import Heat
from petalfoil.case.number_fields import VALUE_PROBLEM, Quantity, as_pair, refuse
from petalfoil.case.petal_table import Petals
from petalfoil.case.sections import Bearing, Model, Surface
from petalfoil.errors import DefinitionError

WALLS = ("petals", "bump_foil")
"""Tables that describe what bounds the film: one of them takes the place of the first bearing's."""

TABLES = ("bearing", "shaft", "bushing", *WALLS, "gas", "heat", "surface", "model")
"""Tables of a case that belong to a bearing."""

_Slope = Annotated[
    float,
    Quantity(unit="rad", meaning="slope of the journal's axis in the second bearing", at_least=-0.1, at_most=0.1),
]


class SecondBearing(Definition):
    """The second bearing of a rotor with a span, where it differs from the first.

    A table stands in place of the whole table of that name; what is not given is that of the first bearing. With `file`
    the tables are those of another case; tables beside it replace the file's.
    """

    section: ClassVar[str] = "rotor.second"

    file: str | None = None
    """Case file of the second bearing; its rotor and its operation but for the tilt do not matter."""
    plain: StrictBool = False
    """A plain bore, where the first bearing has petals or a bump foil."""
    tilt: Annotated[tuple[_Slope, _Slope], BeforeValidator(as_pair)] | None = None
    """Slopes `[x, y]` at which the second bearing stands askew; as those of the first, operation.tilt, unless given."""
    bearing: Bearing | None = None
    shaft: Shaft | None = None
    bushing: Bushing | None = None
    petals: Petals | None = None
    bump_foil: BumpFoil | None = None
    gas: Gas | None = None
    heat: Heat | None = None
    surface: Surface | None = None
    model: Model | None = None

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, data: Any) -> Any:
        """The tables of the file in place of its name."""
        if not isinstance(data, Mapping) or not isinstance(data.get("file"), str):
            return data
        given = {name: value for name, value in data.items() if name != "file"}
        try:
            return {**tables_of(Path(data["file"])), **given}
        except DefinitionError as error:
            raise refuse(VALUE_PROBLEM, f"{data['file']}: {error}", "a case file") from None

    @property
    def replaced(self) -> dict[str, Definition | None]:
        """Tables of the second bearing by name: those that differ from the first's."""
        found: dict[str, Definition | None] = {}
        if self.plain or any(getattr(self, name) is not None for name in WALLS):
            found.update(dict.fromkeys(WALLS))
        return found | {name: table for name in TABLES if (table := getattr(self, name)) is not None}


def tables_of(path: Path) -> dict[str, Any]:
    """The tables of a case file that belong to its bearing, and the slopes at which it stands askew."""
    tables = toml.parse(toml.read_file(path))
    found: dict[str, Any] = {name: tables[name] for name in TABLES if name in tables}
    found["plain"] = not any(name in tables for name in WALLS)
    petals, operation = found.get("petals"), tables.get("operation")
    if isinstance(petals, dict) and isinstance(petals.get("free_shape"), str):
        found["petals"] = {**petals, "free_shape": str(path.parent / petals["free_shape"])}
    if isinstance(operation, dict) and "tilt" in operation:
        found["tilt"] = operation["tilt"]
    return found
