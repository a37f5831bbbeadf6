"""A motion as a short printed table: how far, how large, how close, and how far it can be trusted."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from rich.table import Table

from petalfoil.results import Record
from petalfoil.results.summary import ABSENT, cell, number

Line = tuple[str, str, str]


def motion(record: Record) -> Table:
    """One line a figure: label, value, unit."""
    table = Table(box=None, show_header=False, pad_edge=False)
    table.add_column()
    table.add_column(justify="right")
    table.add_column()
    for line in _lines(record):
        table.add_row(*line)
    return table


def _lines(record: Record) -> Iterator[Line]:
    scalars, over = record.scalars, record.fields
    yield "status", str(scalars["status"]), ""
    yield "speed", _speeds(over["shaft_speed"].tolist()), "rpm"
    yield "turns", number(float(scalars["revolutions"])), ""
    time = record.coords["time"]
    yield "time", number(1e3 * float(time[-1] - time[0])), "ms"
    for name, label in (("steps", "steps"), ("factorizations", "factorisations"), ("failed_steps", "failed steps")):
        yield label, str(scalars[name]), ""
    yield "largest displacement", number(1e6 * float(np.hypot(over["x"], over["y"]).max())), "µm"
    yield "amplitude, last turns", number(1e6 * float(scalars["amplitude"])), "µm"
    yield "smallest film", cell("min_film_thickness", float(over["min_film_thickness"].min())).value, "µm"
    yield "largest contact share", cell("contact_fraction", float(over["contact_fraction"].max())).value, "%"
    yield "dominating whirl over speed", _ratio(float(scalars["dominant_whirl_ratio"])), ""
    for name, label in (("mass_balance_error", "defect of the gas"), ("energy_balance_error", "defect of the energy")):
        yield label, number(float(scalars[name])), ""
    yield "time spent", number(float(scalars["wall_time"])), "s"


def _speeds(speed: list[float]) -> str:
    first, last = (cell("speed", value).value for value in (speed[0], speed[-1]))
    return first if max(speed) - min(speed) <= 1e-9 * max(speed) else f"{first} to {last}"


def _ratio(ratio: float) -> str:
    """To the digits that a spectrum of some turns gives."""
    return ABSENT if math.isnan(ratio) else f"{ratio:.3f}"
