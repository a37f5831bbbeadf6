"""What a verb has to give out, whether just computed or read from a file: as JSON and as labelled data."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from petalfoil.results import Record
from petalfoil.results.summary import as_json

if TYPE_CHECKING:
    import xarray as xr

Plain: TypeAlias = float | int | bool | str | None


@dataclass(frozen=True, kw_only=True)
class Answer:
    """One record, or the points of a curve.

    Parameters
    ----------
    verb : str
        Verb that gave it.
    records : tuple of Record
        One, or the points in order.
    is_curve : bool
        Whether the records are points of a curve, be it of one point.
    interrupted : bool
        Whether points are missing because the user stopped the run.
    errors : dict of float, optional
        Error bars of the figures of a single record, from a grid study; None where none was asked for.
    """

    verb: str
    records: tuple[Record, ...]
    is_curve: bool = False
    interrupted: bool = False
    errors: Mapping[str, float] | None = None

    @property
    def title(self) -> str:
        """Title of the case."""
        return self.records[0].title

    def to_json(self) -> str:
        """One JSON object, SI units, null for what is not there."""
        return json.dumps(self._plain(), allow_nan=False)

    def _plain(self) -> dict[str, object]:
        if not self.is_curve:
            single: dict[str, object] = dict(as_json(self.records[0]))
            return single if self.errors is None else single | {"error": dict(self.errors)}
        plain: dict[str, object] = dict(self.preload()) if self.verb == "static" else {}
        plain["points"] = [as_json(record) for record in self.records]
        return plain | ({"interrupted": True} if self.interrupted else {})

    def preload(self) -> dict[str, Plain]:
        """Contact reactions [N] and starting torque [N m] of the centred journal; null without such a point."""
        for point in map(as_json, self.records):
            if math.hypot(float(point["eccentricity_x"] or 0.0), float(point["eccentricity_y"] or 0.0)) == 0.0:
                return {"preload": point.get("contact_normal_force"), "starting_torque": point.get("starting_torque")}
        return {"preload": None, "starting_torque": None}

    def to_dataset(self) -> xr.Dataset:
        """Labelled data of the whole answer."""
        from petalfoil.results.dataset import curve_dataset, to_dataset

        if self.is_curve:
            return curve_dataset(self.records, self.verb)
        ds = to_dataset(self.records[0])
        if self.errors is None:
            return ds
        from petalfoil.results.study import with_error_bars

        return with_error_bars(ds, self.errors)

    def failures(self) -> list[str]:
        """One line for each record that did not converge: which and why."""
        return [
            f"{self._place(number, record)} did not converge: {record.scalars.get('status', 'no reason given')}"
            for number, record in enumerate(self.records, start=1)
            if not record.converged
        ]

    def _place(self, number: int, record: Record) -> str:
        x, y = (1e6 * float(record.scalars[f"eccentricity_{axis}"]) for axis in "xy")
        return f"{f'point {number}' if self.is_curve else 'the run'} at ({x:.4g}, {y:.4g}) um"
