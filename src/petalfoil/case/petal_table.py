"""The petals of a foil pack: number, size, material, mount, free shape."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from enum import StrEnum
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from petalfoil.case.definition import LookedUp
from petalfoil.case.metals import Metal, MetalName, metal_of
from petalfoil.case.number_fields import UNSET, VALUE_PROBLEM, Count, PerPetal, PerPetalOrWord, Quantity, refuse
from petalfoil.case.shape_file import as_shape
from petalfoil.case.wall_tables import WallTable

MIN_ROWS = 3  # of a measured free shape: fewer say nothing of a curvature
MAX_ROWS = 10_000  # more than a coordinate measuring machine takes of a petal, and read in a second or two


BY_MATERIAL = ("youngs_modulus", "poisson_ratio", "yield_strength")
"""Fields that a material gives."""
REFUSED = {"youngs_modulus": 2e11, "poisson_ratio": 0.3}
"""Stand for the numbers of a material that is refused; nobody sees them."""


class Mount(StrEnum):
    """How a root is held: free to turn (`HINGED`), or clamped (`CLAMPED`)."""

    HINGED = "hinged"
    CLAMPED = "clamped"


class PetalTheory(StrEnum):
    """Whether petals bend at a constant length of their mid-surface, or also stretch and slide along themselves."""

    INEXTENSIBLE = "inextensible"
    SHELL = "shell"


class LinearAbout(StrEnum):
    """Shape about which bending is linear: the free petal as in the paper, or the petal pressed to the bore."""

    FREE_SHAPE = "free_shape"
    BORE = "bore"


_Angle = Annotated[float, Quantity(unit="rad", meaning="angle from the root", symbol="phi", at_least=0.0, below=6.3)]
_Radius = Annotated[
    float, Quantity(unit="m", meaning="radius of the free mid-surface", symbol="r_0", above=0.0, at_most=10.0)
]


RootTilt: TypeAlias = float | Literal["chordal"]
Each: TypeAlias = float | tuple[float, ...]
"""One quantity for all petals, or that of each."""


@dataclass(frozen=True)
class Petal:
    """One petal; fields as in `Petals`, SI."""

    thickness: float
    coating: float
    bend_radius: float | None
    root_tilt: RootTilt
    youngs_modulus: float
    poisson_ratio: float

    @property
    def total_thickness(self) -> float:
        """Metal and coating, ``δ = δ0 + δ_c`` [m]."""
        return self.thickness + self.coating

    @property
    def bending_stiffness(self) -> float:
        """Flexural rigidity of the metal, ``D = E_y δ0³ / (12 (1 − ν²))`` [N m]."""
        return self.youngs_modulus * self.thickness**3 / (12.0 * (1.0 - self.poisson_ratio**2))

    @property
    def membrane_stiffness(self) -> float:
        """Membrane force by the strain along the petal, ``B = E_y δ0 / (1 − ν²)`` [N/m]."""
        return self.youngs_modulus * self.thickness / (1.0 - self.poisson_ratio**2)


def of_each(value: Any, count: int) -> tuple[Any, ...]:
    """The values of all petals, one by one."""
    return value if isinstance(value, tuple) else (value,) * count


def mean(values: Sequence[Any]) -> Any:
    """Mean of numbers, exact where they are equal; of words and of what is not given, the first."""
    first = values[0]
    if not all(isinstance(value, float) for value in values):
        return first
    return first + math.fsum(value - first for value in values) / len(values)


class Petals(LookedUp, WallTable):
    """A foil pack of petals (leaves); absent in a plain bearing.

    Petals are equal, or a list gives the thickness, coating, bend radius, root tilt or material of each, in the order
    of their roots. The free shape is an arc of `bend_radius` at `root_tilt`, or measured: `free_shape` gives rows
    [angle, radius], in the case itself or as the name of a CSV file. The bend radius then follows from the rows.
    """

    section: ClassVar[str] = "petals"

    count: Annotated[int, Count(meaning="number of petals", symbol="n", at_least=2, at_most=64)]
    arc_length: Annotated[
        float, Quantity(unit="m", meaning="arc length from root to free edge", symbol="l_p", above=0.0, at_most=100.0)
    ]
    thickness: Annotated[Each, PerPetal(unit="m", meaning="metal thickness", symbol="delta_0", above=0.0, at_most=0.1)]
    coating: Annotated[
        Each, PerPetal(unit="m", meaning="coating thickness", symbol="delta_c", at_least=0.0, at_most=0.1)
    ] = 0.0
    free_shape: Annotated[tuple[tuple[_Angle, _Radius], ...], BeforeValidator(as_shape)] | None = None
    """Rows `[angle, radius]`, or the name of a CSV file of them."""
    free_shape_tolerance: Annotated[
        float,
        Quantity(
            unit="m", meaning="standard deviation of a measured radius", symbol="sigma_r", at_least=0.0, at_most=1e-3
        ),
    ] = 0.0
    # after free_shape, which makes it needless
    bend_radius: (
        Annotated[
            Each, PerPetal(unit="m", meaning="bend radius of the free petal", symbol="R_p", above=0.0, at_most=1e4)
        ]
        | None
    ) = Field(default=None, validate_default=True)
    """Required without a measured free shape, from which it follows."""
    root_tilt: Annotated[
        RootTilt | tuple[RootTilt, ...],
        PerPetalOrWord(
            unit="rad", meaning="root tilt from the bore's tangent", symbol="psi", above=-1.5, below=1.5, word="chordal"
        ),
    ] = "chordal"
    """With `"chordal"` the free edge of the free petal lies on the bore (G4)."""
    mount: Mount
    """Root free to turn, or clamped."""
    theory: PetalTheory | None = None
    """`shell`, unless given, in 3-D and in 2-D where petals have friction: they slide along themselves and stretch.
    Without friction both are the same in 2-D. On backing springs and by the paper's method petals bend only."""
    # before the numbers that a material gives
    material: MetalName = None
    """Metal whose modulus, Poisson's ratio and yield strength are looked up, such as `inconel x-750`."""
    metal_temperature: Annotated[
        float, Quantity(unit="K", meaning="temperature of the petals' metal", symbol="T_m", above=0.0, at_most=2000.0)
    ] = 293.15
    """Of effect on the modulus of a material."""
    youngs_modulus: Annotated[
        Each, PerPetal(unit="Pa", meaning="Young's modulus", symbol="E_y", above=0.0, at_most=1e13)
    ] = Field(default=UNSET, validate_default=True)
    """Required unless the petals have a material."""
    poisson_ratio: Annotated[
        Each, PerPetal(unit="1", meaning="Poisson's ratio", symbol="nu", above=-1.0, below=0.5)
    ] = Field(default=UNSET, validate_default=True)
    """Required unless the petals have a material."""
    linear_about: LinearAbout = LinearAbout.FREE_SHAPE
    """Shape about which bending is linear. About the `bore` pressed petals have the curvature of the bore (G7)."""
    first_root: Annotated[
        float,
        Quantity(unit="rad", meaning="angle of the first root", symbol="theta_ref", at_least=-6.3, at_most=6.3),
    ] = 0.0
    yield_strength: (
        Annotated[float, Quantity(unit="Pa", meaning="yield strength", symbol="sigma_y", above=0.0, at_most=1e11)]
        | None
    ) = Field(default=None, validate_default=True)
    """By default that of the material; without one, stress above 2 GPa is warned of."""

    @property
    def metal(self) -> Metal | None:
        """What is known of the material; None without one."""
        return None if self.material is None else metal_of(self.material)

    def is_written(self, field: str) -> bool:
        """Whether a field is the user's own: not one that follows from the material."""
        metal = self.metal
        if metal is None:
            return True
        return field not in BY_MATERIAL or (field == "yield_strength" and self.yield_strength != metal.yield_strength)

    @property
    def pitch(self) -> float:
        """Angle between neighbouring roots, ``φ0 = 2π/n`` [rad]."""
        return 2.0 * math.pi / self.count

    @property
    def each(self) -> tuple[Petal, ...]:
        """The petals one by one; equal ones are the same object."""
        return _each_of(self)

    @property
    def mean(self) -> Petal:
        """The petal that is the mean of all; of equal ones, one of them."""
        return _mean_of(self)

    @property
    def total_thickness(self) -> float:
        """Metal and coating of the mean petal, ``δ`` [m]."""
        return self.mean.total_thickness

    @property
    def bending_stiffness(self) -> float:
        """Flexural rigidity of the mean petal, ``D`` [N m]."""
        return self.mean.bending_stiffness

    @field_validator("thickness", "coating", "bend_radius", "root_tilt", "youngs_modulus", "poisson_ratio")
    @classmethod
    def _is_one_or_one_each(cls, value: object, info: ValidationInfo) -> object:
        """Refuse lists that do not have one value for each petal; without a valid count all of them fit."""
        count = info.data.get("count")
        if isinstance(value, tuple) and count is not None and len(value) != count:
            allowed = f"one value for all petals, or a list with one for each of the {count}"
            raise refuse(
                VALUE_PROBLEM, f"has {len(value)} values for petals.count = {count}; allowed: {allowed}", allowed
            )
        return value

    @field_validator(*BY_MATERIAL, mode="before")
    @classmethod
    def _resolved(cls, given: object, info: ValidationInfo) -> object:
        """What was given, or what follows from the material."""
        field, known = str(info.field_name), info.data
        material = known.get("material")
        if material is None:
            return cls._without_metal(given, field, known)
        metal = metal_of(material)
        if field == "yield_strength":
            return metal.yield_strength if given is None else given
        if given is not UNSET:
            raise cls.given_twice(given, "material", material)
        temperature = known.get("metal_temperature", 293.15)  # a refused one is told already
        return metal.poisson_ratio if field == "poisson_ratio" else metal.youngs_modulus(temperature)

    @classmethod
    def _without_metal(cls, given: object, field: str, known: dict[str, object]) -> object:
        if given is not UNSET or field == "yield_strength":
            return given
        if "material" not in known:  # it is refused itself
            return REFUSED[field]
        raise cls.missing(field, "material", "inconel x-750")

    @field_validator("free_shape")
    @classmethod
    def _is_a_curve(cls, rows: tuple[tuple[float, float], ...] | None) -> tuple[tuple[float, float], ...] | None:
        if rows is None:
            return rows
        allowed = f"{MIN_ROWS} to {MAX_ROWS} rows [angle, radius], the first at angle 0, the angles growing"
        if not MIN_ROWS <= len(rows) <= MAX_ROWS:
            raise refuse(VALUE_PROBLEM, f"has {len(rows)} rows; allowed: {allowed}", allowed)
        if rows[0][0] != 0.0:
            raise refuse(VALUE_PROBLEM, f"begins at {rows[0][0]:g} rad; allowed: {allowed}", allowed)
        if any(after <= before for (before, _), (after, _) in pairwise(rows)):
            raise refuse(VALUE_PROBLEM, f"its angles do not grow from row to row; allowed: {allowed}", allowed)
        return rows

    @field_validator("linear_about")
    @classmethod
    def _is_an_arc(cls, about: LinearAbout, info: ValidationInfo) -> LinearAbout:
        """Refuse a measured free shape about the bore: its curvature is not that of an arc."""
        if about is LinearAbout.BORE and info.data.get("free_shape") is not None:
            allowed = '"free_shape", or an arc of petals.bend_radius'
            raise refuse(
                VALUE_PROBLEM, f'"bore" is for petals bent to an arc, not measured ones; allowed: {allowed}', allowed
            )
        return about

    @field_validator("bend_radius")
    @classmethod
    def _is_given_once(cls, radius: Each | None, info: ValidationInfo) -> Each | None:
        """Refuse a petal without any free shape; where the measured one is refused itself, nothing more is said."""
        if radius is None and info.data.get("free_shape", ()) is None:
            allowed = "bend radius of the free petal [m], or a measured petals.free_shape"
            raise refuse(VALUE_PROBLEM, f"is missing; expected {allowed}", allowed)
        return radius


KNOWN = 256
"""Tables of petals whose petals are remembered: a run asks for those of its cases hundreds of times."""


@lru_cache(maxsize=KNOWN)
def _each_of(petals: Petals) -> tuple[Petal, ...]:
    lists = [of_each(getattr(petals, field.name), petals.count) for field in fields(Petal)]
    known: dict[Petal, Petal] = {}
    made = (Petal(*values) for values in zip(*lists, strict=True))
    return tuple(known.setdefault(petal, petal) for petal in made)


@lru_cache(maxsize=KNOWN)
def _mean_of(petals: Petals) -> Petal:
    return Petal(*(mean(of_each(getattr(petals, field.name), petals.count)) for field in fields(Petal)))
