"""Answers that are laid out in their own way: loads, legs, frequencies, a table over load and speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from petalfoil.cli.answer import Answer, Plain
from petalfoil.results import Record
from petalfoil.results.schema import HISTORIES
from petalfoil.results.summary import as_json

if TYPE_CHECKING:
    import xarray as xr

LEGS = ("up", "down")
MODES = ("natural_frequency", "mode_growth_rate", "damping_ratio", "participation", "whirl_direction")
"""What is told of each natural mode, in the order of the table."""
OVER_TIME = tuple(name for name, variable in HISTORIES.items() if variable.dims == ("time",))
"""What is told of every step of a motion."""


@dataclass(frozen=True, kw_only=True)
class LiftoffAnswer(Answer):
    """Speeds of lift-off and touch-down over the load: each figure a list, in the order of the loads."""

    def _plain(self) -> dict[str, object]:
        points = [as_json(record) for record in self.records]
        plain: dict[str, object] = {"loads": [load_of(record) for record in self.records]}
        for name in (
            "liftoff_speed",
            "touchdown_speed",
            "liftoff_by_contact_film_thickness",
            "liftoff_by_contact_fraction",
        ):
            plain[name] = [point.get(name) for point in points]
        for name in ("share", "converged", "status", "factorizations", "wall_time"):
            plain[name] = [point.get(name) for point in points]
        return plain | ({"interrupted": True} if self.interrupted else {})

    def _place(self, number: int, record: Record) -> str:
        return f"load {number} of {load_of(record):g} N"


@dataclass(frozen=True, kw_only=True)
class RunupAnswer(Answer):
    """Points from rest to speed and back: a list for each leg."""

    def _plain(self) -> dict[str, object]:
        plain: dict[str, object] = {
            leg: [as_json(record) for record in self.records if record.scalars["leg"] == leg] for leg in LEGS
        }
        return plain | ({"interrupted": True} if self.interrupted else {})

    def _place(self, number: int, record: Record) -> str:
        return f"point {number}, {record.scalars['leg']} at {rpm(record)}"


@dataclass(frozen=True, kw_only=True)
class CoefficientsAnswer(Answer):
    """Stiffness and damping as ``[frequency][row][column]``, at one speed or at several."""

    def _plain(self) -> dict[str, object]:
        points = [as_json(record) | _matrices(record) for record in self.records]
        plain: dict[str, object] = {"points": points} if self.is_curve else dict(points[0])
        return plain | ({"interrupted": True} if self.interrupted else {})

    def _place(self, number: int, record: Record) -> str:
        return f"point {number} at {rpm(record)}"


@dataclass(frozen=True, kw_only=True)
class StabilityAnswer(Answer):
    """Threshold and natural modes at one operating point; modes as lists by frequency, null without a rotor's mass."""

    def _plain(self) -> dict[str, object]:
        (record,) = self.records
        modes = {name: record.fields[name].tolist() if name in record.fields else None for name in MODES}
        return {**as_json(record), **modes}


@dataclass(frozen=True, kw_only=True)
class OrbitAnswer(Answer):
    """A motion: figures of the whole, and lists over its steps."""

    def _plain(self) -> dict[str, object]:
        (record,) = self.records
        over = {"time": record.coords["time"].tolist()} if "time" in record.coords else {}
        over |= {name: record.fields[name].tolist() for name in OVER_TIME if name in record.fields}
        return {**as_json(record), **over} | ({"interrupted": True} if self.interrupted else {})


@dataclass(frozen=True, kw_only=True)
class ChartAnswer(Answer):
    """Figures over load and speed as ``[load][speed]``; null where nothing was computed."""

    @property
    def loads(self) -> list[float]:
        """Sizes of the loads [N], a row of the table each."""
        return list(dict.fromkeys(load_of(record) for record in self.records))

    @property
    def speeds(self) -> list[float]:
        """Speeds [rad/s], a column of the table each."""
        return list(dict.fromkeys(float(record.scalars["speed"]) for record in self.records))

    def table(self, name: str) -> list[list[Plain]]:
        """One figure over load and speed."""
        at = {(load_of(record), float(record.scalars["speed"])): as_json(record).get(name) for record in self.records}
        return [[at.get((load, speed)) for speed in self.speeds] for load in self.loads]

    def _plain(self) -> dict[str, object]:
        plain: dict[str, object] = {"loads": self.loads, "speeds": self.speeds}
        for name in ("critical_mass", "whirl_ratio", "contact_fraction", "eccentricity_x", "eccentricity_y", "status"):
            plain[name] = self.table(name)
        return plain | ({"interrupted": True} if self.interrupted else {})

    def to_dataset(self) -> xr.Dataset:
        """Labelled data over load and speed."""
        from petalfoil.results.chart import chart_dataset

        return chart_dataset(self.records, self.verb)

    def _place(self, number: int, record: Record) -> str:
        return f"point {number} of {load_of(record):g} N at {rpm(record)}"


KINDS: dict[str, type[Answer]] = {
    "liftoff": LiftoffAnswer,
    "runup": RunupAnswer,
    "coefficients": CoefficientsAnswer,
    "stability": StabilityAnswer,
    "orbit": OrbitAnswer,
}
"""Kinds of answers that are not tables over load and speed or grids, by verb."""


def load_of(record: Record) -> float:
    """Size of the load of a record [N]."""
    return math.hypot(*(float(record.scalars[f"load_{axis}"]) for axis in "xy"))


def rpm(record: Record) -> str:
    """Speed of a record as people read it."""
    return f"{float(record.scalars['speed']) * 30.0 / math.pi:.0f} rpm"


def _matrices(record: Record) -> dict[str, list[float] | None]:
    """Frequencies and coefficients; null where the point has none."""
    found = {**record.coords, **record.fields}
    names = ("whirl_frequency", "stiffness", "damping")
    return {name: found[name].tolist() if name in found else None for name in names}
