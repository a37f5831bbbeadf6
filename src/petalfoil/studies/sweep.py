"""`sweep`: one analysis over a grid of parameters, or over a sample of them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from petalfoil.case import Case
from petalfoil.studies.plan import Plan, grid, sample
from petalfoil.studies.question import Question
from petalfoil.studies.run import Execution, Kind, Runner, key_of, run
from petalfoil.studies.study_dataset import dataset
from petalfoil.studies.study_definition import Study
from petalfoil.studies.study_store import Store
from petalfoil.studies.variation import read_levels, read_range


def sweep(
    case: Case,
    vary: Mapping[str, Any],
    ask: str = "solve",
    *,
    sample: str = "",
    out: str | Path | None = None,
    execution: Execution | None = None,
    **arguments: Any,
) -> xr.Dataset:
    """Run an analysis on many cases, over a grid of parameters or a sample of them.

    ::

        petalfoil.sweep(case, {"petals.thickness": "0.1 mm : 0.2 mm : 11", "petals.count": [6, 8]}, "balance", load=20)

    Parameters
    ----------
    case : Case
        The base case.
    vary : mapping
        Values by path: a list, or a text such as ``"0.1 mm : 0.2 mm : 11"``; of a sample also an interval
        ``"0.1 mm : 0.2 mm"``.
    ask : str
        Name of the analysis.
    sample : str
        Kind and size of a sample, such as ``"lhs 200"`` or ``"sobol 256, seed 1"``; without it all combinations.
    out : str or Path, optional
        Folder of the study. A study that was stopped goes on there.
    execution : Execution, optional
        Workers, fields, progress.
    **arguments
        Arguments of the analysis.

    Returns
    -------
    xarray.Dataset
        Results over the parameters, such as ``min_film_thickness(thickness, count)``; of a sample over ``case``. A case
        without an answer is NaN, with its ``status`` and ``reason``.

    Raises
    ------
    DefinitionError, UnitError
        There is no such parameter, or a value is outside its range.
    UsageError
        There is no such analysis or argument, or the folder holds another study.
    """
    return run(sweep_study(case, vary, Question.read(ask, arguments), sample), out, execution)


def sweep_study(case: Case, vary: Mapping[str, Any], question: Question, sample: str = "") -> Study:
    """The definition of a sweep, checked."""
    settings = {"sample": sample} if sample else {}
    plain = {path: text if isinstance(text, str) else list(text) for path, text in vary.items()}
    study = Study(kind="sweep", case=case, question=question, vary=plain, settings=settings)
    question.refuse_overridden(list(vary))
    plan_of(study)
    return study


def plan_of(study: Study) -> Plan:
    """The cases of a sweep."""
    text = str(study.settings.get("sample", ""))
    if not text:
        return grid([read_levels(study.case, path, given) for path, given in study.vary.items()])
    return sample([read_range(study.case, path, given) for path, given in study.vary.items()], text)


def conduct(study: Study, runner: Runner) -> None:
    """Answer all cases."""
    runner.answer(plan_of(study).points)


def assemble(study: Study, store: Store) -> xr.Dataset:
    """Lay out what is answered."""
    plan, base = plan_of(study), study.case.to_toml()
    return dataset(study, plan, [store.get(key_of(study, base, point)) for point in plan.points])


KIND = Kind(conduct, assemble)
