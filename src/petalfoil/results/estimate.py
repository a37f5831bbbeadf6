"""What a sequence of grids tells about one figure."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A figure on each grid and what it tends to, in the figure's SI unit.

    Attributes
    ----------
    name : str
        Name of the figure in the schema.
    values : tuple of float
        Value on each grid, coarsest first; nan on a grid without an answer.
    limit : float
        Grid-converged value.
    order : float
        Observed order [1]; nan where none could be observed.
    error : float
        Error bar of the limit, and of the value on the finest grid.
    trusted : bool
        The values behave as the discretisation promises.
    """

    name: str
    values: tuple[float, ...]
    limit: float
    order: float
    error: float
    trusted: bool

    @property
    def trust(self) -> str:
        """Whether the bar comes from a credible order, and if not, why."""
        if self.trusted:
            return "yes"
        return "no order" if math.isnan(self.order) else "odd order"

    def to_json(self) -> dict[str, object]:
        """The estimate as a JSON object; null where there is no value or no order."""
        return {
            "values": [value if math.isfinite(value) else None for value in self.values],
            "order": self.order if math.isfinite(self.order) else None,
            "limit": self.limit,
            "error": self.error,
            "trusted": self.trusted,
        }
