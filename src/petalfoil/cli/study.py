"""What `converge` has to give out: figures on each grid, and what they tend to."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from petalfoil.cli.answer import Answer
from petalfoil.results import Record
from petalfoil.results.estimate import Estimate
from petalfoil.results.summary import as_json

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class StudyAnswer(Answer):
    """The records of a grid study, coarsest grid first, and its estimates.

    Its JSON object has two keys: ``grids``, the objects of `solve` with ``cells_per_pitch`` and, in a spatial model,
    ``axial_cells``; and ``quantities``, for each figure its ``values`` on the grids, the observed ``order``, the
    ``limit``, its ``error`` bar and whether it can be ``trusted``.

    Parameters
    ----------
    estimates : tuple of Estimate
        What the grids tell.
    """

    estimates: tuple[Estimate, ...] = ()

    def _plain(self) -> dict[str, object]:
        plain: dict[str, object] = {
            "grids": [as_json(record) for record in self.records],
            "quantities": {estimate.name: _plain_estimate(estimate) for estimate in self.estimates},
        }
        return plain | ({"interrupted": True} if self.interrupted else {})

    def to_dataset(self) -> xr.Dataset:
        """Labelled data of the whole study."""
        from petalfoil.results.study import study_dataset

        return study_dataset(self.records, self.estimates)

    def _place(self, number: int, record: Record) -> str:
        return f"the grid of {grid_text(record)} cells"


def grid_text(record: Record) -> str:
    """Cells along a pitch and, in a spatial model, along the axis."""
    grid = (record.scalars[name] for name in ("cells_per_pitch", "axial_cells") if name in record.scalars)
    return " x ".join(map(str, grid))


def _plain_estimate(estimate: Estimate) -> dict[str, object]:
    return {
        "values": [_or_null(value) for value in estimate.values],
        "order": _or_null(estimate.order),
        "limit": estimate.limit,
        "error": estimate.error,
        "trusted": estimate.trusted,
    }


def _or_null(value: float) -> float | None:
    return value if math.isfinite(value) else None
