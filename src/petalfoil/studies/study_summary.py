"""A study in words and numbers: how many cases have an answer, what the results range over, why some have none."""

from __future__ import annotations

import json
import math
from collections import Counter
from typing import Any

import numpy as np
import xarray as xr

from petalfoil.analysis import known_verbs
from petalfoil.analysis.neighbours import FROM_NEIGHBOUR
from petalfoil.results.rounding import values_without_rounding
from petalfoil.results.schema import SCALARS
from petalfoil.results.summary import cell, in_order, label_alone, shown_as
from petalfoil.results.variable import DataType, Role
from petalfoil.studies.question import CONVERGED
from petalfoil.units import format_quantity

Lines = tuple[tuple[str, ...], ...]
SAME = 1e-6
"""Relative spread below which a result is the same in all cases: each is solved to 1e-8."""
SOBOL_HEADS = ("quantity", "parameter", "first order", "total", "samples")
LIMIT_HEADS = ("limit", "kept by", "95 % confidence", "without an answer")
QUANTILE_KEYS = ("quantile_05", "quantile_50", "quantile_95")
TOLERANCE_HEADS = ("quantity", "nominal", "mean", "std. dev.", "first order", "5 %", "50 %", "95 %", "unit")
RANGE_HEADS = ("quantity", "least", "median", "greatest", "unit")
MOST_COLUMNS = 7
"""Cases of a study up to which each has a column of its own, instead of the range over all."""
MOST_NAMED = 3
"""Parameters up to which they name a case."""


def headline(ds: xr.Dataset) -> str:
    """How many cases there are and how many have an answer."""
    status = np.ravel(ds["status"].values)
    counts = Counter(str(text) for text in status)
    others = ", ".join(f"{count} {text}" for text, count in counts.items() if text != CONVERGED)
    what = f"{ds.attrs['analysis']} of {ds.attrs['asked']}: {len(status)} cases, {counts[CONVERGED]} converged"
    optimum = extra(ds).get("optimum")
    found = "" if optimum is None else f"; {_found(optimum)}"
    near = _from_neighbours(ds)
    return what + (f", {others}" if others else "") + (f", {near} from a neighbour" if near else "") + found


def _from_neighbours(ds: xr.Dataset) -> int:
    """How many cases began at the solution of another."""
    if "solution_path" not in ds:
        return 0
    paths = [str(text) for text in np.ravel(of_last_point(ds["solution_path"]).values)]
    return sum(FROM_NEIGHBOUR in text for text in paths)


def of_last_point(values: xr.DataArray) -> xr.DataArray:
    """One value a case: of a series of points the last."""
    return values.isel(point=-1) if "point" in values.dims else values


def _found(optimum: dict[str, Any]) -> str:
    """How a search ended, and what it cost."""
    exact = f", derivatives at {optimum['with_derivatives']} of them" if optimum["with_derivatives"] else ""
    best = "no design keeps every limit" if not optimum["best"] else f"{len(optimum['best'])} best"
    return f"{best}, {optimum['designs']} designs{exact}; {optimum['ended']}"


def results(ds: xr.Dataset) -> list[str]:
    """Names of the numeric results that vary over a study, in the order of tables."""
    found = []
    for name in in_order([str(name) for name in ds.data_vars if name in SCALARS]):
        variable = SCALARS[name]
        if ds[name].dims and variable.kind is DataType.FLOAT and variable.role is Role.ANSWER:
            values = values_without_rounding(ds, name)
            finite = values[np.isfinite(values)]
            size = float(np.abs(finite).max()) if finite.size else 0.0
            if size > 0.0 and float(np.ptp(finite)) > SAME * size and not _is_rounding(ds, name, size):
                found.append(name)
    return found


def _is_rounding(ds: xr.Dataset, name: str, size: float) -> bool:
    """Whether a component of a force is nothing beside the whole force."""
    if SCALARS[name].units != "N" or "bearing_force" not in ds:
        return False
    return size < SAME * float(np.nanmax(ds["bearing_force"].values))


def ranges(ds: xr.Dataset) -> Lines:
    """Least, median and greatest value of each result, in the units of tables."""
    lines = []
    for name in results(ds):
        values = values_without_rounding(ds, name)
        finite = values[np.isfinite(values)]
        parts = [cell(name, float(part)) for part in (finite.min(), np.median(finite), finite.max())]
        lines.append((label_alone(name), *(part.value for part in parts), parts[0].unit))
    return tuple(lines)


def each_case(ds: xr.Dataset) -> tuple[tuple[str, ...], Lines]:
    """A column for each case under its parameters, a line for each result, in the units of tables."""
    lines = []
    for name in results(ds):
        parts = [cell(name, float(value)) for value in np.ravel(values_without_rounding(ds, name))]
        lines.append((label_alone(name), *(part.value for part in parts), parts[0].unit))
    return ("quantity", *parameters_of_cases(ds), "unit"), tuple(lines)


def parameters_of_cases(ds: xr.Dataset) -> list[str]:
    """What varies, in each case: its values with their units, or the number of the case where that is too much."""
    like, columns = ds["status"], []
    for name in (str(name) for name in ds.coords if "path" in ds[name].attrs):
        whole = np.ravel(ds[name].broadcast_like(like).transpose(*like.dims).values)
        if len(set(whole)) > 1:
            columns.append([written(float(value), str(ds[name].attrs["units"])) for value in whole])
    if not 0 < len(columns) <= MOST_NAMED:
        return [f"case {number}" for number in range(like.size)]
    return [", ".join(values) for values in zip(*columns, strict=True)]


