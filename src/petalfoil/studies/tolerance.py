"""`tolerance`: what scatter of manufacture does to the results, and how likely a bearing keeps its limits."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from petalfoil.analysis.derivatives import GROWTH
from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.studies.gradients import ALL, derivative_question, slopes_of
from petalfoil.studies.limits import ResultLimit, refuse_absent, value_of
from petalfoil.studies.plan import Plan, Point, points_at, read_sample, refuse_repeated, unit_sample
from petalfoil.studies.question import CaseOutcome, Question
from petalfoil.studies.run import Execution, Kind, Runner, key_of, run
from petalfoil.studies.search import Slopes
from petalfoil.studies.study_dataset import dataset
from petalfoil.studies.study_definition import Study
from petalfoil.studies.study_store import Store
from petalfoil.studies.study_summary import plain, results
from petalfoil.studies.variation import Scatter, read_scatter

FloatArray = NDArray[np.float64]
Outcomes: TypeAlias = Sequence[CaseOutcome | None]

QUANTILES = (0.05, 0.5, 0.95)
CONFIDENCE = 0.95
"""Of the interval of a probability."""
SAMPLES = 500


def tolerance(  # noqa: PLR0913 - the options of the command
    case: Case,
    scatter: Mapping[str, str],
    ask: str = "solve",
    *,
    limits: Sequence[str] = (),
    samples: str | int = SAMPLES,
    out: str | Path | None = None,
    execution: Execution | None = None,
    **arguments: Any,
) -> xr.Dataset:
    """Run an analysis on bearings that scatter about the case, and find how likely limits are kept.

    ::

        scatter = {"petals.thickness": "± 5 um"}
        petalfoil.tolerance(case, scatter, "liftoff", loads=20, limits=["liftoff_speed < 9000 rpm"])

    Parameters
    ----------
    case : Case
        The nominal case.
    scatter : mapping
        Scatter by path: ``"± 5 um"`` (uniform), ``"normal 0.2 mm"`` (standard deviation), ``"triangular ± 2 %"``; with
        ``each`` behind it one value a petal.
    ask : str
        Name of the analysis.
    limits : sequence of str
        Limits such as ``"min_film_thickness > 5 um"``.
    samples : int or str
        Number of bearings, or a sample such as ``"lhs 500, seed 2"``; a scrambled Sobol' sequence by default.
    out : str or Path, optional
        Folder of the study.
    execution : Execution, optional
        Workers, fields, progress.
    **arguments
        Arguments of the analysis.

    Returns
    -------
    xarray.Dataset
        Results over ``case``. The attribute ``tolerance`` holds, as JSON, mean, standard deviation and quantiles of
        each result, its first-order estimate (by exact derivatives where the analysis has them), and of each limit the
        probability that it is kept with its confidence interval.

    Raises
    ------
    DefinitionError, UnitError
        There is no such parameter, or a scatter cannot be read.
    UsageError
        A limit cannot be read or names no result of the analysis, or the folder holds another study.
    """
    sample = f"sobol {samples}" if isinstance(samples, int) else samples
    question = Question.read(ask, arguments)
    return run(tolerance_study(case, scatter, question, limits=limits, sample=sample), out, execution)


def tolerance_study(
    case: Case, scatter: Mapping[str, str], question: Question, *, limits: Sequence[str] = (), sample: str = ""
) -> Study:
    """The definition of a tolerance study, checked."""
    for text in limits:
        ResultLimit.read(text)
    settings = {"sample": sample or f"sobol {SAMPLES}", "limits": list(limits)}
    study = Study(kind="tolerance", case=case, question=question, vary=dict(scatter), settings=settings)
    question.refuse_overridden(list(scatter))
    plan_of(study)
    return study


def scatters_of(study: Study) -> list[Scatter]:
    """What scatters."""
    return [one for path, text in study.vary.items() for one in read_scatter(study.case, path, str(text))]


def plan_of(study: Study) -> Plan:
    """The bearings of the sample."""
    scatters = scatters_of(study)
    refuse_repeated(scatters)
    kind, count, seed = read_sample(str(study.settings["sample"]))
    return Plan(tuple(scatters), points_at(scatters, unit_sample(kind, count, len(scatters), seed)))


def differences_of(study: Study) -> list[Point]:
    """Each parameter one standard deviation below and above its nominal value."""
    points: list[Point] = []
    for scatter in scatters_of(study):
        points += [{scatter.path: scatter.nominal + side * scatter.standard_deviation} for side in (-1.0, 1.0)]
    return points


def slopes_asked(study: Study) -> Question | None:
    """The question for the derivatives of all results by what scatters; None where the analysis has none."""
    names = [ResultLimit.read(text).name for text in study.settings["limits"]]
    paths = [scatter.path for scatter in scatters_of(study)]
    return derivative_question(study.case, study.question, paths, [ALL, *(name for name in names if name in GROWTH)])


def conduct(study: Study, runner: Runner) -> None:
    """Answer the nominal bearing, its derivatives or else its differences, then the sample."""
    limits = [ResultLimit.read(text) for text in study.settings["limits"]]
    (nominal,) = runner.outcomes([{}])
    if nominal.converged:
        refuse_absent([limit.name for limit in limits], nominal.records, study.question.verb)
    question = slopes_asked(study)
    has_slopes = nominal.converged and question is not None and runner.ask([{}], question)[0].converged
    runner.answer([*([] if has_slopes else differences_of(study)), *plan_of(study).points])


def assemble(study: Study, store: Store) -> xr.Dataset:
    """Lay out the sample, and what follows from it."""
    plan = plan_of(study)
    found = [store.get(key_of(study, study.case.to_toml(), point)) for point in plan.points]
    ds = dataset(study, plan, found)
    limits = [ResultLimit.read(text) for text in study.settings["limits"]]
    names = list(dict.fromkeys([*(limit.name for limit in limits), *results(ds)]))
    first_order = FirstOrder.of(study, store)
    told = {
        "results": {name: _told(found, name, first_order) for name in names},
        "limits": [kept(limit, found) for limit in limits],
        "first_order_by": "exact derivatives" if first_order.slopes else "differences",
    }
    return ds.assign_attrs(tolerance=json.dumps(told, allow_nan=False))


@dataclass(frozen=True)
class FirstOrder:
    """What one standard deviation of each parameter does to the results, to first order.

    Attributes
    ----------
    scatters : list of Scatter
        What scatters.
    nominal : CaseOutcome or None
        The nominal bearing.
    slopes : dict
        Exact derivatives by result and path; empty where the analysis has none.
    sides : list of CaseOutcome or None
        Without derivatives: each parameter one standard deviation below and above its nominal value.
    """

    scatters: list[Scatter]
    nominal: CaseOutcome | None
    slopes: Slopes
    sides: Outcomes

    @classmethod
    def of(cls, study: Study, store: Store) -> FirstOrder:
        """Read it from the store."""
        base, question = study.case.to_toml(), slopes_asked(study)
        slopes = {} if question is None else slopes_of(store.get(question.key(base, {})))
        sides = [] if slopes else [store.get(key_of(study, base, point)) for point in differences_of(study)]
        return cls(scatters_of(study), store.get(key_of(study, base, {})), slopes, sides)

    def value(self, name: str) -> float:
        """A result of the nominal bearing."""
        return _value(self.nominal, name)

    def effects(self, name: str) -> list[float]:
        """Change of a result by one standard deviation of each parameter; nan where it has no derivative."""
        if self.slopes:
            by_path = self.slopes.get(name, {})
            return [by_path.get(scatter.path, math.nan) * scatter.standard_deviation for scatter in self.scatters]
        values = [_value(outcome, name) for outcome in self.sides]
        return [0.5 * (above - below) for below, above in zip(values[::2], values[1::2], strict=True)]


def _value(outcome: CaseOutcome | None, name: str) -> float:
    return value_of(outcome.records, name) if outcome and outcome.converged else math.nan


def _told(found: Outcomes, name: str, first_order: FirstOrder) -> dict[str, Any]:
    values = np.array([value_of(outcome.records, name) for outcome in found if outcome and outcome.converged])
    told: dict[str, Any] = {key: plain(value) for key, value in statistics(values).items()}
    effects = first_order.effects(name)
    told["nominal"] = plain(first_order.value(name))
    told["first_order_standard_deviation"] = plain(math.hypot(*effects))
    told["effects"] = {s.path: plain(effect) for s, effect in zip(first_order.scatters, effects, strict=True)}
    return told


def statistics(values: FloatArray) -> dict[str, float]:
    """Mean, standard deviation, standard error and quantiles of a sample; infinite values count in quantiles only.

    The standard error is that of independent samples; a quasi-random sample is more even and its error smaller.
    """
    finite = values[np.isfinite(values)]
    spread = float(finite.std(ddof=1)) if finite.size > 1 else math.nan
    told = {
        "cases": float(values.size),
        "mean": float(finite.mean()) if finite.size else math.nan,
        "standard_deviation": spread,
        "standard_error": spread / math.sqrt(finite.size) if finite.size > 1 else math.nan,
    }
    ranked = values[~np.isnan(values)]
    for part in QUANTILES if ranked.size else ():
        told[f"quantile_{round(100 * part):02d}"] = float(np.quantile(ranked, part, method="inverted_cdf"))
    return told


def kept(limit: ResultLimit, found: Outcomes) -> dict[str, Any]:
    """Probability that a limit is kept, with its confidence interval (Clopper and Pearson 1934).

    A case without an answer does not keep it.

    Raises
    ------
    UsageError
        No case is answered yet.
    """
    from scipy.stats import binomtest

    finished = [outcome for outcome in found if outcome is not None]
    if not finished:
        raise UsageError("no case of this study is answered yet")
    margins = [limit.margin(value_of(outcome.records, limit.name)) for outcome in finished if outcome.converged]
    hits = sum(margin > 0.0 for margin in margins)
    interval = binomtest(hits, len(finished)).proportion_ci(CONFIDENCE, method="exact")
    return {
        "limit": limit.text,
        "result": limit.name,
        "value": limit.value,
        "is_upper": limit.is_upper,
        "probability": hits / len(finished),
        "low": float(interval.low),
        "high": float(interval.high),
        "without_answer": len(finished) - len(margins),
    }


KIND = Kind(conduct, assemble)
