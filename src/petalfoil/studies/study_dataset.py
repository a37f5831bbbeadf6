"""Outcomes of a study as labelled data: results over the parameters of a grid, or over the cases of a sample."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from petalfoil import __version__
from petalfoil.results.atomic import replacing
from petalfoil.results.dataset import CONVENTIONS
from petalfoil.results.record import blank
from petalfoil.results.schema import SCALARS
from petalfoil.results.variable import DataType, Role, Variable
from petalfoil.studies.plan import Plan
from petalfoil.studies.question import NOT_CONVERGED, CaseOutcome
from petalfoil.studies.study_definition import Study
from petalfoil.studies.variation import Variation

_DTYPES = {DataType.FLOAT: np.float64, DataType.INT: np.int64, DataType.BOOL: np.bool_, DataType.STR: np.str_}
MISSING = "not asked"
"""Status of a case that is not finished."""


def dataset(study: Study, plan: Plan, found: Sequence[CaseOutcome | None]) -> xr.Dataset:
    """Lay out the outcomes of a study.

    Parameters
    ----------
    study : Study
        What was asked.
    plan : Plan
        Its cases.
    found : sequence of CaseOutcome or None
        Their outcomes in that order; None of a case that is not finished.

    Returns
    -------
    xarray.Dataset
        Results along the parameters of a grid, or along ``case``; along ``point`` too where a case has several points.
        NaN (-1 of a count, false, empty) where a case has no answer.
    """
    shape = plan.shape or (len(plan.points),)
    several = max((len(outcome.records) for outcome in found if outcome), default=1) > 1
    points = max(len(outcome.records) for outcome in found if outcome) if several else 1
    coords = _coordinates(plan)
    variables: dict[str, Any] = {
        "converged": (
            plan.dims,
            _plain([o is not None and o.converged for o in found], shape),
            _flag("the case converged"),
        ),
        "status": (
            plan.dims,
            _plain([MISSING if o is None else o.status for o in found], shape),
            _told("status of the case"),
        ),
        "reason": (
            plan.dims,
            _plain(["" if o is None else o.reason for o in found], shape),
            _told("why there is no answer"),
        ),
    }
    for name in _names(found):
        if name in coords or name in variables:
            continue
        values = _values(SCALARS[name], name, found, points).reshape(*shape, points)
        variables[name] = _variable(SCALARS[name], values if several else values[..., 0], plan.dims, several)
    if several:
        coords["point"] = ("point", np.arange(points), {"long_name": "number of the point of a case", "units": "1"})
    return xr.Dataset(variables, coords=coords, attrs=_attributes(study))


def _coordinates(plan: Plan) -> dict[str, Any]:
    """The parameters: dimensions of a grid, labels of the cases of a sample."""
    coords: dict[str, Any] = {}
    for name, variation in zip(plan.names, plan.variations, strict=True):
        dims = (name,) if plan.shape else ("case",)
        values = variation.values if plan.shape else [point[variation.path] for point in plan.points]  # type: ignore[attr-defined]
        coords[name] = (dims, np.array(values), _of_parameter(variation))
    if not plan.shape:
        coords["case"] = ("case", np.arange(len(plan.points)), {"long_name": "number of the case", "units": "1"})
    return coords


def _of_parameter(variation: Variation) -> dict[str, str]:
    parameter = variation.parameter
    units = parameter.unit.replace("(", "").replace(")", "").replace("*", " ").replace("rad/s", "rad s-1")
    return {"long_name": parameter.meaning, "symbol": parameter.symbol, "units": units, "path": parameter.path}


def _names(found: Sequence[CaseOutcome | None]) -> list[str]:
    given = {name for outcome in found if outcome for record in outcome.records for name in record}
    return [name for name in SCALARS if name in given]


def _values(variable: Variable, name: str, found: Sequence[CaseOutcome | None], points: int) -> NDArray[Any]:
    """Values of one result, shape (cases, points)."""
    absent = blank(variable)
    rows = []
    for outcome in found:
        records = outcome.records if outcome else []
        rows.append([record.get(name, absent) for record in records] + [absent] * (points - len(records)))
    return np.array(rows, dtype=_DTYPES[variable.kind])


def _variable(variable: Variable, values: NDArray[Any], dims: tuple[str, ...], several: bool) -> tuple[Any, ...]:
    attributes = {"long_name": variable.long_name, "symbol": variable.symbol, "units": variable.units}
    if variable.kind is DataType.BOOL:
        return (*dims, *(["point"] if several else [])), values, _flag(variable.long_name)
    if variable.role is Role.GEOMETRY and values.size and len(np.unique(values)) == 1:
        return (), values.ravel()[0], attributes
    return (*dims, *(["point"] if several else [])), values, {name: text for name, text in attributes.items() if text}


def _plain(values: Sequence[bool] | Sequence[str], shape: tuple[int, ...]) -> NDArray[Any]:
    return np.array(values).reshape(shape)


def _flag(text: str) -> dict[str, Any]:
    return {"long_name": text, "flag_values": np.array([0, 1], dtype=np.int8), "flag_meanings": "false true"}


def _told(text: str) -> dict[str, Any]:
    return {"long_name": text}


def _attributes(study: Study) -> dict[str, str]:
    return {
        "Conventions": CONVENTIONS,
        "title": study.case.title,
        "petalfoil_version": __version__,
        "analysis": study.kind,
        "asked": study.question.verb,
        "arguments": json.dumps(study.question.arguments, sort_keys=True),
        "vary": json.dumps({path: str(text) for path, text in study.vary.items()}),
        "settings": json.dumps(dict(study.settings)),
        "case": study.case.to_toml(),
        "history": "[]",
    }


def write_table(path: Path, ds: xr.Dataset) -> None:
    """Write one line for each case (and point): parameters, status, results; SI units in the heading."""
    columns = [name for name in (*ds.coords, *ds.data_vars) if ds[name].dims]
    order = list(ds["converged"].dims) + (["point"] if "point" in ds.dims else [])
    arrays = [line.transpose(*order).values.ravel() for line in xr.broadcast(*[ds[name] for name in columns])]
    heads = [f"{name} [{ds[name].attrs['units']}]" if ds[name].attrs.get("units") else str(name) for name in columns]
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(heads)
        writer.writerows(zip(*(array.tolist() for array in arrays), strict=True))


def reasons(found: Sequence[CaseOutcome | None]) -> dict[str, int]:
    """How often each reason keeps a case from an answer, the most frequent first."""
    told: dict[str, int] = {}
    for outcome in found:
        if outcome is not None and not outcome.converged:
            words = f"{outcome.status}: {outcome.reason}" if outcome.status != NOT_CONVERGED else outcome.reason
            told[words] = told.get(words, 0) + 1
    return dict(sorted(told.items(), key=lambda item: -item[1]))