def tables(ds: xr.Dataset) -> list[tuple[tuple[str, ...], Lines]]:
    """Tables that tell a study: headings and lines."""
    found: list[tuple[tuple[str, ...], Lines]] = []
    told = extra(ds)
    if "tolerance" in told:
        limits = _limits(told["tolerance"])
        return [*([(LIMIT_HEADS, limits)] if limits else []), (TOLERANCE_HEADS, _scatter(told["tolerance"]))]
    if "sobol" in told:
        return [(SOBOL_HEADS, _sobol(told["sobol"]))]
    if "optimum" in told:
        return [_best(ds, told["optimum"])]
    if lines := ranges(ds):
        few = ds["status"].size <= MOST_COLUMNS and not any("point" in ds[name].dims for name in results(ds))
        found.append(each_case(ds) if few else (RANGE_HEADS, lines))
    return found


def _sobol(told: dict[str, Any]) -> Lines:
    """First-order and total index of each result and parameter, the largest first."""
    lines = []
    for name, numbers in told.items():
        for path, one in sorted(numbers["parameters"].items(), key=lambda item: -item[1]["ST"]):
            first, total = (f"{one[key]:.3f} ± {one[f'{key}_conf']:.3f}" for key in ("S1", "ST"))
            blocks = f"{numbers['answered']} of {numbers['blocks']}"
            lines.append((label_alone(name), path, first, total, blocks))
    return tuple(lines)


def _best(ds: xr.Dataset, told: dict[str, Any]) -> tuple[tuple[str, ...], Lines]:
    """A row for each of the best designs: its parameters and results."""
    names = [str(name) for name in ds.coords if "path" in ds[name].attrs]
    wanted = list(
        dict.fromkeys([*(name for name, _ in told["objectives"]), *(one["result"] for one in told["limits"])])
    )
    heads = ("case", *names, *(f"{label_alone(name)} {shown_as(name).unit}".strip() for name in wanted), "")
    lines = []
    for design in told["best"]:
        values = [written(design["values"][name], str(ds[name].attrs["units"])) for name in names]
        lines.append(
            (str(design["case"]), *values, *(cell(name, design["results"][name]).value for name in wanted), "")
        )
    return heads, tuple(lines)


def written(value: float, units: str) -> str:
    """A parameter with its unit."""
    return format_quantity(value, units.replace("rad s-1", "rad/s"), digits=5) if units != "1" else f"{value:.6g}"


def _limits(told: dict[str, Any]) -> Lines:
    """Probability that each limit is kept."""
    return tuple(
        (
            limit["limit"],
            f"{100.0 * limit['probability']:.1f} %",
            f"{100.0 * limit['low']:.1f} to {100.0 * limit['high']:.1f} %",
            str(limit["without_answer"]),
        )
        for limit in told["limits"]
    )


def _scatter(told: dict[str, Any]) -> Lines:
    """Nominal value, mean, standard deviation and quantiles of each result."""
    keys = ("nominal", "mean", "standard_deviation", "first_order_standard_deviation", *QUANTILE_KEYS)
    lines = []
    for name, numbers in told["results"].items():
        parts = [cell(name, math.nan if numbers.get(key) is None else numbers[key]) for key in keys]
        lines.append((label_alone(name), *(part.value for part in parts), parts[0].unit))
    return tuple(lines)


def reasons(ds: xr.Dataset) -> dict[str, list[str]]:
    """Cases without an answer, by status and reason, the commonest first: the parameters of each."""
    found: dict[str, list[str]] = {}
    columns = (np.ravel(ds["status"].values), np.ravel(ds["reason"].values), parameters_of_cases(ds))
    for status, reason, parameters in zip(*columns, strict=True):
        if status != CONVERGED:
            found.setdefault(f"{status}: {reason}" if reason else str(status), []).append(parameters)
    return dict(sorted(found.items(), key=lambda item: -len(item[1])))


def asked(ds: xr.Dataset) -> list[str]:
    """What varies and what is asked, line by line."""
    lines = [f"{path} = {text}" for path, text in json.loads(ds.attrs["vary"]).items()]
    settings = json.loads(ds.attrs["settings"])
    lines += [f"{name}: {_in_words(value)}" for name, value in settings.items() if value not in (None, [], {}, "")]
    given = [_given(ds.attrs["asked"], name, value) for name, value in json.loads(ds.attrs["arguments"]).items()]
    lines.append(f"ask: {' '.join([ds.attrs['asked'], *given])}")
    return lines


def _in_words(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _given(verb: str, name: str, value: Any) -> str:
    """An argument of the analysis as it is typed."""
    analysis = known_verbs.find(verb)
    argument = None if analysis is None else analysis.arguments.get(name)
    if argument is None:
        return f"{name} = {value}"
    return argument.option_name(name) if value is True else f'{argument.option_name(name)} "{argument.text(value)}"'


def to_json(ds: xr.Dataset) -> dict[str, Any]:
    """The study as one object: counts, and the range of each result; SI."""
    status = Counter(str(text) for text in np.ravel(ds["status"].values))
    found = {}
    for name in results(ds):
        values = ds[name].values
        finite = values[np.isfinite(values)]
        found[name] = {
            "least": float(finite.min()),
            "median": float(np.median(finite)),
            "greatest": float(finite.max()),
        }
    return {"study": ds.attrs["analysis"], "ask": ds.attrs["asked"], "cases": dict(status), "results": found} | extra(
        ds
    )


def extra(ds: xr.Dataset) -> dict[str, Any]:
    """What a kind of study tells beside, stored with it as JSON."""
    return {
        name: json.loads(ds.attrs[name], parse_constant=lambda text: None)
        for name in ("tolerance", "sobol", "optimum")
        if name in ds.attrs
    }


def plain(value: float) -> float | None:
    """A number for JSON, null where it is none."""
    return value if math.isfinite(value) else None
