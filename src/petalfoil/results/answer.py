"""An answer: the records of an analysis in their layout, as JSON, as labelled data, and read back from a file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from petalfoil.results.estimate import Estimate
from petalfoil.results.layout import Layout
from petalfoil.results.record import Record

if TYPE_CHECKING:
    import xarray as xr

WARNINGS = "warnings"
"""Attribute of a dataset that holds warnings, one a line; absent where there are none."""
ASKED = "asked"
"""Attribute of the dataset of a series that tells its case and arguments, as JSON."""


@dataclass(frozen=True, kw_only=True)
class Answer:
    """The records of an analysis in their layout, just computed or read from a file.

    Attributes
    ----------
    verb : str
        Analysis that gave them.
    layout : Layout
        How they are given out.
    records : tuple of Record
        One, or the points in order.
    estimates : tuple of Estimate
        What a grid study tells.
    warnings : tuple of str
        What is implausible about the case and its results, one line each.
    asked : str
        What a series was asked for, so that it can go on from its points.
    interrupted : bool
        Whether points are missing because the user stopped the run.
    """

    verb: str
    layout: Layout
    records: tuple[Record, ...]
    estimates: tuple[Estimate, ...] = ()
    warnings: tuple[str, ...] = ()
    asked: str = ""
    interrupted: bool = False

    @classmethod
    def stored(cls, ds: xr.Dataset, layout: Layout) -> Answer:
        """The answer that a dataset holds; variables that this version does not know are left out."""
        records, estimates = layout.records(ds), layout.stored_estimates(ds)
        warnings = tuple(str(ds.attrs.get(WARNINGS, "")).splitlines())
        return cls(
            verb=str(ds.attrs["analysis"]), layout=layout, records=records, estimates=estimates, warnings=warnings
        )

    @property
    def title(self) -> str:
        """Title of the case."""
        return self.records[0].title

    def to_json(self) -> str:
        """One JSON object, SI units, null for what is not there."""
        plain = self.layout.to_json(self.records)
        if self.estimates:
            plain["quantities"] = {estimate.name: estimate.to_json() for estimate in self.estimates}
        plain["warnings"] = list(self.warnings)
        return json.dumps(plain | ({"interrupted": True} if self.interrupted else {}), allow_nan=False)

    def to_dataset(self) -> xr.Dataset:
        """Labelled data of the whole answer."""
        ds = self.layout.to_dataset(self.records, self.verb)
        if self.warnings:
            ds = ds.assign_attrs({WARNINGS: "\n".join(self.warnings)})
        if self.asked:
            ds = ds.assign_attrs({ASKED: self.asked})
        if not self.estimates:
            return ds
        from petalfoil.results.study import with_estimates

        return with_estimates(ds, self.estimates)

    def failures(self) -> list[str]:
        """One line for each record that did not converge: which and why."""
        return [
            f"{self.layout.place(number, record)} did not converge: {record.scalars.get('status', 'no reason given')}"
            for number, record in enumerate(self.records, start=1)
            if not record.converged
        ]
