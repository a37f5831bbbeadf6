"""Global sensitivity: which part of the variance of a result each parameter has, over all of its range.

Sobol' indices by Saltelli's sample (SALib). With `V` the variance of a result over the ranges, the first-order index of
a parameter is the part of `V` that its own variation explains, and its total index the part that is left where all
others are fixed: interactions are the difference.

References
----------
Saltelli et al., Comput. Phys. Commun. 181 (2010) 259, https://doi.org/10.1016/j.cpc.2009.09.018
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from petalfoil.case import Case
from petalfoil.errors import UsageError
from petalfoil.studies.limits import refuse_absent, result_of, value_of
from petalfoil.studies.plan import Plan, names_of, points_at, refuse_repeated, refuse_too_many
from petalfoil.studies.question import CaseOutcome, Question
from petalfoil.studies.run import Execution, Kind, Runner, run
from petalfoil.studies.study_dataset import dataset
from petalfoil.studies.study_definition import Study
from petalfoil.studies.study_store import Store
from petalfoil.studies.study_summary import plain, results
from petalfoil.studies.variation import SCATTER, Variation, read_range, read_scatter

SAMPLES = 256
LEAST = 8
"""Base samples below which no index means anything."""
RESAMPLES = 200
"""Bootstrap samples of the confidence intervals."""


def sobol_indices(
    case: Case,
    vary: Mapping[str, Any],
    ask: str = "solve",
    *,
    samples: int = SAMPLES,
    execution: Execution | None = None,
    out: str | Path | None = None,
    **arguments: Any,
) -> xr.Dataset:
    """Compute Sobol' indices: the part of the variance of each result that each parameter explains.

    Parameters
    ----------
    case : Case
        The base case.
    vary : mapping
        Intervals ``"0.1 mm : 0.2 mm"``, lists, or scatter ``"± 5 um"``, ``"normal 2 %"``, by path.
    ask : str
        Name of the analysis.
    samples : int
        Base samples, a power of two; each takes as many cases as there are parameters, and two more.
    execution : Execution, optional
        Workers, fields, progress.
    out : str or Path, optional
        Folder of the study.
    **arguments
        Arguments of the analysis.

    Returns
    -------
    xarray.Dataset
        All cases over ``case``; the attribute ``sobol`` holds first-order and total indices with their 95 % intervals
        by result and parameter, as JSON.

    Raises
    ------
    DefinitionError, UnitError
        There is no such parameter, or a value is outside its range.
    UsageError
        The number of samples is no power of two, or an argument does not fit.
    """
    return run(sobol_study(case, vary, Question.read(ask, arguments), samples=samples), out, execution)


def sobol_study(
    case: Case, vary: Mapping[str, Any], question: Question, *, samples: int = SAMPLES, of: Sequence[str] = ()
) -> Study:
    """The definition of a sensitivity study, checked."""
    if samples < LEAST or samples & (samples - 1):
        raise UsageError(f"{samples} base samples are not a power of two from {LEAST} on: try {_power(samples)}")
    settings = {"samples": samples, "of": [result_of(name) for name in of], "seed": 0}
    plain_vary = {path: text if isinstance(text, str) else list(text) for path, text in vary.items()}
    study = Study(kind="sobol", case=case, question=question, vary=plain_vary, settings=settings)
    question.refuse_overridden(list(vary))
    plan_of(study)
    return study


def _power(samples: int) -> int:
    return int(max(LEAST, 2 ** round(np.log2(max(samples, LEAST)))))


def variations_of(study: Study) -> tuple[Variation, ...]:
    """What varies."""
    found: list[Variation] = []
    for path, text in study.vary.items():
        if isinstance(text, str) and SCATTER.fullmatch(text.strip()):
            found += read_scatter(study.case, path, text)
        else:
            found.append(read_range(study.case, path, text))
    return tuple(found)


def plan_of(study: Study) -> Plan:
    """Saltelli's sample: blocks of two base points and one mixed point for each parameter."""
    variations, samples = variations_of(study), int(study.settings["samples"])
    refuse_repeated(variations)
    refuse_too_many(samples * (len(variations) + 2))
    sampler = _salib("sample")
    unit = sampler(_problem(variations), samples, calc_second_order=False, seed=int(study.settings["seed"]))
    return Plan(variations, points_at(variations, np.asarray(unit)))


def _problem(variations: Sequence[Variation]) -> dict[str, Any]:
    """The unit cube: distributions are applied afterwards."""
    return {"num_vars": len(variations), "names": list(names_of(variations)), "bounds": [[0.0, 1.0]] * len(variations)}


def _salib(part: str) -> Any:
    try:
        from SALib.analyze import sobol as analysis
        from SALib.sample import sobol as sampling
    except ImportError:
        raise UsageError("Sobol' indices need SALib: pip install 'petalfoil[studies]'") from None
    return sampling.sample if part == "sample" else analysis.analyze


def conduct(study: Study, runner: Runner) -> None:
    """Answer the base case, then the sample."""
    (first,) = runner.outcomes([{}])
    if first.converged:
        refuse_absent(study.settings["of"], first.records, study.question.verb)
    runner.answer(plan_of(study).points)


def assemble(study: Study, store: Store) -> xr.Dataset:
    """Lay out the sample and the indices of the blocks that are answered whole."""
    plan, base = plan_of(study), study.case.to_toml()
    found = [store.get(study.question.key(base, point)) for point in plan.points]
    ds = dataset(study, plan, found)
    names = list(study.settings["of"]) or results(ds)
    told = {name: indices(plan.variations, found, name, int(study.settings["seed"])) for name in names}
    return ds.assign_attrs(sobol=json.dumps(told, allow_nan=False))


def indices(
    variations: Sequence[Variation], found: Sequence[CaseOutcome | None], name: str, seed: int
) -> dict[str, Any]:
    """Indices of one result; blocks with a case that has no answer are left out.

    Parameters
    ----------
    variations : sequence of Variation
        What varies.
    found : sequence of CaseOutcome or None
        Outcomes in the order of the plan.
    name : str
        The result.
    seed : int
        Of the bootstrap.
    """
    values = np.array([value_of(o.records, name) if o and o.converged else np.nan for o in found])
    blocks = values.reshape(-1, len(variations) + 2)
    whole = blocks[np.isfinite(blocks).all(axis=1)]
    told: dict[str, Any] = {"blocks": len(blocks), "answered": len(whole), "parameters": {}}
    if len(whole) < LEAST or float(np.ptp(whole)) == 0.0:
        return told
    told["variance"] = float(whole[:, [0, -1]].var())
    part = _analyzed(variations, whole.ravel(), seed)
    for number, variation in enumerate(variations):
        told["parameters"][variation.path] = {key: plain(float(part[key][number])) for key in KEYS}
    return told


KEYS = ("S1", "S1_conf", "ST", "ST_conf")


def _analyzed(variations: Sequence[Variation], values: NDArray[np.float64], seed: int) -> Any:
    options = {"calc_second_order": False, "num_resamples": RESAMPLES, "seed": seed}
    return _salib("analyze")(_problem(variations), values, **options)


KIND = Kind(conduct, assemble)
